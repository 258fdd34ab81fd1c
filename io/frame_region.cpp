#include "io/frame_region.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/image_part.h"
#include "io/passed_frames.h"

namespace grainfield::io {
namespace {

/// Everything but what read() changes.
class ChangedFrames : public PassedFrames {
 public:
    using PassedFrames::PassedFrames;

    Frame read(std::int64_t index) override {
        Frame frame = source().read(index);
        if (frame.status == FrameStatus::ok) change(frame.image);
        return frame;
    }

 private:
    virtual void change(Image& image) = 0;
};

class CroppedFrames : public ChangedFrames {
 public:
    CroppedFrames(std::unique_ptr<FrameSource> source, const FrameRegion& region)
        : ChangedFrames(std::move(source)), region_(region) {}

    int width() const override { return region_.width; }
    int height() const override { return region_.height; }

 private:
    void change(Image& image) override { image = cropped(image, region_); }

    FrameRegion region_;
};

class FlattenedFrames : public ChangedFrames {
 public:
    FlattenedFrames(std::unique_ptr<FrameSource> source, Image factor)
        : ChangedFrames(std::move(source)), factor_(std::move(factor)) {}

 private:
    void change(Image& image) override {
        std::transform(image.pixels().begin(), image.pixels().end(), factor_.pixels().begin(),
                       image.pixels().begin(), [](float v, float f) { return v * f; });
    }

    Image factor_;
};

}  // namespace

std::optional<FrameRegion> region_within(std::span<const int> sides, int width, int height) {
    if (sides.empty()) return std::nullopt;
    const auto refuse = [&](const std::string& actual) {
        throw OptionError({.problem = "the region cannot be used",
                           .actual = actual,
                           .expected = fmt::format("X,Y,WIDTH,HEIGHT within {} x {} px, at least "
                                                   "16 x 16",
                                                   width, height),
                           .suggestion = "for example 100,50,800,600"});
    };
    if (sides.size() != 4) refuse(fmt::format("{} numbers", sides.size()));
    const FrameRegion r{sides[0], sides[1], sides[2], sides[3]};
    // Compared by differences, so that no number of the user can overflow.
    if (r.x < 0 || r.y < 0 || r.x > width || r.y > height || r.width < 16 || r.height < 16 ||
        r.width > width - r.x || r.height > height - r.y) {
        refuse(
            fmt::format("{},{},{},{} does not lie within the frame", r.x, r.y, r.width, r.height));
    }
    return r;
}

Image cropped(const Image& image, const FrameRegion& region) {
    return part_of(image, region.x, region.y, region.width, region.height);
}

std::unique_ptr<FrameSource> crop_frames(std::unique_ptr<FrameSource> source,
                                         const FrameRegion& region) {
    return std::make_unique<CroppedFrames>(std::move(source), region);
}

std::unique_ptr<FrameSource> flatten_frames(std::unique_ptr<FrameSource> source,
                                            const Image& flat) {
    if (flat.width() != source->width() || flat.height() != source->height()) {
        throw InputError({.problem = "the flat field is of another size than the frames",
                          .actual = fmt::format("{} x {} px", flat.width(), flat.height()),
                          .expected = fmt::format("{} x {} px", source->width(), source->height()),
                          .suggestion = {}});
    }
    double sum = 0;
    for (const float v : flat.pixels()) {
        if (!(v > 0)) {
            throw InputError({.problem = "the flat field has a pixel without light",
                              .actual = fmt::format("{} counts", v),
                              .expected = "more than 0",
                              .suggestion = "take the mean of several pictures of the empty cell"});
        }
        sum += static_cast<double>(v);
    }
    const auto mean = static_cast<float>(sum / static_cast<double>(flat.size()));
    Image factor = flat;
    for (float& v : factor.pixels()) v = mean / v;
    return std::make_unique<FlattenedFrames>(std::move(source), std::move(factor));
}

}  // namespace grainfield::io
