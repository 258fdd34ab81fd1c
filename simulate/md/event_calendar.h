#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace grainfield::simulate {

/// The future events of one tile in order of time: a calendar queue (paul2007) with lazy deletion.
///
/// The window is cut into buckets that hold some tens of grains each, unsorted, in chunks of one
/// cache line. The bucket whose turn it is gets sorted; entries whose grain has meanwhile another
/// time are dropped. Push and pop are O(1), and the grains of the coming buckets are known ahead,
/// so that the engine can fetch their data before they are needed.
/// Equal times are in order of the grain's identity: no dependence on memory order.
class EventCalendar {
 public:
    struct Entry {
        double time;
        std::int32_t id;
        std::int32_t grain;
    };

    /// Empties the calendar for events in [start, end), of which about `expected` will come.
    void reset(double start, double end, double expected) {
        start_ = start;
        const double buckets = std::clamp(expected / per_bucket, 1.0, 4e6);
        per_time_ = buckets / std::max(end - start, 1e-300);
        const auto count = static_cast<std::size_t>(buckets) + 2;
        head_.assign(count, -1);
        pool_used_ = 0;
        free_ = -1;
        current_.clear();
        next_ = 0;
        bucket_ = -1;
    }

    /// Plans `grain` for `time`, which is neither before the last entry taken nor after the end.
    void push(double time, std::int32_t id, std::int32_t grain) {
        const std::int32_t bucket = bucket_of(time);
        if (bucket <= bucket_) {
            insert({time, id, grain});
            return;
        }
        std::int32_t& head = head_[static_cast<std::size_t>(bucket)];
        if (head < 0 || pool_[static_cast<std::size_t>(head)].count == chunk_size) {
            const std::int32_t fresh = allocate();
            pool_[static_cast<std::size_t>(fresh)].next = head;
            pool_[static_cast<std::size_t>(fresh)].count = 0;
            head = fresh;
        }
        Chunk& chunk = pool_[static_cast<std::size_t>(head)];
        chunk.grain[chunk.count++] = grain;
    }

    /// The earliest entry, or nullptr if there is none. `entry_of(grain)` gives the entry a grain
    /// has now; `look_ahead(b, distance)` is called once for each bucket as it comes nearer.
    template <class EntryOf, class LookAhead>
    const Entry* front(EntryOf&& entry_of, LookAhead&& look_ahead) {
        while (next_ == current_.size()) {
            if (bucket_ + 1 >= static_cast<std::int32_t>(head_.size())) return nullptr;
            current_.clear();
            next_ = 0;
            ++bucket_;
            look_ahead(bucket_);
            activate(entry_of);
        }
        return &current_[next_];
    }

    void pop() { ++next_; }

    /// Calls f(grain) for all grains of a bucket that has not begun.
    template <class F>
    void for_each(std::int32_t bucket, F&& f) const {
        if (bucket >= static_cast<std::int32_t>(head_.size())) return;
        for (std::int32_t c = head_[static_cast<std::size_t>(bucket)]; c >= 0;
             c = pool_[static_cast<std::size_t>(c)].next) {
            const Chunk& chunk = pool_[static_cast<std::size_t>(c)];
            for (std::int32_t k = 0; k < chunk.count; ++k) f(chunk.grain[k]);
        }
    }

    std::size_t bytes() const {
        return head_.capacity() * sizeof(std::int32_t) + pool_.capacity() * sizeof(Chunk);
    }

 private:
    static constexpr double per_bucket = 16;
    static constexpr std::int32_t chunk_size = 14;

    struct alignas(64) Chunk {
        std::int32_t count = 0;
        std::int32_t next = -1;
        std::int32_t grain[chunk_size];
    };

    static bool earlier(const Entry& a, const Entry& b) {
        return a.time != b.time ? a.time < b.time : a.id < b.id;
    }

    std::int32_t bucket_of(double time) const {
        const double b = (time - start_) * per_time_;
        const auto last = static_cast<double>(head_.size() - 1);
        return static_cast<std::int32_t>(std::clamp(b, 0.0, last));
    }

    std::int32_t allocate() {
        if (free_ >= 0) {
            const std::int32_t chunk = free_;
            free_ = pool_[static_cast<std::size_t>(chunk)].next;
            return chunk;
        }
        if (pool_used_ == pool_.size()) pool_.resize(pool_.size() + pool_.size() / 4 + 64);
        return static_cast<std::int32_t>(pool_used_++);
    }

    void insert(const Entry& entry) {
        current_.push_back(entry);
        std::size_t i = current_.size() - 1;
        for (; i > next_ && earlier(entry, current_[i - 1]); --i) current_[i] = current_[i - 1];
        current_[i] = entry;
    }

    template <class EntryOf>
    void activate(EntryOf& entry_of) {
        std::int32_t c = head_[static_cast<std::size_t>(bucket_)];
        head_[static_cast<std::size_t>(bucket_)] = -1;
        while (c >= 0) {
            Chunk& chunk = pool_[static_cast<std::size_t>(c)];
            for (std::int32_t k = 0; k < chunk.count; ++k) {
                const Entry entry = entry_of(chunk.grain[k]);
                if (bucket_of(entry.time) == bucket_) current_.push_back(entry);
            }
            const std::int32_t next = chunk.next;
            chunk.next = free_;
            free_ = c;
            c = next;
        }
        std::sort(current_.begin(), current_.end(), earlier);
    }

    double start_ = 0;
    double per_time_ = 1;
    std::vector<std::int32_t> head_;
    std::vector<Chunk> pool_;
    std::size_t pool_used_ = 0;
    std::int32_t free_ = -1;
    std::vector<Entry> current_;  // the bucket whose turn it is, sorted
    std::size_t next_ = 0;
    std::int32_t bucket_ = -1;
};

}  // namespace grainfield::simulate
