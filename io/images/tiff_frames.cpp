#include "io/images/tiff_frames.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/frame_scale.h"
#include "io/images/detail/tiff_file.h"

namespace grainfield::io {

namespace {

class TiffFrames : public FrameSource, public FrameScale {
 public:
    TiffFrames(const std::filesystem::path& path, const FrameFileOptions& options)
        : file_(path, options.max_pixels), fps_(options.fps) {
        find_shape();
        const TiffDescription& said = file_.description();
        if (said.channels > 1 || said.depths > 1) {
            warnings_.push_back(fmt::format(
                "'{}' holds {} channels and {} focal planes of each time: its pages are taken for "
                "frames one after the other; save one of them, or choose with frames",
                name(), said.channels, said.depths));
            if (said.frame_rate && !fps_) {
                warnings_.push_back(fmt::format(
                    "the frame rate of '{}' is not known: it states {:.6g} times a second, each of "
                    "{} pages; --fps gives the rate of the pages",
                    name(), *said.frame_rate, said.channels * said.depths));
            }
        } else if (!fps_) {
            fps_ = said.frame_rate ? said.frame_rate : file_.frame_rate();
        }
        if (filter_ != ColourFilter::none && !options.knows_filter) {
            warnings_.push_back(mosaic_warning(name(), filter_));
        }
        if (!file_.cut_message().empty()) {
            warnings_.push_back(fmt::format("'{}' is cut short after {} pages: {}", name(), count(),
                                            file_.cut_message()));
        }
    }

    std::int64_t count() const override { return static_cast<std::int64_t>(file_.pages().size()); }
    int width() const override { return shape_.width; }
    int height() const override { return shape_.height; }
    int bit_depth() const override { return shape_.bit_depth; }
    std::optional<double> frame_rate() const override { return fps_; }
    std::string name() const override { return file_.path().string(); }
    const std::vector<std::string>& warnings() const override { return warnings_; }
    std::optional<double> pixel_mm() const override { return file_.description().pixel_mm; }

    Frame read(std::int64_t index) override {
        require_frame_index(index, count(), name());
        Frame frame;
        frame.index = index;
        frame.time = static_cast<double>(index) / fps_.value_or(1);
        frame.bit_depth = shape_.bit_depth;
        try {
            Picture picture = file_.read(static_cast<std::size_t>(index));
            require_same_shape(file_.path(), index, picture.shape(), shape_);
            frame.image = std::move(picture.image);
        } catch (const CorruptPicture& damage) {
            frame.status = FrameStatus::corrupt;
            frame.message = damage.decoder_message();
        }
        return frame;
    }

 private:
    // From the first page that can be decoded; its tags alone may be part of the damage.
    void find_shape() {
        for (std::size_t i = 0;; ++i) {
            try {
                const Picture picture = file_.read(i);
                shape_ = picture.shape();
                filter_ = picture.filter;
                return;
            } catch (const CorruptPicture&) {
                if (i + 1 == file_.pages().size()) throw;
            }
        }
    }

    TiffFile file_;
    std::optional<double> fps_;
    PictureShape shape_;
    ColourFilter filter_ = ColourFilter::none;
    std::vector<std::string> warnings_;
};

}  // namespace

std::unique_ptr<FrameSource> open_tiff(const std::filesystem::path& path,
                                       const FrameFileOptions& options) {
    return std::make_unique<TiffFrames>(path, options);
}

Picture read_tiff(const std::filesystem::path& path, std::int64_t max_pixels) {
    TiffFile file(path, max_pixels);
    if (file.pages().size() == 1) return file.read(0);
    throw InputError({.problem = fmt::format("'{}' cannot be one of several images", path.string()),
                      .actual = fmt::format("it holds {} pages", file.pages().size()),
                      .expected = "one page",
                      .suggestion = "give the multi-page file alone"});
}

}  // namespace grainfield::io
