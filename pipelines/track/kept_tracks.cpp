#include "pipelines/track/kept_tracks.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace grainfield::pipelines {

namespace {

// From a region to the frames of the source.
Snapshot moved_by(Snapshot snapshot, Vec2 origin) {
    for (Vec2& p : snapshot.position) p += origin;
    snapshot.box.origin += origin;
    return snapshot;
}

}  // namespace

KeptTracks::KeptTracks(OutputFile output, const TrajectoryInfo& info, Vec2 origin,
                       io::SnapshotLog* log)
    : writer_(std::move(output), info), origin_(origin), log_(log) {}

void KeptTracks::write(const Snapshot& snapshot) {
    const std::lock_guard lock(mutex_);
    if (log_ != nullptr) log_->write(snapshot);
    keep(snapshot);
}

void KeptTracks::replay() {
    for (std::int64_t i = 0; log_ != nullptr && i < log_->count(); ++i) {
        const std::lock_guard lock(mutex_);
        keep(log_->read(i));
    }
}

void KeptTracks::keep(const Snapshot& snapshot) {
    if (origin_ == Vec2{}) {
        writer_.write(snapshot);
    } else {
        writer_.write(moved_by(snapshot, origin_));
    }
    ++frames_;
    particles_ += static_cast<double>(snapshot.size());
    last_frame_ = snapshot.frame;
    for (Preview& preview : previews_) {
        if (preview.snapshot.frame == snapshot.frame) preview.snapshot = snapshot;
    }
}

void KeptTracks::add_preview(const Frame& frame, const Snapshot& found) {
    const std::lock_guard lock(mutex_);
    previews_.push_back({frame, found, {}});
}

void KeptTracks::add_curve(const Curve& curve) {
    const std::lock_guard lock(mutex_);
    writer_.add_curve(curve);
}

void KeptTracks::finish(const RunRecord& record) {
    const std::lock_guard lock(mutex_);
    for (const Preview& preview : previews_) {
        // Frames that still waited for their tracks to grow are not in the file.
        if (preview.snapshot.frame > last_frame_) continue;
        Preview moved = preview;
        moved.snapshot = moved_by(std::move(moved.snapshot), origin_);
        writer_.add_preview(moved);
    }
    writer_.finish(record);
}

std::int64_t KeptTracks::frames() const {
    const std::lock_guard lock(mutex_);
    return frames_;
}

double KeptTracks::particles_mean() const {
    return particles_ / static_cast<double>(std::max<std::int64_t>(frames(), 1));
}

LastAct::LastAct(Job job, const Resumable& resumable)
    : job_(std::move(job)), resumable_(resumable) {}

void LastAct::holds(KeptTracks* tracks, const Job& job) {
    const std::lock_guard lock(mutex_);
    tracks_ = tracks;
    job_ = job;
}

std::string LastAct::operator()() {
    const std::lock_guard lock(mutex_);
    const std::string output = resumable_.output().string();
    if (tracks_ == nullptr || tracks_->frames() == 0) {
        resumable_.abandon();
        return fmt::format("error: tracking interrupted in the first frame; '{}' was not written.",
                           output);
    }
    job_.plan.warn(WarningCode::incomplete,
                   fmt::format("interrupted within a frame; '{}' holds the {} before it{}", output,
                               counted(tracks_->frames(), "frame"), resumable_.advice()));
    tracks_->finish(job_.record());
    resumable_.abandon();
    return "warning: " + job_.plan.warnings().back().text;
}

}  // namespace grainfield::pipelines
