#include "tracking/calibrate/kept_calibration.h"

#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"
#include "tracking/calibrate/edge_fit.h"
#include "tracking/calibrate/first_guess.h"
#include "tracking/locate.h"

namespace grainfield::tracking {
namespace {

constexpr double kWorse = 1.5;
constexpr double kOtherSize = 0.02;
constexpr double kOtherLight = 0.1;

}  // namespace

void KeptCalibration::require_size(int other_width, int other_height,
                                   const std::string& film) const {
    if (other_width == width && other_height == height) return;
    throw InputError({.problem = "the kept calibration is of frames of another size",
                      .actual = fmt::format("'{}' has {} x {} px", film, other_width, other_height),
                      .expected = fmt::format("{} x {} px, as calibrated", width, height),
                      .suggestion = "calibrate again on this film"});
}

CalibrationCheck check(const ImageModel& model, const Image& counts, const VisiblePixels& visible,
                       int threads) {
    const Binning binning = model.binning;
    const VisiblePixels seen = visible.blocks(binning.factor);
    const Image darkness = model.darkness(binning.is_none() ? counts : binning.binned(counts));
    Locator locator(darkness.width(), darkness.height(), model, threads);
    locator.set_visible(seen);
    const Located found = locator.locate(darkness, {}, in_blocks(RefinementOptions{}, binning));
    const EdgeFit edges = fit_exposed_edges(darkness, found.fitted, model.disc, seen);
    const Levels levels = levels_of(counts, visible);
    return {
        .residual = found.residual_rms,
        .diameter = edges.converged && edges.pixels > 0 ? binning.in_frame(edges.disc).diameter : 0,
        .low = levels.low,
        .high = levels.high};
}

std::vector<std::string> differences(const CalibrationCheck& then, const CalibrationCheck& now) {
    std::vector<std::string> said;
    if (now.residual > kWorse * then.residual) {
        said.push_back(fmt::format(
            "the kept calibration fits badly: residual {:.3f} of the contrast, {:.3f} when it was "
            "made",
            now.residual, then.residual));
    }
    if (then.diameter > 0 && now.diameter > 0 &&
        std::abs(now.diameter / then.diameter - 1) > kOtherSize) {
        said.push_back(
            fmt::format("the spheres are not of the size that is kept: D = {:.2f} px, {:.2f} px "
                        "when it was made",
                        now.diameter, then.diameter));
    }
    const double light = (now.high - now.low) / (then.high - then.low);
    if (std::abs(light - 1) > kOtherLight) {
        said.push_back(fmt::format(
            "the light is not that of the kept calibration: contrast {:.0f} counts, {:.0f} when it "
            "was made",
            now.high - now.low, then.high - then.low));
    }
    return said;
}

}  // namespace grainfield::tracking
