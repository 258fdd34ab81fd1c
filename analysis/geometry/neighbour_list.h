#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/vec2.h"

namespace grainfield::analysis {

/// A neighbour of a point: which one, and the vector to it [length unit of the points].
struct Neighbour {
    int index = 0;
    Vec2 d;
    double r2 = 0;  ///< |d|²
};

/// A list of neighbours that is filled again and again: its memory is kept, and never cleared.
class NeighbourList {
 public:
    const Neighbour* begin() const { return buffer_.data(); }
    const Neighbour* end() const { return buffer_.data() + count_; }
    std::size_t size() const { return count_; }
    bool empty() const { return count_ == 0; }
    void clear() { count_ = 0; }

    /// Room for `more` entries behind the last one; `grow` says how many were filled.
    Neighbour* room(std::size_t more) {
        if (count_ + more > buffer_.size()) buffer_.resize(2 * (count_ + more));
        return buffer_.data() + count_;
    }
    void grow(std::size_t more) { count_ += more; }

    /// Without branches on the outcome, which nobody can predict.
    template <class Predicate>
    void keep_if(Predicate predicate) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            const Neighbour n = buffer_[i];
            buffer_[kept] = n;
            kept += predicate(n) ? 1U : 0U;
        }
        count_ = kept;
    }

 private:
    std::vector<Neighbour> buffer_;
    std::size_t count_ = 0;
};

/// The `count` smallest r² in ascending order, infinity where there are fewer. Without branches:
/// with a dozen candidates a misprediction costs more than the comparisons it would save.
template <std::size_t count>
std::array<double, count> smallest_r2(const auto& neighbours) {
    std::array<double, count> kept;
    kept.fill(std::numeric_limits<double>::infinity());
    for (const Neighbour& neighbour : neighbours) {
        double r2 = neighbour.r2;
        for (double& k : kept) {
            const double low = std::min(k, r2);
            r2 = std::max(k, r2);
            k = low;
        }
    }
    return kept;
}

}  // namespace grainfield::analysis
