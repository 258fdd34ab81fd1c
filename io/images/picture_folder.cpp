#include "io/images/picture_folder.h"

#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/images/picture.h"
#include "io/images/tiff_format.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;

class PictureFolder : public FrameWriter {
 public:
    PictureFolder(fs::path folder, const FrameWriterOptions& options, Overwrite overwrite)
        : folder_(std::move(folder)),
          options_(options),
          format_(options.format == nullptr ? tiff_format() : *options.format),
          overwrite_(overwrite) {
        if (format_.write == nullptr) {
            throw OptionError({.problem = fmt::format("{} files are only read", format_.name),
                               .actual = {},
                               .expected = "a format that can be written",
                               .suggestion = {}});
        }
        std::error_code error;
        if (fs::exists(folder_, error) && !fs::is_directory(folder_, error)) {
            throw OutputError({.problem = fmt::format("cannot write '{}'", folder_.string()),
                               .actual = "this is a file",
                               .expected = "a folder, or a name ending in .avi or .mkv",
                               .suggestion = {}});
        }
        fs::create_directories(folder_, error);
        if (error) fail_to_write(folder_, error.message());
        if (overwrite_ == Overwrite::refuse) refuse_old_frames();
    }

    void write(const Frame& frame) override {
        const std::vector<std::uint8_t> bytes = counts_of(frame, options_);
        OutputFile file(path_of(frame.index), overwrite_);
        format_.write(file.temporary(), bytes,
                      {options_.width, options_.height, options_.bit_depth});
        file.commit();
    }

    void finish() override {}

    bool holds(std::int64_t index) const override {
        const fs::path path = path_of(index);
        std::error_code unreachable;
        if (!fs::is_regular_file(path, unreachable)) return false;
        try {
            const auto most_pixels = static_cast<std::int64_t>(options_.width) * options_.height;
            const PictureShape found = format_.read(path, most_pixels).shape();
            // Words have 16 bit, whatever the camera has.
            return found.width == options_.width && found.height == options_.height &&
                   (found.bit_depth > 8) == (options_.bit_depth > 8);
        } catch (const InputError&) {
            return false;
        }
    }

    std::vector<fs::path> outputs() const override { return {folder_}; }

 private:
    fs::path path_of(std::int64_t index) const {
        return folder_ / fmt::format("frame-{:06}.{}", index, format_.extension);
    }

    // Frames of an older, longer series would join the new one unseen.
    void refuse_old_frames() const {
        for (const auto& entry : fs::directory_iterator(folder_)) {
            if (!entry.path().filename().string().starts_with("frame-")) continue;
            throw OutputError(
                {.problem = fmt::format("cannot write to '{}'", folder_.string()),
                 .actual = fmt::format("it holds '{}' already", entry.path().filename().string()),
                 .expected = {},
                 .suggestion = "give another name, or option 'force' to replace frames"});
        }
    }

    fs::path folder_;
    FrameWriterOptions options_;
    ImageFormat format_;
    Overwrite overwrite_;
};

}  // namespace

std::unique_ptr<FrameWriter> make_picture_folder(const fs::path& path,
                                                 const FrameWriterOptions& options,
                                                 Overwrite overwrite) {
    return std::make_unique<PictureFolder>(path, options, overwrite);
}

}  // namespace grainfield::io
