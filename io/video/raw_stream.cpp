#include "io/video/raw_stream.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstring>
#include <sstream>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/printable.h"

extern char** environ;

namespace grainfield::io {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t longest_line = 1024;
constexpr int pipe_bytes = 1 << 20;
constexpr int patience = 100;         // between questions whether to go on [ms]
constexpr int ending = 20;            // between looks whether a program has ended [ms]
constexpr int longest_ending = 2000;  // [ms]

template <class Number>
std::optional<Number> number(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

[[noreturn]] void refuse(const std::string& source, std::string actual, std::string expected,
                         std::string suggestion = {}) {
    throw InputError({.problem = fmt::format("cannot read frames from '{}'", source),
                      .actual = std::move(actual),
                      .expected = std::move(expected),
                      .suggestion = std::move(suggestion)});
}

/// "30000:1001"; 0:0 is not known.
std::optional<double> rate_of(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const auto frames = number<std::int64_t>(text.substr(0, colon));
    const auto seconds = number<std::int64_t>(text.substr(colon + 1));
    if (!frames || !seconds || *frames <= 0 || *seconds <= 0) return std::nullopt;
    return static_cast<double>(*frames) / static_cast<double>(*seconds);
}

/// The colour space of YUV4MPEG2: depth, and how many numbers of colour follow the grey ones.
bool set_colour_space(RawFormat& format, std::string_view space) {
    const auto half = [](std::size_t n) { return n / 2 + n % 2; };
    const auto width = static_cast<std::size_t>(format.width);
    const auto height = static_cast<std::size_t>(format.height);
    std::size_t chroma = 0;
    std::string_view depth;
    if (space.starts_with("mono")) {
        depth = space.substr(4);
    } else {
        if (space.starts_with("420")) {
            chroma = 2 * half(width) * half(height);
        } else if (space.starts_with("422")) {
            chroma = 2 * half(width) * height;
        } else if (space.starts_with("444")) {
            chroma = 2 * width * height;
        } else {
            return false;
        }
        const std::string_view rest = space.substr(3);
        if (rest == "alpha") return false;
        if (rest.starts_with('p') && rest != "paldv") depth = rest.substr(1);
    }
    if (!depth.empty()) {
        const auto bits = number<int>(depth);
        if (!bits || *bits < 8 || *bits > 16) return false;
        format.bit_depth = *bits;
    }
    format.chroma_bytes = chroma * (format.bit_depth > 8 ? 2 : 1);
    return true;
}

void require_size(const RawFormat& format, std::int64_t max_pixels, const std::string& source) {
    const std::int64_t pixels = std::int64_t{format.width} * format.height;
    if (pixels <= max_pixels) return;
    refuse(source, fmt::format("frames of {} x {} px", format.width, format.height),
           fmt::format("at most {} px", max_pixels), "raise option 'max-pixels' if they are real");
}

}  // namespace

RawFormat yuv4mpeg_format(const std::string& line, const std::string& source) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word != "YUV4MPEG2") {
        refuse(source, fmt::format("it begins with '{}'", printable(line.substr(0, 40))),
               "a YUV4MPEG2 header", "give the size of raw frames with option 'live-size'");
    }
    RawFormat format;
    std::string space = "420";
    while (words >> word) {
        const std::string_view value = std::string_view(word).substr(1);
        if (word[0] == 'W') format.width = number<int>(value).value_or(0);
        if (word[0] == 'H') format.height = number<int>(value).value_or(0);
        if (word[0] == 'F') format.fps = rate_of(value);
        if (word[0] == 'C') space = value;
    }
    if (format.width < 1 || format.height < 1 || !set_colour_space(format, space)) {
        refuse(source, fmt::format("its header is '{}'", printable(line)),
               "width, height, and mono, mono9 to mono16, or planar YUV");
    }
    return format;
}

