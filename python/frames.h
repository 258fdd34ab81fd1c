#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <pybind11/numpy.h>

#include "core/frame_source.h"
#include "python/released.h"

namespace grainfield::python {

/// The image that a 2D array of numbers holds: counts as they are. Lock held. `name` is for
/// messages. Throws InputError for other shapes, and for values that are not finite.
Image image_of(const pybind11::handle& array, const std::string& name);

/// Significant bits of what an array holds: 8 for uint8 and bool, else 16.
int bit_depth_of(const pybind11::handle& array);

/// What frames from Python have in common. A frame is a 2D array, or None if it is missing; its
/// index is its attribute frame_no where it has one (pims), else its position. Frames of another
/// size than the first throw InputError.
class PythonFrames : public FrameSource {
 public:
    int width() const override { return width_; }
    int height() const override { return height_; }
    int bit_depth() const override { return bit_depth_; }
    std::optional<double> frame_rate() const override { return frame_rate_; }
    std::string name() const override { return "frames"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

 protected:
    explicit PythonFrames(std::optional<double> frame_rate) : frame_rate_(frame_rate) {}

    /// Lock held.
    Frame frame_of(const pybind11::object& array, std::int64_t position);
    /// Size and depth of the first frame that is not None. Throws InputError if there is none.
    void require_size() const;

 private:
    std::optional<double> frame_rate_;
    int width_ = 0, height_ = 0, bit_depth_ = 16;
    std::vector<std::string> warnings_;
};

/// Frames of a sequence: what has len() and [i], read when they are asked for.
class SequenceFrames : public PythonFrames {
 public:
    SequenceFrames(const pybind11::object& frames, std::optional<double> frame_rate);
    std::int64_t count() const override { return count_; }
    Frame read(std::int64_t position) override;

 private:
    SharedObject frames_;
    std::int64_t count_;
};

/// Frames of an iterator, which come once, in order, and whose number is known at the end only.
///
/// count() is the number of frames that have come. Reading frame i fetches three more, so whoever
/// reads in order and asks again finds all. The first ten stay while they and the next are read,
/// for the calibration and who reads ahead; then those before i − 1 are gone: InputError.
class StreamedFrames : public PythonFrames {
 public:
    StreamedFrames(const pybind11::iterator& frames, std::optional<double> frame_rate);
    std::int64_t count() const override { return fetched_; }
    Frame read(std::int64_t position) override;

 private:
    void fetch_until(std::int64_t end);

    SharedObject frames_;
    std::mutex mutex_;  ///< taken before the interpreter lock
    std::deque<Frame> kept_;
    std::atomic<std::int64_t> fetched_{0};
    bool has_ended_ = false;
};

/// Whichever of them fits. Lock held. Throws InputError if `frames` is neither.
std::unique_ptr<FrameSource> frames_of(const pybind11::object& frames,
                                       std::optional<double> frame_rate);

}  // namespace grainfield::python
