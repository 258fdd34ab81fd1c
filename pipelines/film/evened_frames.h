#pragma once

#include <cstdint>
#include <memory>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "io/passed_frames.h"
#include "pipelines/film/background_options.h"
#include "tracking/calibrate/film_background.h"

namespace grainfield::pipelines {

/// Every frame with its background evened out (tracking::Evening).
///
/// static: one estimate from frames spread over the whole film. running: one every half window,
/// from frames spread over a window around it, in between linear; static if the film is not longer
/// than the window. A frame that repeats the one before, pixel by pixel, is evened as that one was,
/// so that it still repeats it. All this is a function of the film and the position alone: a run
/// that is taken up again sees the same. Bad frames pass as they are.
///
/// A read computes, on the threads of the team that the caller holds: it is not for the thread that
/// reads ahead, which stands between this and the files.
class EvenedFrames : public io::PassedFrames {
 public:
    EvenedFrames(std::unique_ptr<FrameSource> source, const BackgroundOptions& options,
                 const tracking::FilmLevels& levels, const tracking::VisiblePixels& visible,
                 int threads);
    /// Over a picture of the empty, lit cell.
    EvenedFrames(std::unique_ptr<FrameSource> source, const Image& empty_cell,
                 const tracking::FilmLevels& levels, const tracking::VisiblePixels& visible,
                 int threads);

    Frame read(std::int64_t index) override;
    /// Whether the estimate changes along the film.
    bool is_running() const { return half_window_ > 0; }
    /// Of the first estimate.
    const tracking::Evening& first() const { return first_; }

 private:
    /// The estimate about position `knot` times half a window.
    struct Knot {
        std::int64_t number = -1;
        Image gain;
    };
    tracking::Evening evening_about(std::int64_t first, std::int64_t end) const;
    const Image& gain_at(std::int64_t knot);
    Image gain_of(std::int64_t index);
    std::int64_t first_of_repeats(std::int64_t index, const Image& counts);

    tracking::FilmLevels levels_;
    tracking::VisiblePixels visible_;
    std::int64_t frames_ = 0;
    std::int64_t half_window_ = 0;  ///< [frames]; 0: one estimate for all
    int threads_ = 0;
    tracking::Evening first_;
    Knot before_, after_;
    /// The frame read last as it came, and the first of those that it repeats.
    struct Raw {
        std::int64_t index = -2;
        std::int64_t first = -2;
        Image counts;
    };
    Raw last_;
};

}  // namespace grainfield::pipelines
