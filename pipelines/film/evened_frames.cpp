#include "pipelines/film/evened_frames.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/support/interrupt.h"
#include "core/support/parallel.h"

namespace grainfield::pipelines {

using tracking::ClearLevelEstimator;
using tracking::Evening;

EvenedFrames::EvenedFrames(std::unique_ptr<FrameSource> source, const BackgroundOptions& options,
                           const tracking::FilmLevels& levels,
                           const tracking::VisiblePixels& visible, int threads)
    : PassedFrames(std::move(source)),
      levels_(levels),
      visible_(visible),
      frames_(options.frames),
      half_window_(options.source == BackgroundSource::running && options.window < count()
                       ? std::max<std::int64_t>(1, options.window / 2)
                       : 0),
      threads_(threads) {
    first_ = half_window_ == 0 ? evening_about(0, count()) : evening_about(0, half_window_);
    before_ = {0, first_.gain};
}

EvenedFrames::EvenedFrames(std::unique_ptr<FrameSource> source, const Image& empty_cell,
                           const tracking::FilmLevels& levels,
                           const tracking::VisiblePixels& visible, int threads)
    : PassedFrames(std::move(source)), levels_(levels), visible_(visible), threads_(threads) {
    // Noise of one picture; what is as dark as a core passes nothing.
    tracking::ClearLevels clear{empty_cell, Image(empty_cell.width(), empty_cell.height(),
                                                  static_cast<float>(levels.noise))};
    ClearLevelEstimator picture(empty_cell.width(), empty_cell.height());
    picture.add(empty_cell);
    clear.level = picture.estimate(levels, threads_).level;
    first_ = tracking::evening_of(clear, levels, visible_);
    before_ = {0, first_.gain};
}

/// From the frames [first, end), those there are.
Evening EvenedFrames::evening_about(std::int64_t first, std::int64_t end) const {
    first = std::max<std::int64_t>(first, 0);
    end = std::min(end, count());
    const std::int64_t n = std::min(frames_, end - first);
    ClearLevelEstimator estimator(width(), height());
    for (std::int64_t i = 0; i < n; ++i) {
        if (caught_signal() != 0) break;  // the frame is not needed
        const Frame frame = source().read(first + (2 * i + 1) * (end - first) / (2 * n));
        if (frame.status == FrameStatus::ok) estimator.add(frame.image);
    }
    return tracking::evening_of(estimator.estimate(levels_, threads_), levels_, visible_);
}

const Image& EvenedFrames::gain_at(std::int64_t knot) {
    if (before_.number == knot) return before_.gain;
    if (after_.number != knot) {
        if (after_.number == knot - 1) std::swap(before_, after_);
        const std::int64_t middle = knot * half_window_;
        after_ = {knot, evening_about(middle - half_window_, middle + half_window_).gain};
    }
    return after_.gain;
}

Frame EvenedFrames::read(std::int64_t index) {
    Frame frame = source().read(index);
    if (frame.status != FrameStatus::ok) return frame;
    if (half_window_ == 0) {
        tracking::even_out(frame.image, before_.gain, levels_, threads_);
        return frame;
    }
    const std::int64_t first = first_of_repeats(index, frame.image);
    last_ = {index, first, frame.image};
    tracking::even_out(frame.image, gain_of(first), levels_, threads_);
    return frame;
}

/// The first of the frames, one after the other, that are the same as this one.
std::int64_t EvenedFrames::first_of_repeats(std::int64_t index, const Image& counts) {
    while (index > 0) {
        if (last_.index == index - 1) return counts == last_.counts ? last_.first : index;
        const Frame before = source().read(index - 1);
        if (before.status != FrameStatus::ok || before.image != counts) return index;
        --index;
    }
    return index;
}

Image EvenedFrames::gain_of(std::int64_t index) {
    const std::int64_t knot = index / half_window_;
    const auto share =
        static_cast<float>(index - knot * half_window_) / static_cast<float>(half_window_);
    Image gain = gain_at(knot);
    const Image& next = gain_at(knot + 1);
    parallel_for(gain.height(), threads_, [&](std::int64_t row) {
        const auto y = static_cast<int>(row);
        for (int x = 0; x < gain.width(); ++x) {
            gain(x, y) += share * (next(x, y) - gain(x, y));
        }
    });
    return gain;
}

}  // namespace grainfield::pipelines
