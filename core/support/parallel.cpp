#include "core/support/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace grainfield {

namespace {

// Indices are handed out in order and every index handed out is worked on, so the smallest failing
// index is always among those tried: which exception is rethrown does not depend on timing.
class SharedLoop {
 public:
    SharedLoop(std::int64_t count, const std::function<void(std::int64_t)>& body)
        : count_(count), body_(body) {}

    void work() {
        while (!failed_.load(std::memory_order_relaxed)) {
            const std::int64_t i = next_.fetch_add(1, std::memory_order_relaxed);
            if (i >= count_) return;
            try {
                body_(i);
            } catch (...) {
                note_failure(i, std::current_exception());
            }
        }
    }

    void rethrow_failure() const {
        if (failure_) std::rethrow_exception(failure_);
    }

 private:
    void note_failure(std::int64_t i, std::exception_ptr failure) {
        const std::lock_guard lock(mutex_);
        if (!failure_ || i < failed_index_) {
            failure_ = std::move(failure);
            failed_index_ = i;
        }
        failed_.store(true, std::memory_order_relaxed);
    }

    std::int64_t count_;
    const std::function<void(std::int64_t)>& body_;
    std::atomic<std::int64_t> next_{0};
    std::atomic<bool> failed_{false};
    std::mutex mutex_;
    std::exception_ptr failure_;
    std::int64_t failed_index_ = 0;
};

}  // namespace

int thread_count(int requested) {
    if (requested > 0) return requested;
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(std::int64_t count, int threads, const std::function<void(std::int64_t)>& body) {
    const std::int64_t workers = std::min<std::int64_t>(thread_count(threads), count);
    if (workers <= 1) {
        for (std::int64_t i = 0; i < count; ++i) body(i);
        return;
    }
    SharedLoop loop(count, body);
    {
        std::vector<std::jthread> helpers;
        helpers.reserve(static_cast<std::size_t>(workers - 1));
        for (std::int64_t i = 1; i < workers; ++i) helpers.emplace_back([&loop] { loop.work(); });
        loop.work();
    }
    loop.rethrow_failure();
}

}  // namespace grainfield
