#include "tracking/calibrate/film_calibration.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "tracking/repeated_warnings.h"

namespace grainfield::tracking {
namespace {

/// How many frames are tried before giving up.
constexpr std::int64_t kFramesTried = 10;

}  // namespace

FilmCalibration calibrate_film(FrameSource& source, const CalibrationOptions& calibration,
                               const DetectionOptions& detection,
                               const RefinementOptions& refinement, const VisiblePixels& visible,
                               int threads, RunPlan& plan) {
    FilmCalibration film;
    film.weighed_at = -1;
    const std::int64_t count = source.count();
    const std::int64_t tries = std::min(count, kFramesTried);
    RepeatedWarnings failed;
    for (std::int64_t i = 0; i < tries && !film.calibration; ++i) {
        const std::int64_t position = i * count / tries;
        const Frame frame = source.read(position);
        if (frame.status != FrameStatus::ok) continue;
        RunPlan attempt;
        std::vector<SizeCandidate> weighed;
        film.calibration = calibrate(frame.image, calibration, detection, refinement, threads,
                                     attempt, visible, &weighed);
        if (film.calibration || !weighed.empty()) {
            film.weighed = std::move(weighed);
            film.weighed_at = position;
        }
        if (film.calibration) {
            film.frame = frame.index;
            for (const PlannedStage& s : attempt.stages()) {
                s.runs ? plan.run(s.stage, s.reason) : plan.skip(s.stage, s.reason, s.saved);
            }
        }
        for (const Warning& warning : attempt.warnings()) {
            if (film.calibration) {
                plan.warn(warning.code, fmt::format("{}, frame {}: {}", source.name(), frame.index,
                                                    warning.text));
            } else {
                failed.add(frame.index, warning.text);
            }
        }
    }
    if (!film.calibration) {
        failed.say(source.name(), plan);
        plan.warn(fmt::format("{}: no frame to calibrate on among {} tried", source.name(), tries));
    }
    return film;
}

FilmCalibration use_kept(const KeptCalibration& kept, FrameSource& source,
                         const VisiblePixels& visible, int threads, RunPlan& plan) {
    kept.require_size(source.width(), source.height(), source.name());
    for (std::int64_t i = 0; i < source.count(); ++i) {
        const Frame frame = source.read(i);
        if (frame.status != FrameStatus::ok || !blank_reason(frame.image, visible).empty()) {
            continue;
        }
        const CalibrationCheck now = check(kept.model, frame.image, visible, threads);
        for (const std::string& warning : differences(kept.check, now)) {
            plan.warn(fmt::format("{}, frame {}: {}", source.name(), frame.index, warning));
        }
        break;
    }
    plan.skip("calibration", "kept from another run", "two or more fits of one frame");
    return {.calibration = Calibration{kept.model, {}}};
}

KeptCalibration to_keep(const FilmCalibration& film, FrameSource& source,
                        const VisiblePixels& visible, int threads) {
    const Frame frame = source.read(film.weighed_at);
    const ImageModel& model = film.calibration->model;
    return {.model = model,
            .width = source.width(),
            .height = source.height(),
            .check = check(model, frame.image, visible, threads)};
}

}  // namespace grainfield::tracking