RawStream::RawStream(const std::string& source, const std::optional<RawFormat>& given,
                     std::int64_t max_pixels, const IsStopped& is_stopped, SilenceLimit silence)
    : name_(source == "-" ? "standard input" : source), limit_(std::move(silence)) {
    if (given) require_size(*given, max_pixels, name_);
    if (source == "-") {
        descriptor_ = ::dup(STDIN_FILENO);
    } else {
        struct stat status {};
        if (::stat(source.c_str(), &status) != 0) refuse(name_, std::strerror(errno), "a FIFO");
        if (!S_ISFIFO(status.st_mode)) {
            refuse(name_, "it is no FIFO", "a FIFO, -, a V4L2 camera or a GStreamer pipeline",
                   "give a file as an input instead: it is no live source");
        }
        // Does not wait for somebody to write.
        descriptor_ = ::open(source.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    }
    if (descriptor_ < 0) refuse(name_, std::strerror(errno), "a stream that can be read");
    ::fcntl(descriptor_, F_SETPIPE_SZ, pipe_bytes);  // fewer calls a frame, where it is granted
    try {
        begin(given, max_pixels, is_stopped);
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

RawStream::RawStream(const std::vector<std::string>& program, const std::string& source,
                     std::int64_t max_pixels, const IsStopped& is_stopped, SilenceLimit silence)
    : name_(source), limit_(std::move(silence)) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) refuse(name_, std::strerror(errno), "a pipe");
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
    std::vector<std::string> words = program;
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    // In a group of its own: Ctrl-C in a terminal is for this program, which ends the other one.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    const int failure = posix_spawnp(&program_, argv[0], &files, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    ::close(ends[1]);
    descriptor_ = ends[0];
    ::fcntl(descriptor_, F_SETPIPE_SZ, pipe_bytes);
    if (failure != 0) {
        program_ = -1;
        ::close(descriptor_);
        refuse(name_,
               fmt::format("'{}' cannot be started: {}", program.front(), std::strerror(failure)),
               "the program that reads cameras",
               "use a build with GRAINFIELD_LIVE=ON, or write frames to a FIFO");
    }
    try {
        begin(std::nullopt, max_pixels, is_stopped);
    } catch (...) {
        ::close(descriptor_);
        if (program_ > 0) {
            ::kill(-program_, SIGTERM);
            ::waitpid(program_, nullptr, 0);
        }
        throw;
    }
}

RawStream::~RawStream() {
    ::close(descriptor_);
    if (program_ <= 0) return;
    ::kill(-program_, SIGKILL);  // a camera that gives nothing would hold it
    ::waitpid(program_, nullptr, 0);
}

void RawStream::begin(const std::optional<RawFormat>& given, std::int64_t max_pixels,
                      const IsStopped& is_stopped) {
    if (given) {
        format_ = *given;
        return;
    }
    std::string line;
    const bool is_whole = read_line(line, is_stopped);
    if (was_stopped_) throw_if_interrupted("tracking");
    if (line.starts_with("ERROR ")) refuse(name_, line.substr(6), {});
    if (is_silent_) {
        refuse(name_, silence(), "frames",
               program_ > 0 ? "look at the camera and its pipeline"
                            : "start the program that writes them, or wait longer with option "
                              "'live-silence'");
    }
    if (!is_whole && line.empty()) {
        const std::string failure = was_stopped_ ? "" : failure_at_end();
        refuse(name_, failure.empty() ? "nothing came" : failure, "frames");
    }
    format_ = yuv4mpeg_format(line, name_);
    require_size(format_, max_pixels, name_);
    has_header_ = true;
}

std::string RawStream::silence() const {
    return fmt::format("nothing came for {:g} s", limit_.longest);
}

/// Returns less than `count` at the end of the stream, if it was stopped, or after a long silence.
std::size_t RawStream::read_some(std::uint8_t* to, std::size_t count, const IsStopped& is_stopped) {
    std::size_t done = 0;
    auto last = Clock::now();
    while (done < count) {
        if (is_stopped()) {
            was_stopped_ = true;
            break;
        }
        pollfd waiting{.fd = descriptor_, .events = POLLIN, .revents = 0};
        if (::poll(&waiting, 1, patience) <= 0) {
            // Judged only where nothing waits: this thread itself may have been held up.
            const std::chrono::duration<double> silent = Clock::now() - last;
            if (limit_.longest > 0 && silent.count() > limit_.longest) {
                is_silent_ = true;
                break;
            }
            if (limit_.noted > 0 && !is_noted_ && silent.count() > limit_.noted) {
                is_noted_ = true;
                if (limit_.note) limit_.note();
            }
            continue;
        }
        const ssize_t got = ::read(descriptor_, to + done, count - done);
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) continue;
        if (got < 0) read_failure_ = std::strerror(errno);
        if (got <= 0) break;
        last = Clock::now();
        done += static_cast<std::size_t>(got);
    }
    offset_ += done;
    return done;
}

