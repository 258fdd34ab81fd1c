#include "core/support/team.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <utility>

#include <omp.h>

#if defined(__SANITIZE_THREAD__)
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace grainfield {

namespace {

// How long a thread looks for work before it sleeps. Waking it takes some 10 µs.
constexpr std::chrono::microseconds patience(40);

template <class Value>
void wait_while(const std::atomic<Value>& variable, Value value) {
    using Clock = std::chrono::steady_clock;
    if (variable.load(std::memory_order_acquire) != value) return;
    for (const auto end = Clock::now() + patience; Clock::now() < end;) {
        if (variable.load(std::memory_order_acquire) != value) return;
    }
    variable.wait(value, std::memory_order_acquire);
}

/// Tells the thread sanitizer of the order that OpenMP's own barriers give and that it does not
/// see: all before `release` happens before all after `acquire`. Nothing otherwise.
struct RegionOrder {
#if defined(__SANITIZE_THREAD__)
    void release() {
        __tsan_release(this);
    }
    void acquire() {
        __tsan_acquire(this);
    }
#else
    void release() {}
    void acquire() {}
#endif
};

/// The failure of the smallest index.
class FirstFailure {
 public:
    void note(std::int64_t i, std::exception_ptr failure) {
        const std::lock_guard lock(mutex_);
        if (!failure_ || i < index_) {
            failure_ = std::move(failure);
            index_ = i;
        }
        has_failed_.store(true, std::memory_order_relaxed);
    }
    bool has_failed() const { return has_failed_.load(std::memory_order_relaxed); }
    void rethrow() const {
        if (failure_) std::rethrow_exception(failure_);
    }

 private:
    std::atomic<bool> has_failed_{false};
    std::mutex mutex_;
    std::exception_ptr failure_;
    std::int64_t index_ = 0;
};

// Indices are handed out in order and every index handed out is worked on, so the smallest failing
// index is always among those tried: which exception is rethrown does not depend on timing.
class SharedLoop {
 public:
    SharedLoop(std::int64_t count, const std::function<void(std::int64_t)>& body)
        : count_(count), body_(body) {}

    void work() {
        while (!failure_.has_failed()) {
            const std::int64_t i = next_.fetch_add(1, std::memory_order_relaxed);
            if (i >= count_) return;
            try {
                body_(i);
            } catch (...) {
                failure_.note(i, std::current_exception());
            }
        }
    }
    void rethrow_failure() const { failure_.rethrow(); }

 private:
    std::int64_t count_;
    const std::function<void(std::int64_t)>& body_;
    std::atomic<std::int64_t> next_{0};
    FirstFailure failure_;
};

// OpenMP lets regions in regions have one thread only, unless told otherwise.
void permit_region_here() {
    const int level = omp_get_active_level();
    if (level > 0 && omp_get_max_active_levels() <= level) omp_set_max_active_levels(level + 1);
}

// Runs body(part, parts) on up to `threads` threads; bodies must not throw.
template <class Body>
void run_region(int threads, const Body& body) {
    permit_region_here();
    RegionOrder begin;
    RegionOrder end;
    begin.release();
#pragma omp parallel num_threads(threads)
    {
        begin.acquire();
        body(omp_get_thread_num(), omp_get_num_threads());
        end.release();
    }
    end.acquire();
}

/// The threads of one region: the first hands out work, the others `help`.
class RegionThreads {
 public:
    int count() const { return count_; }
    bool is_idle() const { return !is_working_; }

    void help(int part) {
        std::uint32_t seen = 0;
        for (;;) {
            wait_while(round_, seen);
            ++seen;
            if (work_ == nullptr) return;
            (*work_)(part);
            if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
        }
    }

    // What follows is for the first thread alone.
    void begin(int count) { count_ = count; }
    void end() {
        work_ = nullptr;
        next_round();
    }
    // work(part) on every thread; returns when all are done. Work must not throw.
    void hand_out(const std::function<void(int)>& work) {
        is_working_ = true;
        work_ = &work;
        busy_.store(count_ - 1, std::memory_order_relaxed);
        next_round();
        work(0);
        for (int left = busy_.load(std::memory_order_acquire); left != 0;
             left = busy_.load(std::memory_order_acquire)) {
            wait_while(busy_, left);
        }
        is_working_ = false;
    }

 private:
    void next_round() {
        round_.fetch_add(1, std::memory_order_release);
        round_.notify_all();
    }

    int count_ = 1;
    bool is_working_ = false;
    const std::function<void(int)>* work_ = nullptr;
    std::atomic<std::uint32_t> round_{0};
    std::atomic<int> busy_{0};
};

// The region whose first thread this is.
thread_local RegionThreads* own_region = nullptr;

bool has_idle_team() {
    return own_region != nullptr && own_region->is_idle();
}

/// As many of the threads of a region as were asked for.
class RegionTeam final : public Team {
 public:
    RegionTeam(RegionThreads& region, int threads)
        : region_(region), threads_(std::min(threads, region.count())) {}

    int threads() const override { return threads_; }

    void split(std::int64_t count,
               const std::function<void(std::int64_t, std::int64_t)>& body) override {
        FirstFailure failure;
        region_.hand_out([&](int part) {
            if (part >= threads_) return;
            const std::int64_t first = count * part / threads_;
            const std::int64_t last = count * (part + 1) / threads_;
            if (first >= last) return;
            try {
                body(first, last);
            } catch (...) {
                failure.note(part, std::current_exception());
            }
        });
        failure.rethrow();
    }

    void for_each(std::int64_t count, const std::function<void(std::int64_t)>& body) override {
        if (count <= 1) {
            if (count == 1) body(0);
            return;
        }
        SharedLoop loop(count, body);
        region_.hand_out([&](int part) {
            if (part < threads_) loop.work();
        });
        loop.rethrow_failure();
    }

 private:
    RegionThreads& region_;
    int threads_;
};

/// This thread alone.
class SingleTeam final : public Team {
 public:
    int threads() const override { return 1; }
    void split(std::int64_t count,
               const std::function<void(std::int64_t, std::int64_t)>& body) override {
        if (count > 0) body(0, count);
    }
    void for_each(std::int64_t count, const std::function<void(std::int64_t)>& body) override {
        for (std::int64_t i = 0; i < count; ++i) body(i);
    }
};

}  // namespace

void on_team(int threads, const std::function<void(Team&)>& body) {
    if (threads <= 1) {
        SingleTeam alone;
        body(alone);
        return;
    }
    if (has_idle_team()) {
        RegionTeam team(*own_region, threads);
        body(team);
        return;
    }
    std::exception_ptr failure;
    RegionThreads region;
    run_region(threads, [&](int part, int parts) {
        if (part > 0) {
            region.help(part);
            return;
        }
        region.begin(parts);
        RegionThreads* const outer = std::exchange(own_region, &region);
        try {
            RegionTeam team(region, threads);
            body(team);
        } catch (...) {
            failure = std::current_exception();
        }
        own_region = outer;
        region.end();
    });
    if (failure) std::rethrow_exception(failure);
}

}  // namespace grainfield
