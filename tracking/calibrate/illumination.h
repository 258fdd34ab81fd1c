#pragma once

#include <utility>
#include <vector>

#include "core/frame.h"
#include "core/support/number_archive.h"
#include "tracking/model/image_model.h"
#include "tracking/model/padded_image.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// Follows the light through a video. A lamp that fades or flickers turns the darkness d of the
/// calibration into offset + span · d. Both are found for each frame, so the fixed image model
/// holds throughout.
///
/// Before a frame is fitted, its levels are compared with those of the frame before at the same
/// ranks of the darkness values: the outer quarter of the clear pixels and of the cores. Ranks stay
/// in the same population as long as neither shrinks to a third of itself, wherever spheres go.
/// After the fit the model says which pixels are clear and which are core, and their medians settle
/// the levels, relative to those of the first frame. From about 40,000 pixels: standard error below
/// 0.001 at 10 % noise. Light that changes by the same factor f everywhere: where the background
/// varies by ΔB between clear and covered regions, span is wrong by (1 − f) ΔB I_dark/(B −
/// I_dark)², a few percent of the change. A span below 0.2 is not followed: the spheres have left.
/// O(pixels of the sample).
class IlluminationFollower {
 public:
    explicit IlluminationFollower(const ImageModel& model, VisiblePixels visible = {})
        : model_(model), visible_(std::move(visible)) {}

    /// The light of the next frame, before anything is known of its spheres.
    Illumination expected(const Image& counts);

    /// The same frame's light, corrected by what the fit says: `transmission` of
    /// the fitted model on the darkness image made with `used`. The next frame is
    /// compared with this one.
    Illumination settled(const Image& counts, const Illumination& used,
                         const PaddedImage& transmission);

    /// What the next frame is compared with.
    struct State {
        std::vector<float> sample;  ///< darkness values of the last frame as calibrated
        Illumination last;
        bool has_reference = false;
        double clear_reference = 0, core_reference = 1;

        /// Saves or restores it.
        void transfer(NumberArchive& archive);
    };
    const State& state() const { return state_; }
    void continue_from(const State& state) { state_ = state; }

 private:
    struct Pixel {
        int x, y;
        ImageModel::PixelDarkness darkness;
    };
    void choose_pixels(const Image& counts);
    std::vector<float> sample_of(const Image& counts);

    const ImageModel& model_;
    VisiblePixels visible_;
    int width_ = 0, height_ = 0;
    std::vector<Pixel> pixels_;  ///< the sample
    State state_;
};

/// Saves or restores it.
void transfer(NumberArchive& archive, Illumination& light);

}  // namespace grainfield::tracking
