#include "simulate/field/worker_team.h"

namespace grainfield::simulate {

namespace {

constexpr int spins = 2000;  // about 10 µs

template <class Value>
void wait_while(const std::atomic<Value>& variable, Value value) {
    for (int i = 0; i < spins; ++i) {
        if (variable.load(std::memory_order_acquire) != value) return;
        __builtin_ia32_pause();
    }
    variable.wait(value, std::memory_order_acquire);
}

}  // namespace

WorkerTeam::WorkerTeam(int threads) {
    for (int part = 1; part < threads; ++part) {
        helpers_.emplace_back([this, part] { help(part); });
    }
}

WorkerTeam::~WorkerTeam() {
    ends_.store(true);
    round_.fetch_add(1);
    round_.notify_all();
}

void WorkerTeam::run_part(int part) {
    const std::int64_t parts = threads();
    const std::int64_t first = count_ * part / parts;
    const std::int64_t last = count_ * (part + 1) / parts;
    if (first < last) (*body_)(first, last);
}

void WorkerTeam::help(int part) {
    std::uint32_t seen = 0;
    for (;;) {
        wait_while(round_, seen);
        ++seen;
        if (ends_.load()) return;
        run_part(part);
        if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
    }
}

void WorkerTeam::split(std::int64_t count,
                       const std::function<void(std::int64_t, std::int64_t)>& body) {
    count_ = count;
    body_ = &body;
    const auto others = static_cast<int>(helpers_.size());
    if (others > 0) {
        busy_.store(others, std::memory_order_relaxed);
        round_.fetch_add(1, std::memory_order_release);
        round_.notify_all();
    }
    run_part(0);
    for (int left = busy_.load(std::memory_order_acquire); left != 0;
         left = busy_.load(std::memory_order_acquire)) {
        wait_while(busy_, left);
    }
}

}  // namespace grainfield::simulate