/// Up to the line end, which is taken. False: none came within the longest line.
bool RawStream::read_line(std::string& line, const IsStopped& is_stopped) {
    line.clear();
    for (std::uint8_t byte = 0; line.size() < longest_line;) {
        if (read_some(&byte, 1, is_stopped) == 0) return false;
        if (byte == '\n') return true;
        line.push_back(static_cast<char>(byte));
    }
    return false;
}

/// Why no more came: reading failed, or the program that writes did. Empty: it is the usual end.
std::string RawStream::failure_at_end() {
    if (!read_failure_.empty()) return read_failure_;
    if (program_ <= 0) return {};
    int status = 0;
    pid_t ended = 0;
    for (int waited = 0; ended == 0 && waited < longest_ending; waited += ending) {
        ended = ::waitpid(program_, &status, WNOHANG);
        if (ended == 0) ::poll(nullptr, 0, ending);
    }
    if (ended != program_) return {};
    program_ = -1;
    if (WIFSIGNALED(status)) {
        return fmt::format("its program was ended by signal {}", WTERMSIG(status));
    }
    if (WEXITSTATUS(status) == 0) return {};
    return fmt::format("its program ended with exit code {}", WEXITSTATUS(status));
}

RawRead RawStream::damaged(std::string why) {
    damage_ = fmt::format("byte {}: {}", offset_, why);
    return RawRead::damaged;
}

RawRead RawStream::ended() {
    const std::string failure = failure_at_end();
    return failure.empty() ? RawRead::ended : damaged(failure);
}

RawRead RawStream::frame_line(const IsStopped& is_stopped) {
    std::string line;
    const bool is_whole = read_line(line, is_stopped);
    if (was_stopped_) return RawRead::stopped;
    if (is_silent_) return damaged(silence());
    if (!is_whole && line.empty()) return ended();
    if (is_whole && (line == "FRAME" || line.starts_with("FRAME "))) return RawRead::frame;
    if (line.starts_with("ERROR ")) return damaged(printable(line.substr(6)));
    return damaged(fmt::format("'{}' where a frame begins", printable(line.substr(0, 40))));
}

RawRead RawStream::next(std::vector<std::uint8_t>& counts, const IsStopped& is_stopped) {
    if (!damage_.empty()) return RawRead::damaged;
    if (has_header_) {
        const RawRead begun = frame_line(is_stopped);
        if (begun != RawRead::frame) return begun;
    }
    const std::size_t all = format_.count_bytes();
    counts.resize(all);
    std::size_t got = read_some(counts.data(), all, is_stopped);
    if (got == all && format_.chroma_bytes > 0) {
        skipped_.resize(format_.chroma_bytes);
        got += read_some(skipped_.data(), skipped_.size(), is_stopped);
    }
    if (got == all + format_.chroma_bytes) return RawRead::frame;
    if (was_stopped_) return RawRead::stopped;
    if (is_silent_) return damaged(silence());
    if (got == 0 && !has_header_) return ended();
    const std::string failure = failure_at_end();
    return damaged(fmt::format("{} bytes of a frame that has {}{}{}", got,
                               all + format_.chroma_bytes, failure.empty() ? "" : "; ", failure));
}

}  // namespace grainfield::io
