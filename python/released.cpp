#include "python/released.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <pthread.h>

#include "core/support/interrupt.h"

namespace grainfield::python {

namespace {

using namespace std::chrono_literals;

/// How often signals are looked for, and how long work may take to stop.
constexpr auto between_looks = 20ms;
constexpr auto time_to_stop = 1500ms;

class Task {
 public:
    explicit Task(std::function<void()> work) : work_(std::move(work)) {}

    void run() {
        const StoppableJob stoppable(stop_);
        std::exception_ptr error;
        try {
            work_();
        } catch (...) {
            error = std::current_exception();
        }
        const std::lock_guard lock(mutex_);
        error_ = error;
        is_done_ = true;
        done_.notify_all();
    }

    bool wait(std::chrono::milliseconds at_most) {
        std::unique_lock lock(mutex_);
        return done_.wait_for(lock, at_most, [&] { return is_done_; });
    }
    void stop() { stop_ = SIGINT; }
    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }

 private:
    std::function<void()> work_;
    std::atomic<int> stop_{0};
    std::mutex mutex_;
    std::condition_variable done_;
    bool is_done_ = false;
    std::exception_ptr error_;
};

/// Threads that wait for work. They stay, since each has its own OpenMP threads.
class Workers {
 public:
    /// False when no more work is taken.
    bool take(const std::shared_ptr<Task>& task) {
        const std::lock_guard lock(mutex_);
        if (is_closed_) return false;
        waiting_.push_back(task);
        if (idle_ < waiting_.size()) threads_.emplace_back([this] { work(); });
        wake_.notify_one();
        return true;
    }

    void close() {
        const std::lock_guard lock(mutex_);
        is_closed_ = true;
        wake_.notify_all();
    }

    /// After close(): whether all work has ended.
    bool wait(std::chrono::milliseconds at_most) {
        std::unique_lock lock(mutex_);
        return ended_.wait_for(lock, at_most, [&] { return working_ == 0; });
    }

    /// Work that has not ended goes on by itself.
    void leave() {
        const bool has_ended = wait(0ms);
        for (std::thread& thread : threads_) has_ended ? thread.join() : thread.detach();
        threads_.clear();
    }

 private:
    void work() {
        std::unique_lock lock(mutex_);
        while (true) {
            ++idle_;
            wake_.wait(lock, [&] { return is_closed_ || !waiting_.empty(); });
            --idle_;
            if (waiting_.empty()) return;
            std::shared_ptr<Task> task = std::move(waiting_.front());
            waiting_.pop_front();
            ++working_;
            lock.unlock();
            task->run();
            task.reset();
            lock.lock();
            --working_;
            ended_.notify_all();
        }
    }

    std::mutex mutex_;
    std::condition_variable wake_, ended_;
    std::deque<std::shared_ptr<Task>> waiting_;
    std::size_t idle_ = 0, working_ = 0;
    bool is_closed_ = false;
    std::vector<std::thread> threads_;
};

Workers* workers = nullptr;

/// A forked child has none of the threads. What it inherits of them is left alone.
void start_anew() {
    workers = new Workers;
}

Workers& all_workers() {
    static const bool is_started = [] {
        start_anew();
        pthread_atfork(nullptr, nullptr, start_anew);
        return true;
    }();
    static_cast<void>(is_started);
    return *workers;
}

}  // namespace

void run_released(std::function<void()> work) {
    const auto task = std::make_shared<Task>(std::move(work));
    if (!all_workers().take(task)) {
        const pybind11::gil_scoped_release released;
        task->run();
        task->rethrow();
        return;
    }
    PyThreadState* state = PyEval_SaveThread();
    while (!task->wait(between_looks)) {
        PyEval_RestoreThread(state);
        if (PyErr_CheckSignals() != 0) {
            const pybind11::error_already_set raised;
            task->stop();
            const pybind11::gil_scoped_release released;
            task->wait(time_to_stop);
            throw raised;
        }
        state = PyEval_SaveThread();
    }
    PyEval_RestoreThread(state);
    task->rethrow();
}

void stop_workers() {
    Workers& all = all_workers();
    all.close();
    while (true) {
        const pybind11::gil_scoped_release released;
        if (all.wait(between_looks)) break;
        const pybind11::gil_scoped_acquire lock;
        if (PyErr_CheckSignals() == 0) continue;
        const pybind11::error_already_set raised;
        all.leave();
        throw raised;
    }
    all.leave();
}

}  // namespace grainfield::python
