#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace grainfield::simulate {

/// Threads that stay alive between short pieces of work: a step of the field model has three or
/// four phases of a fraction of a millisecond each, for which starting threads costs too much.
///
/// Waiting is a short spin, then sleep (futex), so idle threads leave the cores to others.
class WorkerTeam {
 public:
    explicit WorkerTeam(int threads);
    ~WorkerTeam();
    WorkerTeam(const WorkerTeam&) = delete;
    WorkerTeam& operator=(const WorkerTeam&) = delete;

    int threads() const { return static_cast<int>(helpers_.size()) + 1; }

    /// Runs body(first, last) on consecutive parts of [0, count), one part a thread, and returns
    /// when all are done. What is computed must not depend on where the parts begin; bodies must
    /// not throw.
    void split(std::int64_t count, const std::function<void(std::int64_t, std::int64_t)>& body);

 private:
    void run_part(int part);
    void help(int part);

    std::int64_t count_ = 0;
    const std::function<void(std::int64_t, std::int64_t)>* body_ = nullptr;
    std::atomic<std::uint32_t> round_{0};
    std::atomic<int> busy_{0};
    std::atomic<bool> ends_{false};
    std::vector<std::jthread> helpers_;
};

}  // namespace grainfield::simulate
