#include "io/video/live_frames.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/frame_range.h"
#include "io/images/picture.h"
#include "io/video/raw_stream.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::int64_t opening = 10;  // frames that calibration may look at
constexpr std::int64_t side_by_side = 2;
constexpr std::chrono::seconds longest_opening{3};
constexpr std::chrono::milliseconds patience{100};  // between looks for a signal
constexpr std::int64_t no_end = std::numeric_limits<std::int64_t>::max() / 4;

/// A frame as it came.
struct Arrival {
    std::int64_t position = 0;         ///< among those wanted
    std::vector<std::uint8_t> counts;  ///< empty: it was dropped
};

FrameSelection wanted_frames(const std::string& range) {
    if (range.find('-') != std::string::npos) {
        throw OptionError({.problem = fmt::format("frame range '{}' cannot be used", range),
                           .actual = "a live source has no last frame to count from",
                           .expected = "FIRST:END:STEP without negative numbers",
                           .suggestion = {}});
    }
    return frame_selection(range, no_end);
}

std::optional<RawFormat> given_format(const LiveOptions& options) {
    if (options.size.empty()) return std::nullopt;
    return RawFormat{.width = options.size[0],
                     .height = options.size[1],
                     .bit_depth = static_cast<int>(options.bit_depth),
                     .fps = options.fps,
                     .chroma_bytes = 0};
}

/// The program that reads cameras: beside this one, or in the PATH.
std::string capture_program() {
    constexpr const char* name = "grainfield-capture";
    std::error_code unknown;
    const fs::path own = fs::read_symlink("/proc/self/exe", unknown);
    const fs::path beside = own.parent_path() / name;
    return !unknown && fs::exists(beside, unknown) ? beside.string() : name;
}

bool is_camera(const std::string& source) {
    if (source.find('!') != std::string::npos) return true;
    if (std::ranges::all_of(source, [](unsigned char c) { return std::isdigit(c) != 0; })) {
        return true;
    }
    std::error_code unknown;
    return fs::is_character_file(source, unknown) || source.starts_with("/dev/video");
}

std::unique_ptr<RawStream> open_stream(const LiveOptions& options) {
    const auto is_stopped = [] { return caught_signal() != 0; };
    if (!is_camera(options.source)) {
        return std::make_unique<RawStream>(
            options.source, given_format(options), options.max_pixels, is_stopped,
            SilenceLimit{.longest = options.longest_silence.value_or(0)});
    }
    if (!options.size.empty()) {
        throw OptionError({.problem = "option 'live-size' is for frames without a header",
                           .actual = fmt::format("'{}' says its size itself", options.source),
                           .expected = {},
                           .suggestion = "leave it out"});
    }
    SilenceLimit silence{.longest = options.longest_silence.value_or(0)};
    if (!options.longest_silence) {
        silence.noted = options.noted_silence;
        silence.note = options.on_silence;
    }
    return std::make_unique<RawStream>(std::vector{capture_program(), options.source},
                                       options.source, options.max_pixels, is_stopped,
                                       std::move(silence));
}

}  // namespace

struct LiveFrames::State {
    State(std::unique_ptr<RawStream> opened, const LiveOptions& options)
        : stream(std::move(opened)),
          wanted(wanted_frames(options.frames)),
          capacity(static_cast<std::size_t>(options.queue)),
          waits(options.waits),
          rate(options.fps ? options.fps : stream->format().fps) {}

    void capture();
    void count_arrival();
    bool put(std::vector<std::uint8_t>&& frame);
    void drop_oldest();
    bool wait_for(std::int64_t frames, Clock::time_point end = Clock::time_point::max());
    Frame frame_at(std::int64_t position) const;
    Frame frame_of(const Arrival& arrival) const;

    std::unique_ptr<RawStream> stream;
    FrameSelection wanted;
    std::size_t capacity;
    bool waits;
    std::optional<double> rate;
    std::vector<std::string> warnings;  // none: what is wrong is known at the end

