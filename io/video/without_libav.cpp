// In the place of everything that uses libav where the build has none: what it would read or write
// is refused by name.
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/images/coded_image.h"
#include "io/video/colour_video.h"
#include "io/video/lossless_video.h"
#include "io/video/video_frames.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;

ErrorText refusal(std::string problem) {
    return {.problem = std::move(problem),
            .actual = "this grainfield was built without libav (GRAINFIELD_LIBAV=OFF)",
            .expected = "TIFF or PNG pictures",
            .suggestion = "convert the film to TIFF, or use a build with libav"};
}

Picture refuse_picture(const fs::path& path, std::int64_t /*max_pixels*/) {
    throw InputError(refusal(fmt::format("cannot read '{}'", path.string())));
}

bool is_jpeg(std::string_view head) {
    return head.starts_with("\xff\xd8\xff");
}

bool is_bmp(std::string_view head) {
    return head.starts_with("BM");
}

bool is_pnm(std::string_view head) {
    return head.size() >= 2 && head[0] == 'P' && head[1] >= '1' && head[1] <= '6';
}

}  // namespace

ImageFormat jpeg_format() {
    return {.name = "JPEG", .recognises = is_jpeg, .read = refuse_picture};
}

ImageFormat bmp_format() {
    return {.name = "BMP", .recognises = is_bmp, .read = refuse_picture};
}

ImageFormat pnm_format() {
    return {.name = "PNM", .recognises = is_pnm, .read = refuse_picture};
}

std::unique_ptr<FrameSource> open_video(const fs::path& path, const FrameFileOptions& /*options*/) {
    throw InputError(refusal(
        fmt::format("'{}' is neither TIFF nor PNG, and videos cannot be read", path.string())));
}

std::unique_ptr<FrameWriter> make_video_writer(const fs::path& path,
                                               const FrameWriterOptions& /*options*/,
                                               Overwrite /*overwrite*/) {
    throw OptionError(refusal(fmt::format("cannot write the video '{}'", path.string())));
}

class ColourVideo::Encoder {};

ColourVideo::ColourVideo(const fs::path& path, const ColourVideoOptions& /*options*/,
                         Overwrite /*overwrite*/) {
    throw OptionError(refusal(fmt::format("cannot write the video '{}'", path.string())));
}
ColourVideo::~ColourVideo() = default;
void ColourVideo::write(std::span<const std::uint8_t> /*rgb*/) {}
void ColourVideo::finish() {}

void write_jpeg(const fs::path& path, std::span<const std::uint8_t> /*rgb*/, int /*width*/,
                int /*height*/, Overwrite /*overwrite*/) {
    throw OptionError(refusal(fmt::format("cannot write the picture '{}'", path.string())));
}

bool is_colour_video_name(const fs::path& path) {
    return path.extension() == ".mp4" || path.extension() == ".mkv" || path.extension() == ".mov";
}

}  // namespace grainfield::io
