#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "io/passed_frames.h"
#include "tracking/calibrate/film_background.h"

namespace grainfield::app {

/// Where the background of a film comes from.
struct BackgroundOptions {
    std::string kind = "none";   ///< none, static, running, or a picture of the empty cell
    std::int64_t frames = 48;    ///< looked at for one estimate
    std::int64_t window = 1000;  ///< [frames] running: what one estimate sees
};

/// Every frame with its background evened out (tracking::Evening).
///
/// static: one estimate from frames spread over the whole film. running: one every half window,
/// from frames spread over a window around it, in between linear; a function of the film and the
/// position alone, so that a run that is taken up again sees the same. Bad frames pass as they are.
class EvenedFrames : public io::PassedFrames {
 public:
    EvenedFrames(std::unique_ptr<FrameSource> source, const BackgroundOptions& options,
                 const tracking::FilmLevels& levels, int threads);
    /// Over a picture of the empty, lit cell.
    EvenedFrames(std::unique_ptr<FrameSource> source, const Image& empty_cell,
                 const tracking::FilmLevels& levels);

    Frame read(std::int64_t index) override;
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

    tracking::FilmLevels levels_;
    std::int64_t frames_ = 0;
    std::int64_t half_window_ = 0;  ///< [frames]; 0: one estimate for all
    int threads_ = 0;
    tracking::Evening first_;
    Knot before_, after_;
};

}  // namespace grainfield::app