    std::mutex mutex;
    std::condition_variable came, has_room;
    std::deque<Arrival> queue;
    bool is_over = false;
    std::exception_ptr failure;
    LiveCounts counts;
    Clock::time_point first_arrival, last_arrival;

    // Of the thread that reads.
    std::deque<Arrival> taken;  // the last ones, dropped ones too, to be read again
    std::int64_t next = 0;      // position

    std::atomic<bool> is_stopped = false;
    std::thread thread;
};

/// Of any frame, wanted or not: they say the rate of the source.
void LiveFrames::State::count_arrival() {
    const std::lock_guard lock(mutex);
    last_arrival = Clock::now();
    if (counts.arrived++ == 0) first_arrival = last_arrival;
}

/// Into the queue; false: stop.
bool LiveFrames::State::put(std::vector<std::uint8_t>&& frame) {
    std::unique_lock lock(mutex);
    if (waits) {
        has_room.wait(lock, [this] { return is_stopped || queue.size() < capacity; });
        if (is_stopped) return false;
    }
    queue.push_back({counts.captured++, std::move(frame)});
    drop_oldest();
    came.notify_all();
    return true;
}

/// Those that calibration may look at stay; they count besides.
void LiveFrames::State::drop_oldest() {
    const auto oldest = std::ranges::find_if(
        queue, [](const Arrival& arrival) { return arrival.position >= opening; });
    if (queue.end() - oldest <= static_cast<std::ptrdiff_t>(capacity)) return;
    queue.erase(oldest);
    ++counts.dropped;
}

void LiveFrames::State::capture() {
    try {
        const auto stops = [this] { return is_stopped.load(); };
        const std::int64_t end = wanted.first + (wanted.count - 1) * wanted.step + 1;
        for (std::int64_t number = 0; number < end; ++number) {
            std::vector<std::uint8_t> frame;
            if (stream->next(frame, stops) != RawRead::frame) break;
            count_arrival();
            if (number < wanted.first || (number - wanted.first) % wanted.step != 0) continue;
            if (!put(std::move(frame))) break;
        }
    } catch (...) {
        const std::lock_guard lock(mutex);
        failure = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    is_over = true;
    counts.damage = stream->damage();
    counts.is_silent = stream->is_silent();
    came.notify_all();
}

/// Until so many came in all, no more come, or a signal; true: so many came.
bool LiveFrames::State::wait_for(std::int64_t frames, Clock::time_point end) {
    std::unique_lock lock(mutex);
    while (counts.captured < frames && !is_over && caught_signal() == 0 && Clock::now() < end) {
        came.wait_for(lock, patience);
    }
    if (failure) std::rethrow_exception(failure);
    return counts.captured >= frames;
}

/// Number and time of a frame, without a picture.
Frame LiveFrames::State::frame_at(std::int64_t position) const {
    Frame frame;
    frame.index = wanted.first + position * wanted.step;
    const auto number = static_cast<double>(frame.index);
    frame.time = rate ? number / *rate : number;
    frame.bit_depth = stream->format().bit_depth;
    return frame;
}

Frame LiveFrames::State::frame_of(const Arrival& arrival) const {
    const RawFormat& format = stream->format();
    Frame frame = frame_at(arrival.position);
    if (arrival.counts.empty()) {
        frame.status = FrameStatus::missing;
        frame.message = "dropped, as the queue was full";
        return frame;
    }
    frame.image = Image(format.width, format.height);
    std::vector<float>& pixels = frame.image.pixels();
    const std::uint8_t* bytes = arrival.counts.data();
    unsigned all = 0;  // bits of all counts
    if (format.bit_depth <= 8) {
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            all |= bytes[i];
            pixels[i] = bytes[i];
        }
    } else {
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const unsigned count = bytes[2 * i] | static_cast<unsigned>(bytes[2 * i + 1]) << 8U;
            all |= count;
            pixels[i] = static_cast<float>(count);
        }
    }
    if (all >> static_cast<unsigned>(format.bit_depth) != 0) {
        frame.status = FrameStatus::corrupt;
        frame.message = fmt::format("counts above {} bit", format.bit_depth);
        frame.image = {};
    }
    return frame;
}

