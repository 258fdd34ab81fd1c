#include "core/support/progress.h"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace grainfield {

namespace {

using namespace std::chrono_literals;

constexpr auto quiet_start = 2s;
constexpr auto terminal_interval = 100ms;
constexpr auto plain_interval = 10s;

}  // namespace

Progress::Progress(std::string task, std::int64_t total, std::string unit, Verbosity verbosity)
    : task_(std::move(task)),
      unit_(std::move(unit)),
      total_(total),
      verbosity_(verbosity),
      terminal_(::isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_draw_(start_) {}

Progress::~Progress() {
    finish();
}

void Progress::advance(std::int64_t done_more) {
    done_ += done_more;
    if (verbosity_ == Verbosity::quiet) return;
    const auto now = Clock::now();
    if (now - start_ < quiet_start) return;
    const Clock::duration interval =
        terminal_ ? Clock::duration(terminal_interval) : Clock::duration(plain_interval);
    if (now - last_draw_ < interval) return;
    last_draw_ = now;
    draw(false);
}

void Progress::resume_at(std::int64_t already) {
    already_ += already;
    done_ += already;
}

void Progress::count(std::int64_t more, const std::string& unit) {
    counted_ += more;
    counted_unit_ = unit;
}

void Progress::announce() {
    if (verbosity_ == Verbosity::quiet) return;
    last_draw_ = Clock::now();
    draw(false);
}

void Progress::finish() {
    if (!drawn_) return;
    draw(true);
    drawn_ = false;
}

void Progress::draw(bool last) {
    drawn_ = true;
    if (terminal_) {
        fmt::print(stderr, "\r{}\x1b[K{}", line(), last ? "\n" : "");
    } else {
        fmt::print(stderr, "{}\n", line());
    }
    std::fflush(stderr);
}

std::string Progress::line() const {
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    std::string text = total_ > 0 ? fmt::format("{} {}/{} {}", task_, done_, total_, unit_)
                                  : fmt::format("{} {} {}", task_, done_, unit_);
    if (done_ <= already_ || elapsed <= 0) return text;
    const double rate = static_cast<double>(done_ - already_) / elapsed;
    text += fmt::format(", {:.3g} {}/s", rate, unit_);
    if (counted_ > 0) {
        text +=
            fmt::format(", {:.3g} {}/s", static_cast<double>(counted_) / elapsed, counted_unit_);
    }
    if (total_ > done_) {
        text +=
            fmt::format(", {} left", format_duration(static_cast<double>(total_ - done_) / rate));
    }
    return text;
}

std::string format_duration(double seconds) {
    if (!(seconds >= 0) || !std::isfinite(seconds)) return "unknown time";
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<std::int64_t>(std::llround(seconds));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
    const std::int64_t minutes = static_cast<std::int64_t>(std::llround(seconds / 60));
    return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

}  // namespace grainfield
