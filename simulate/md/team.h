#pragma once

#include <cstdint>
#include <exception>
#include <utility>
#include <vector>

#if defined(__SANITIZE_THREAD__)
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace grainfield::simulate {

/// Tells the thread sanitizer of the order that OpenMP's own, which it does not see, gives: all
/// before `release` happens before all after `acquire`. Nothing otherwise.
struct TeamOrder {
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

/// Runs body(i) for i in [0, count) on a team of threads that stays alive between calls (OpenMP),
/// as steps of some milliseconds need. OMP_PROC_BIND=true keeps each thread on its core. The
/// exception of the smallest i that failed is rethrown.
template <class Body>
void on_team(std::int64_t count, int threads, Body&& body) {
    if (threads <= 1 || count <= 1) {
        for (std::int64_t i = 0; i < count; ++i) body(i);
        return;
    }
    std::vector<std::exception_ptr> failure(static_cast<std::size_t>(count));
    TeamOrder begin;
    TeamOrder end;
    begin.release();
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
    for (std::int64_t i = 0; i < count; ++i) {
        begin.acquire();
        try {
            body(i);
        } catch (...) {
            failure[static_cast<std::size_t>(i)] = std::current_exception();
        }
        end.release();
    }
    end.acquire();
    for (const std::exception_ptr& e : failure) {
        if (e) std::rethrow_exception(e);
    }
}

}  // namespace grainfield::simulate
