#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "core/trajectory.h"
#include "pipelines/render/snapshot_window.h"
#include "simulate/render/motion/lasting_ids.h"
#include "simulate/render/renderer.h"
#include "simulate/render/sampling_check.h"

namespace grainfield::pipelines {

/// The frames of a rendered trajectory as a tracker takes them, and their truth. Both can be read
/// in any order and are the same in any. One frame is kept, since the tracker reads its first one
/// twice. Of the truth only the crossings of boundaries are kept.
class RenderedFrames : public FrameSource {
 public:
    /// `trajectory` must outlive this; `box`: of its first snapshot. Throws what Renderer throws.
    RenderedFrames(SnapshotSource& trajectory, const Box& box,
                   const simulate::RenderOptions& options, std::uint64_t seed, int threads,
                   RunPlan& plan);

    std::int64_t count() const override { return trajectory_.count(); }
    int width() const override { return renderer_.view().width(); }
    int height() const override { return renderer_.view().height(); }
    int bit_depth() const override { return options_.sensor.bits; }
    std::optional<double> frame_rate() const override { return info_.frame_rate; }
    Frame read(std::int64_t index) override;
    std::string name() const override { return "rendered frames"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

    const TrajectoryInfo& truth_info() const { return info_; }
    /// Where the spheres of frame `index` are [px], with lasting identities. Follows all frames
    /// before it the first time; milliseconds each, none is rendered.
    Snapshot truth(std::int64_t index);
    const simulate::Renderer& renderer() const { return renderer_; }
    /// Images made so far; some may have been made twice.
    std::int64_t rendered() const { return rendered_; }
    /// What adaptive sampling changes, on the first frame.
    simulate::SamplingCheck check_sampling();

 private:
    void render(std::int64_t index);

    SnapshotSource& trajectory_;
    SnapshotWindow window_;
    simulate::RenderOptions options_;
    std::uint64_t seed_;
    int threads_;
    simulate::Renderer renderer_;
    TrajectoryInfo info_;
    std::vector<std::string> warnings_;
    Frame last_;
    std::int64_t rendered_ = 0;
    simulate::LastingIds ids_;
};

/// The truth of rendered frames as a source.
class RenderedTruth : public SnapshotSource {
 public:
    explicit RenderedTruth(RenderedFrames& frames) : frames_(frames) {}
    const TrajectoryInfo& info() const override { return frames_.truth_info(); }
    std::int64_t count() const override { return frames_.count(); }
    Snapshot read(std::int64_t index) override { return frames_.truth(index); }

 private:
    RenderedFrames& frames_;
};

}  // namespace grainfield::pipelines
