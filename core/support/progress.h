#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace grainfield {

enum class Verbosity { quiet, normal, verbose };

/// Progress of a long job on standard error: count, rate and time left.
///
/// On a terminal one line is redrawn at most ten times a second; elsewhere a plain line appears
/// every ten seconds. Nothing is printed before two seconds have passed, nor when quiet.
class Progress {
 public:
    /// `total` ≤ 0 means unknown; `unit` is plural ("frames", "periods").
    Progress(std::string task, std::int64_t total, std::string unit, Verbosity verbosity);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void advance(std::int64_t done_more = 1);

    /// What an earlier run has done already: counted as done, not in rate and time left.
    void resume_at(std::int64_t already);

    /// A second number whose rate the line tells too: count(1200, "events") gives ", 4.1e5
    /// events/s".
    void count(std::int64_t more, const std::string& unit);

    /// Shows the line at once: for jobs whose single steps take long.
    void announce();

    /// Ends the line. Called by the destructor if not before.
    void finish();

    /// The text that would be shown now: "tracking 120/3000 frames, 41.3 frames/s, 1 min 10 s
    /// left".
    std::string line() const;

 private:
    using Clock = std::chrono::steady_clock;
    void draw(bool last);

    std::string task_;
    std::string unit_;
    std::int64_t total_;
    std::int64_t done_ = 0;
    std::int64_t already_ = 0;
    std::int64_t counted_ = 0;
    std::string counted_unit_;
    Verbosity verbosity_;
    bool terminal_;
    bool drawn_ = false;
    Clock::time_point start_;
    Clock::time_point last_draw_;
};

/// "1 h 02 min", "3 min 20 s", "4.2 s".
std::string format_duration(double seconds);

}  // namespace grainfield
