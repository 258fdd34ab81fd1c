#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/frame_source.h"

namespace grainfield::io {

/// Where frames come from while they are filmed, and what becomes of those that are too many.
struct LiveOptions {
    /// "-": standard input; a FIFO; a V4L2 camera (/dev/video0, or its number); a GStreamer
    /// pipeline, known by its " ! ".
    std::string source;
    std::vector<int> size;       ///< WIDTH,HEIGHT of frames without a header [px]
    std::int64_t bit_depth = 8;  ///< of these; above 8 two bytes a count, the low one first
    std::string frames = "::";   ///< FIRST:END:STEP, of those that come
    std::int64_t queue = 64;     ///< frames that may wait, at least 10
    bool waits = false;          ///< full: the source waits; else the oldest frame is dropped
    /// [s] in which nothing comes, from the start on, then it has failed; 0: for ever; empty: for
    /// ever, and cameras and pipelines, which cannot tell that they ended, are noted after
    /// `noted_silence`.
    std::optional<double> longest_silence{};
    double noted_silence = 30;         ///< [s]
    std::function<void()> on_silence;  ///< called then, once, maybe in another thread
    std::optional<double> fps;         ///< [1/s]; empty: as the source says
    std::int64_t max_pixels = 200'000'000;
};

/// What has come so far.
struct LiveCounts {
    std::int64_t arrived = 0;   ///< frames
    std::int64_t captured = 0;  ///< of these, wanted
    std::int64_t dropped = 0;   ///< of those wanted, as the queue was full
    std::int64_t waiting = 0;   ///< of those wanted, in the queue
    double seconds = 0;         ///< from the first to the last that arrived

    /// [1/s], of all frames; 0: not known.
    double rate() const { return seconds > 0 ? static_cast<double>(arrived - 1) / seconds : 0; }
    std::string damage;      ///< why no more can be made out; empty: nothing is wrong
    bool is_silent = false;  ///< because nothing came for too long
};

/// Frames of a live source. A thread of its own takes them as they come and puts them into a queue
/// of bounded length; the oldest one makes room where it is full. The first ten, which calibration
/// may look at, are never dropped and count besides.
///
/// count() is the number of frames that came, those that were dropped included: it grows. It waits
/// for two more than were read, the end of the source, or a signal. Before the first is read it is
/// at most ten. The time of a frame is the number that it came with over the frame rate. Frames
/// are read in order; only the last ten may be read again. A dropped frame has the status missing;
/// so may any after a signal. A count that the depth does not allow makes the frame corrupt.
class LiveFrames : public FrameSource {
 public:
    ~LiveFrames() override;
    LiveFrames(const LiveFrames&) = delete;
    LiveFrames& operator=(const LiveFrames&) = delete;

    std::int64_t count() const override;
    int width() const override;
    int height() const override;
    int bit_depth() const override;
    std::optional<double> frame_rate() const override;
    /// Throws InputError for a frame that is gone.
    Frame read(std::int64_t position) override;
    std::string name() const override;
    const std::vector<std::string>& warnings() const override;

    LiveCounts counts() const;

 private:
    friend std::unique_ptr<LiveFrames> open_live(const LiveOptions& options);
    struct State;
    explicit LiveFrames(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

/// Waits for the first ten frames, or those that come within three seconds of the first.
///
/// Cameras and pipelines are read by the program grainfield-capture, which lies beside this program
/// or in the PATH. Throws OptionError for options that contradict each other; InputError if nothing
/// can be read from the source; Interrupted.
std::unique_ptr<LiveFrames> open_live(const LiveOptions& options);

}  // namespace grainfield::io