LiveFrames::LiveFrames(std::unique_ptr<State> state) : state_(std::move(state)) {
    state_->thread = std::thread([this] { state_->capture(); });
}

LiveFrames::~LiveFrames() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->is_stopped = true;
    }
    state_->has_room.notify_all();
    state_->thread.join();
}

std::int64_t LiveFrames::count() const {
    state_->wait_for(state_->next + side_by_side);
    const std::lock_guard lock(state_->mutex);
    const std::int64_t captured = state_->counts.captured;
    // Whoever calibrates on some of all frames finds them among those that are not dropped.
    return state_->next == 0 ? std::min(captured, opening) : captured;
}

int LiveFrames::width() const {
    return state_->stream->format().width;
}

int LiveFrames::height() const {
    return state_->stream->format().height;
}

int LiveFrames::bit_depth() const {
    return state_->stream->format().bit_depth;
}

std::optional<double> LiveFrames::frame_rate() const {
    return state_->rate;
}

std::string LiveFrames::name() const {
    return state_->stream->name();
}

const std::vector<std::string>& LiveFrames::warnings() const {
    return state_->warnings;
}

Frame LiveFrames::read(std::int64_t position) {
    State& state = *state_;
    if (position < state.next) {
        const std::int64_t back = state.next - position;
        if (position < 0 || back > static_cast<std::int64_t>(state.taken.size())) {
            throw InputError({.problem = fmt::format("frame {} of '{}' is gone", position, name()),
                              .actual = "frames of a live source are read once",
                              .expected = {},
                              .suggestion = {}});
        }
        return state.frame_of(state.taken[state.taken.size() - static_cast<std::size_t>(back)]);
    }
    for (; state.next <= position; ++state.next) {
        if (!state.wait_for(state.next + 1)) {
            if (caught_signal() == 0) require_frame_index(position, state.next, name());
            Frame none = state.frame_at(position);
            none.status = FrameStatus::missing;
            none.message = "interrupted";
            return none;
        }
        Arrival arrival{state.next, {}};
        const std::lock_guard lock(state.mutex);
        if (!state.queue.empty() && state.queue.front().position == state.next) {
            arrival = std::move(state.queue.front());
            state.queue.pop_front();
            state.has_room.notify_all();
        }
        state.taken.push_back(std::move(arrival));
        if (std::ssize(state.taken) > opening) state.taken.pop_front();
    }
    return state.frame_of(state.taken.back());
}

LiveCounts LiveFrames::counts() const {
    const std::lock_guard lock(state_->mutex);
    LiveCounts counts = state_->counts;
    counts.waiting = static_cast<std::int64_t>(state_->queue.size());
    if (counts.arrived > 0) {
        counts.seconds =
            std::chrono::duration<double>(state_->last_arrival - state_->first_arrival).count();
    }
    return counts;
}

std::unique_ptr<LiveFrames> open_live(const LiveOptions& options) {
    wanted_frames(options.frames);  // said before anything is waited for
    auto state = std::make_unique<LiveFrames::State>(open_stream(options), options);
    std::unique_ptr<LiveFrames> frames(new LiveFrames(std::move(state)));
    LiveFrames::State& opened = *frames->state_;
    const bool is_there = opened.wait_for(1);
    throw_if_interrupted("tracking");
    if (!is_there) {
        const LiveCounts counts = frames->counts();
        throw InputError({.problem = fmt::format("no frame came from '{}'", frames->name()),
                          .actual = counts.damage.empty() ? "it ended" : counts.damage,
                          .expected = "frames",
                          .suggestion = counts.is_silent
                                            ? "start what sends them, or wait longer with option "
                                              "'live-silence'"
                                            : ""});
    }
    const auto enough = std::min<std::int64_t>(opening, opened.wanted.count);
    opened.wait_for(enough, Clock::now() + longest_opening);
    throw_if_interrupted("tracking");
    return frames;
}

}  // namespace grainfield::io
