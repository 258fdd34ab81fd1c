#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pipelines/validate/stored_snapshots.h"
#include "core/frame_source.h"
#include "tests/support/layer_frames.h"

namespace grainfield::pipelines::sample {

/// Frames in memory.
class FilmFrames : public FrameSource {
 public:
    explicit FilmFrames(std::vector<Frame> frames) : frames_(std::move(frames)) {}
    std::int64_t count() const override { return static_cast<std::int64_t>(frames_.size()); }
    int width() const override { return frames_[0].image.width(); }
    int height() const override { return frames_[0].image.height(); }
    int bit_depth() const override { return 8; }
    std::optional<double> frame_rate() const override { return 100.0; }
    Frame read(std::int64_t index) override { return frames_.at(static_cast<std::size_t>(index)); }
    std::string name() const override { return "film"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
    std::vector<Frame> frames_;
    std::vector<std::string> warnings_;
};

/// A crystal patch in a liquid that moves, filmed by a camera that is not the tracker's model.
struct Film {
    std::unique_ptr<FilmFrames> frames;
    StoredSnapshots truth;
};

inline Film film(int frames, int size = 300, double diameter = 12, int missing = -1) {
    testing::CrystalPatch patch;
    patch.radius = 0.28;
    const testing::LayerScene start =
        testing::crystal_in_liquid(size, size, diameter, 0.66, patch, 3);
    testing::LayerMotion motion(start, patch, 0.04 * diameter, 3);
    Film film;
    TrajectoryInfo info;
    info.length_unit = LengthUnit::pixel;
    info.diameter = diameter;
    info.frame_rate = 100.0;
    film.truth.set_info(info);
    std::vector<Frame> pictures;
    for (int f = 0; f < frames; ++f) {
        Frame frame;
        frame.index = f;
        frame.time = 0.01 * f;
        if (f == missing) {
            frame.status = FrameStatus::missing;
            frame.message = "left out";
        } else {
            frame.image = testing::camera_frame(motion.scene(), {}, static_cast<std::uint64_t>(f));
        }
        pictures.push_back(std::move(frame));
        Snapshot truth;
        truth.frame = f;
        truth.time = 0.01 * f;
        truth.box = {{-0.5, -0.5}, {size + 0.0, size + 0.0}, {}, 0};
        truth.position = motion.scene().position;
        truth.layer = motion.scene().layer;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            truth.id.push_back(static_cast<std::int64_t>(i));
        }
        film.truth.write(truth);
        motion.advance();
    }
    film.frames = std::make_unique<FilmFrames>(std::move(pictures));
    return film;
}

}  // namespace grainfield::pipelines::sample
