#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/frame_source.h"
#include "core/option_table.h"
#include "core/trajectory.h"

namespace grainfield::app {

struct PlainFrameOptions {
    int width = 1600;           ///< [px]
    int height = 1600;          ///< [px]
    double scale = 16;          ///< pixels per diameter a [px]
    double rim_darkness = 0.6;  ///< of the mirror rim, beyond a/(2√2) from the centre [-]
    double blur = 0.08;         ///< σ of the point spread [a]
    double vignetting = 0.15;   ///< loss of light in the corners [-]
    double electrons = 1e4;     ///< at full scale
    double read_noise = 10;     ///< [electrons]
    double exposure = 0.9;      ///< brightest background [full scale]
};

OptionTable describe(PlainFrameOptions& options);

/// Frames of a trajectory of simulated grains, seen from above, and their truth in px.
///
/// The camera looks at the middle of the box, one a being `scale` pixels. A sphere is an opaque
/// disc of diameter a whose rim, where a polished sphere mirrors the light past itself, is less
/// dark (measured profile: a/(2√2) and 0.6, physics of docs/validation.md). The darkest of
/// overlapping spheres counts. Coverage is anti-aliased on a grid three times finer than the
/// pixels, blurred by a Gaussian, averaged over pixels; then shading, shot and read noise, and
/// 8 bits. Neither a tanh edge nor a product of transmissions: not the image model of the tracker.
///
/// The light is instantaneous (no motion blur). Noise depends on seed and frame only, not on the
/// number of threads. About 0.2 s a frame of 1600² on one core.
class PlainFrames : public FrameSource {
 public:
    /// `trajectory` must outlive this; z gives the layers.
    PlainFrames(SnapshotSource& trajectory, const PlainFrameOptions& options, std::uint64_t seed,
                int threads);

    std::int64_t count() const override { return trajectory_.count(); }
    int width() const override { return options_.width; }
    int height() const override { return options_.height; }
    int bit_depth() const override { return 8; }
    std::optional<double> frame_rate() const override { return std::nullopt; }
    Frame read(std::int64_t index) override;
    std::string name() const override { return "rendered frames"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

    /// Where the spheres of frame `index` are [px], with identity and layer (above or below the
    /// middle of the cell); those out of sight left out.
    Snapshot truth(std::int64_t index) const;
    TrajectoryInfo truth_info() const;

 private:
    void draw_band(Image& image, const std::vector<Vec2>& centres, int first_row, int rows,
                   std::uint64_t frame) const;

    SnapshotSource& trajectory_;
    PlainFrameOptions options_;
    std::uint64_t seed_;
    int threads_;
    std::vector<std::string> warnings_;
    Frame last_;  ///< the tracker asks for the same frame again after its calibration
};

/// The truth of such frames as a source.
class PlainTruth : public SnapshotSource {
 public:
    explicit PlainTruth(const PlainFrames& frames) : frames_(frames), info_(frames.truth_info()) {}
    const TrajectoryInfo& info() const override { return info_; }
    std::int64_t count() const override { return frames_.count(); }
    Snapshot read(std::int64_t index) override { return frames_.truth(index); }

 private:
    const PlainFrames& frames_;
    TrajectoryInfo info_;
};

}  // namespace grainfield::app
