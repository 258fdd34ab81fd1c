#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/command.h"
#include "core/trajectory.h"
#include "io/frame_files.h"
#include "io/h5/trajectory_file.h"
#include "simulate/render/renderer.h"
#include "simulate/render/sampling_check.h"

namespace grainfield::app {

/// `grainfield render`: camera frames of a trajectory.
class RenderCommand : public Command {
 public:
    std::string name() const override { return "render"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;

 private:
    struct Tally {
        std::int64_t frames = 0;
        std::int64_t lost = 0;
        double render_seconds = 0;
        double write_seconds = 0;
        double spheres = 0;
        simulate::SamplingCheck check;
    };

    Tally render_all(Session& session, SnapshotSource& source,
                     const std::vector<std::int64_t>& chosen, simulate::Renderer& renderer,
                     io::FrameWriter& writer, io::TrajectoryWriter* truth) const;
    std::optional<double> rate_of(const SnapshotSource& source, const Snapshot& first,
                                  const std::optional<Snapshot>& second,
                                  double seconds_per_unit) const;

    std::string output_;
    std::string truth_;
    std::int64_t most_frames_ = 0;
    const io::ImageFormat* format_ = io::find_image_format_named("TIFF");
    simulate::RenderOptions render_;
};

/// The snapshots nearest to the instants of a camera of `rate` [1/s] which sees the first one, of a
/// series of `count` taken `interval` [s] apart. Throws OptionError if the camera is faster.
std::vector<std::int64_t> snapshots_at_rate(std::int64_t count, double interval, double rate);

}  // namespace grainfield::app
