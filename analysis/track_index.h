#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace grainfield::analysis {

/// Where the track of each identity stands in a list of tracks.
///
/// Frames name mostly the same particles in the same order: an identity is looked for where it
/// would follow in the frame before, and by hashing only if it is not there, which is ten times
/// slower.
class TrackIndex {
 public:
    /// Begins a frame.
    void start_frame() {
        before_.swap(current_);
        current_.clear();
        next_ = 0;
    }

    /// The place of the track of `id`, or `place` for one that was never seen (second: true).
    std::pair<std::size_t, bool> place_of(std::int64_t id, std::size_t place) {
        constexpr std::size_t most_missing = 3;
        for (std::size_t at = next_; at < before_.size() && at < next_ + most_missing; ++at) {
            if (before_[at].id != id) continue;
            next_ = at + 1;
            current_.push_back(before_[at]);
            return {before_[at].place, false};
        }
        const auto [found, is_new] = by_id_.try_emplace(id, place);
        current_.push_back({id, found->second});
        return {found->second, is_new};
    }

    /// All identities and places, in no order.
    const std::unordered_map<std::int64_t, std::size_t>& all() const { return by_id_; }

    void clear() {
        by_id_.clear();
        before_.clear();
        current_.clear();
        next_ = 0;
    }

 private:
    struct Seen {
        std::int64_t id;
        std::size_t place;
    };
    std::unordered_map<std::int64_t, std::size_t> by_id_;
    std::vector<Seen> before_;   // the frame before, in its order
    std::vector<Seen> current_;  // this one so far
    std::size_t next_ = 0;       // in `before_`
};

}  // namespace grainfield::analysis
