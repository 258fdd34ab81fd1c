#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/support/huge_pages.h"

namespace grainfield::simulate {

/// The future events of one tile in order of time: a calendar queue (paul2007) in two levels, with
/// lazy deletion.
///
/// The window is cut into buckets of some twenty entries. Only those of the next two *spans* (64
/// buckets each) exist as such. Entries farther ahead wait in one list a span, so that the ends of
/// all lists fit in the cache. The bucket whose turn it is gets sorted; entries whose grain has
/// meanwhile another time are dropped. Push and pop are O(1), and the grains of the coming buckets
/// are known ahead. The engine fetches their data before they are needed. Equal times are in order
/// of the grain's identity: no dependence on memory order.
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
        const double buckets = std::clamp(expected / per_bucket, 1.0, 1e8);
        per_time_ = buckets / std::max(end - start, 1e-300);
        last_bucket_ = static_cast<std::int32_t>(buckets) + 1;
        const std::int32_t spans = last_bucket_ / span + 2;
        head_.assign(static_cast<std::size_t>(spans), {});
        pool_used_ = 0;
        free_ = -1;
        for (auto& bucket : near_) bucket.clear();
        current_.clear();
        next_ = 0;
        bucket_ = -1;
        open_span_ = 0;
    }

    /// Plans a grain for `time`, which is neither before the last entry taken nor after the end.
    void push(const Entry& entry) {
        const std::int32_t bucket = bucket_of(entry.time);
        if (bucket <= bucket_) {
            insert(entry);
        } else if (bucket / span <= open_span_) {
            near_[near_slot(bucket)].push_back(entry);
        } else {
            push_far(bucket / span, entry);
        }
    }

    /// The earliest entry, or nullptr if none is due before `until`. `time_of(grain)` gives the
    /// time a grain is planned for now; `look_ahead(bucket)` is called for each bucket as it
    /// becomes the present one. What is due later may still be returned, but no bucket beyond that
    /// of `until` becomes the present one: entries can be pushed there at no cost.
    template <class TimeOf, class LookAhead>
    const Entry* front(TimeOf&& time_of, LookAhead&& look_ahead,
                       double until = std::numeric_limits<double>::infinity()) {
        while (next_ == current_.size()) {
            if (bucket_ >= bucket_of(until)) return nullptr;
            current_.clear();
            next_ = 0;
            ++bucket_;
            if (bucket_ / span + 1 > open_span_) open(++open_span_);
            look_ahead(bucket_);
            activate(time_of);
        }
        return &current_[next_];
    }

    void pop() { ++next_; }

    /// Calls f(grain) for all grains of a bucket at most one span ahead.
    template <class F>
    void for_each(std::int32_t bucket, F&& f) const {
        for (const Entry& entry : near_[near_slot(bucket)]) f(entry.grain);
    }

    std::size_t bytes() const {
        std::size_t sum = head_.capacity() * sizeof(Head) + pool_.capacity() * sizeof(Chunk);
        for (const auto& bucket : near_) sum += bucket.capacity() * sizeof(Entry);
        return sum;
    }

 private:
    static constexpr double per_bucket = 20;
    static constexpr std::int32_t span = 64;
    static constexpr std::int32_t chunk_size = 15;

    struct alignas(64) Chunk {
        std::int32_t next = -1;
        std::array<Entry, chunk_size> entry;
    };

    /// The list of a span. How full its first chunk is stands here, not in the chunk: a push then
    /// writes memory that it need not read, and waits for none. The other chunks are full.
    struct Head {
        std::int32_t chunk = -1;
        std::int32_t count = chunk_size;
    };

    static bool earlier(const Entry& a, const Entry& b) {
        return a.time != b.time ? a.time < b.time : a.id < b.id;
    }
    static std::size_t near_slot(std::int32_t bucket) {
        return static_cast<std::size_t>(bucket % (2 * span));
    }

    std::int32_t bucket_of(double time) const {
        const double b = (time - start_) * per_time_;
        return static_cast<std::int32_t>(std::clamp(b, 0.0, static_cast<double>(last_bucket_)));
    }

    void push_far(std::int32_t which, const Entry& entry) {
        Head& head = head_[static_cast<std::size_t>(which)];
        if (head.count == chunk_size) {
            const std::int32_t fresh = allocate();
            pool_[static_cast<std::size_t>(fresh)].next = head.chunk;
            head = {.chunk = fresh, .count = 0};
        }
        Chunk& chunk = pool_[static_cast<std::size_t>(head.chunk)];
        chunk.entry[static_cast<std::size_t>(head.count++)] = entry;
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

    void open(std::int32_t which) {
        if (which >= static_cast<std::int32_t>(head_.size())) return;
        std::int32_t c = head_[static_cast<std::size_t>(which)].chunk;
        std::int32_t count = head_[static_cast<std::size_t>(which)].count;
        head_[static_cast<std::size_t>(which)] = {};
        while (c >= 0) {
            Chunk& chunk = pool_[static_cast<std::size_t>(c)];
            if (chunk.next >= 0) {
                const Chunk* following = &pool_[static_cast<std::size_t>(chunk.next)];
                fetch_line(following);
                fetch_line(&following->entry[7]);
            }
            for (std::int32_t k = 0; k < count; ++k) {
                const Entry& entry = chunk.entry[static_cast<std::size_t>(k)];
                near_[near_slot(bucket_of(entry.time))].push_back(entry);
            }
            const std::int32_t next = chunk.next;
            chunk.next = free_;
            free_ = c;
            c = next;
            count = chunk_size;
        }
    }

    void insert(const Entry& entry) {
        current_.push_back(entry);
        std::size_t i = current_.size() - 1;
        for (; i > next_ && earlier(entry, current_[i - 1]); --i) current_[i] = current_[i - 1];
        current_[i] = entry;
    }

    template <class TimeOf>
    void activate(TimeOf& time_of) {
        auto& bucket = near_[near_slot(bucket_)];
        for (const Entry& entry : bucket) {
            if (time_of(entry.grain) == entry.time) current_.push_back(entry);
        }
        bucket.clear();
        if (current_.size() > 64) std::sort(current_.begin(), current_.end(), earlier);
        for (std::size_t k = 1; k < current_.size(); ++k) {
            const Entry entry = current_[k];
            std::size_t i = k;
            for (; i > 0 && earlier(entry, current_[i - 1]); --i) current_[i] = current_[i - 1];
            current_[i] = entry;
        }
    }

    double start_ = 0;
    double per_time_ = 1;
    std::int32_t last_bucket_ = 0;
    HugeVector<Head> head_;  // of each span that is not open
    HugeVector<Chunk> pool_;
    std::size_t pool_used_ = 0;
    std::int32_t free_ = -1;
    std::array<std::vector<Entry>, 2 * span> near_;  // the buckets of the open spans
    std::vector<Entry> current_;                     // the bucket whose turn it is, sorted
    std::size_t next_ = 0;
    std::int32_t bucket_ = -1;
    std::int32_t open_span_ = 0;
};

}  // namespace grainfield::simulate
