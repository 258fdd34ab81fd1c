#include "tracking/calibrate/calibration_view.h"

#include <utility>

#include "tracking/calibrate/first_guess.h"

namespace grainfield::tracking {
namespace {

/// Frames are seen by blocks where a first fit leaves this many times the noise.
constexpr double kMisfitForBlocks = 2;

}  // namespace

CalibrationView view_by(Binning blocks, const Image& counts, ModelFit fit) {
    if (blocks.is_none()) return {counts, std::move(fit)};
    CalibrationOptions& options = fit.options;
    if (options.diameter) *options.diameter /= blocks.factor;
    if (options.edge_width) options.edge_width = blocks.edge_in_blocks(*options.edge_width);
    fit.detection = in_blocks(fit.detection, blocks);
    fit.refinement = in_blocks(fit.refinement, blocks);
    fit.visible = fit.visible.blocks(blocks.factor);
    fit.blocks = blocks;
    Image binned = blocks.binned(counts);
    fit.levels = levels_of(binned, fit.visible);
    return {std::move(binned), std::move(fit)};
}

bool blocks_are_enough(const BinningUse& use, const ImageModel& model) {
    if (!use.widest_edge) return true;
    const double most = (1 + kMisfitForBlocks * kMisfitForBlocks) * model.noise * model.noise;
    return model.residual_rms * model.residual_rms > most &&
           disc_in_pixels(model).edge_width <= *use.widest_edge;
}

}  // namespace grainfield::tracking
