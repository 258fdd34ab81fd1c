#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/frame_source.h"
#include "core/trajectory.h"

namespace grainfield::testing {

/// Frames from memory: every `step`-th of a longer film.
class MemoryFrames : public FrameSource {
 public:
    explicit MemoryFrames(std::vector<Frame> frames, std::int64_t step = 1)
        : frames_(std::move(frames)) {
        for (std::size_t i = 0; i < frames_.size(); ++i) {
            frames_[i].index = static_cast<std::int64_t>(i) * step;
            frames_[i].time = static_cast<double>(i);
        }
    }
    explicit MemoryFrames(const std::vector<Image>& images) : MemoryFrames(framed(images)) {}

    std::int64_t count() const override { return static_cast<std::int64_t>(frames_.size()); }
    int width() const override { return frames_[0].image.width(); }
    int height() const override { return frames_[0].image.height(); }
    int bit_depth() const override { return 8; }
    std::optional<double> frame_rate() const override { return std::nullopt; }
    Frame read(std::int64_t index) override { return frames_.at(static_cast<std::size_t>(index)); }
    std::string name() const override { return "memory"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
    static std::vector<Frame> framed(const std::vector<Image>& images) {
        std::vector<Frame> frames(images.size());
        for (std::size_t i = 0; i < images.size(); ++i) frames[i].image = images[i];
        return frames;
    }

    std::vector<Frame> frames_;
    std::vector<std::string> warnings_;
};

/// Keeps every snapshot.
class Collect : public SnapshotSink {
 public:
    void write(const Snapshot& snapshot) override {
        require_consistent(snapshot);
        snapshots.push_back(snapshot);
    }
    std::vector<Snapshot> snapshots;
};

}  // namespace grainfield::testing
