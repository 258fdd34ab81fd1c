#include "io/images/image_sequence.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "io/images/file_numbering.h"
#include "io/images/image_formats.h"
#include "io/images/picture.h"
#include "io/input_file.h"

namespace grainfield::io {

namespace {

Picture read_image(const std::filesystem::path& path, std::int64_t max_pixels,
                   std::span<const ImageFormat> formats) {
    require_input_file(path);
    const std::string head = read_head(path, bytes_to_recognise);
    if (const ImageFormat* format = find_image_format(head, formats)) {
        return format->read(path, max_pixels);
    }
    throw InputError({.problem = fmt::format("'{}' is not an image", path.string()),
                      .actual = fmt::format("it starts with '{}'", printable(head)),
                      .expected = names_of(formats) + ", like the other files of the list",
                      .suggestion = "leave it out"});
}

class ImageSequence : public FrameSource {
 public:
    ImageSequence(std::vector<std::filesystem::path> files, const FrameFileOptions& options,
                  std::span<const ImageFormat> formats)
        : options_(options), formats_(formats), rate_(options.fps) {
        for (const auto& file : files) require_input_file(file);
        given_ = files.size();
        NumberedFiles numbered = number_files(std::move(files));
        files_ = std::move(numbered.files);
        warnings_ = std::move(numbered.warnings);
        missing_names_ = std::move(numbered.missing_names);
        if (numbered.step == 0) warn_of_folders();
        warn_of_gaps();
        find_shape();
    }

    std::int64_t count() const override { return static_cast<std::int64_t>(files_.size()); }
    int width() const override { return shape_.width; }
    int height() const override { return shape_.height; }
    int bit_depth() const override { return shape_.bit_depth; }
    std::optional<double> frame_rate() const override { return rate_; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

    std::string name() const override {
        if (given_ == 1) return files_.front().string();
        return fmt::format("{} … {} ({} images)", files_.front().string(),
                           files_.back().filename().string(), given_);
    }

    Frame read(std::int64_t index) override {
        require_frame_index(index, count(), name());
        const auto& file = files_[static_cast<std::size_t>(index)];
        Frame frame;
        frame.index = index;
        frame.time = static_cast<double>(index) / rate_.value_or(1);
        frame.bit_depth = shape_.bit_depth;
        if (file.empty()) {
            frame.status = FrameStatus::missing;
            frame.message = "no file with this number";
            return frame;
        }
        try {
            Picture picture = read_image(file, options_.max_pixels, formats_);
            require_same_shape(file, index, picture.shape(), shape_);
            frame.image = std::move(picture.image);
        } catch (const CorruptPicture& damage) {
            frame.status = FrameStatus::corrupt;
            frame.message = fmt::format("'{}': {}", file.string(), damage.decoder_message());
        }
        return frame;
    }

 private:
    void warn_of_folders() {
        const auto other = std::ranges::find_if(files_, [&](const auto& file) {
            return file.parent_path() != files_.front().parent_path();
        });
        if (other == files_.end()) return;
        warnings_.push_back(fmt::format(
            "the numbers of the images do not go on from '{}' to '{}': the folders are joined as "
            "if nothing were missing between them",
            (other - 1)->string(), other->string()));
    }

    void warn_of_gaps() {
        if (missing_names_.empty()) return;
        std::string names;
        for (const auto& missing : missing_names_) {
            if (names.size() > 200) {
                names += ", …";
                break;
            }
            names += (names.empty() ? "" : ", ") + missing.filename().string();
        }
        warnings_.push_back(fmt::format("{} of {} numbered images missing: {}",
                                        missing_names_.size(), files_.size(), names));
    }

    // From the first image that can be decoded.
    void find_shape() {
        std::optional<CorruptPicture> first_damage;
        for (const auto& file : files_) {
            if (file.empty()) continue;
            try {
                const Picture picture = read_image(file, options_.max_pixels, formats_);
                shape_ = picture.shape();
                if (!rate_) rate_ = picture.frame_rate;
                if (picture.filter != ColourFilter::none && !options_.knows_filter) {
                    warnings_.push_back(mosaic_warning(name(), picture.filter));
                }
                return;
            } catch (const CorruptPicture& damage) {
                if (!first_damage) first_damage = damage;
            }
        }
        throw *first_damage;
    }

    FrameFileOptions options_;
    std::span<const ImageFormat> formats_;
    std::optional<double> rate_;  ///< [1/s]
    std::size_t given_ = 0;
    std::vector<std::filesystem::path> files_;
    std::vector<std::filesystem::path> missing_names_;
    PictureShape shape_;
    std::vector<std::string> warnings_;
};

}  // namespace

std::unique_ptr<FrameSource> open_image_sequence(std::vector<std::filesystem::path> files,
                                                 const FrameFileOptions& options,
                                                 std::span<const ImageFormat> formats) {
    return std::make_unique<ImageSequence>(std::move(files), options, formats);
}

}  // namespace grainfield::io
