#include "io/images/photron_raw.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/images/picture.h"
#include "io/input_file.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_header = 64U << 20U;

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\n";
    const auto begin = text.find_first_not_of(blanks);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// The file of the recording with one of these extensions, in lower or upper case; the present one
/// if it has one of them.
std::optional<fs::path> sibling(const fs::path& path,
                                std::initializer_list<const char*> extensions) {
    for (const char* extension : extensions) {
        if (lower(path.extension().string()) == extension) return path;
        std::string upper = extension;
        for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        for (const std::string& written : {std::string(extension), upper}) {
            fs::path candidate = path;
            candidate.replace_extension(written);
            std::error_code unreachable;
            if (fs::exists(candidate, unreachable)) return candidate;
        }
    }
    return std::nullopt;
}

/// What stands between <tag> and </tag> in an XML text; nested for a path "a/b".
std::string_view element(std::string_view text, std::string_view path) {
    while (!path.empty()) {
        const std::size_t slash = std::min(path.find('/'), path.size());
        const std::string tag(path.substr(0, slash));
        path.remove_prefix(std::min(slash + 1, path.size()));
        const std::size_t begin = text.find("<" + tag + ">");
        if (begin == std::string_view::npos) return {};
        text.remove_prefix(begin + tag.size() + 2);
        const std::size_t end = text.find("</" + tag + ">");
        if (end == std::string_view::npos) return {};
        text = text.substr(0, end);
    }
    return trimmed(text);
}

/// The value of a line "Key : Value".
std::string_view line_value(std::string_view text, std::string_view key) {
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::string_view line = text.substr(begin, end - begin);
        begin = end + 1;
        const std::size_t colon = line.find(" : ");
        if (colon != std::string_view::npos && trimmed(line.substr(0, colon)) == key) {
            return trimmed(line.substr(colon + 3));
        }
    }
    return {};
}

/// One thing that the header says, under its name in either kind of header.
struct Field {
    const char* line;
    const char* element;
};
constexpr Field field_width{"Image Width", "imageDataInfo/resolution/width"};
constexpr Field field_height{"Image Height", "imageDataInfo/resolution/height"};
constexpr Field field_bits{"Color Bit", "imageDataInfo/colorInfo/bit"};
constexpr Field field_colour{"Color Type", "imageDataInfo/colorInfo/type"};
constexpr Field field_depth{"EffectiveBit Depth", "imageDataInfo/effectiveBit/depth"};
constexpr Field field_side{"EffectiveBit Side", "imageDataInfo/effectiveBit/side"};
constexpr Field field_frames{"Total Frame", "frameInfo/totalFrame"};
constexpr Field field_rate{"Record Rate(fps)", "recordInfo/recordRate"};

class Header {
 public:
    explicit Header(fs::path path)
        : path_(std::move(path)), text_(read_content(path_, longest_header)) {
        const std::size_t begin = text_.find("<cih>");
        const std::size_t end = text_.rfind("</cih>");
        is_xml_ = begin != std::string::npos && end != std::string::npos && begin < end;
        if (is_xml_) text_ = text_.substr(begin, end - begin);
    }

    std::string text(const Field& field) const {
        return std::string(is_xml_ ? element(text_, field.element) : line_value(text_, field.line));
    }

    std::optional<double> number(const Field& field) const {
        const std::string value = text(field);
        double parsed = 0;
        const char* end = value.data() + value.size();
        const auto [stop, problem] = std::from_chars(value.data(), end, parsed);
        if (problem != std::errc() || stop != end || !std::isfinite(parsed)) return std::nullopt;
        return parsed;
    }

    std::int64_t count(const Field& field, double most) const {
        const auto value = number(field);
        if (value && *value >= 0 && *value <= most && *value == std::floor(*value)) {
            return static_cast<std::int64_t>(*value);
        }
        throw InputError(
            {.problem = fmt::format("'{}' does not describe a recording", path_.string()),
             .actual = fmt::format("{} '{}'", is_xml_ ? field.element : field.line, text(field)),
             .expected = fmt::format("a whole number, 0 … {:g}", most),
             .suggestion = "copy the header again from where it was recorded"});
    }

    const fs::path& path() const { return path_; }

 private:
    fs::path path_;
    std::string text_;
    bool is_xml_ = false;
};

class PhotronFrames : public FrameSource {
 public:
    PhotronFrames(fs::path frames, const Header& header, const FrameFileOptions& options)
        : path_(std::move(frames)), given_rate_(options.fps) {
        require_input_file(path_);
        constexpr double most_pixels = 1e9, most_frames = 1e12;
        const std::int64_t width = header.count(field_width, most_pixels);
        const std::int64_t height = header.count(field_height, most_pixels);
        require_pixel_count(header.path(), width, height, options.max_pixels);
        width_ = static_cast<int>(width);
        height_ = static_cast<int>(height);
        stored_bits_ = static_cast<int>(header.count(field_bits, 64));
        depth_ = static_cast<int>(header.count(field_depth, 64));
        is_high_ = lower(header.text(field_side)) == "higher";
        require_depth(header);
        const auto pixels = static_cast<std::uint64_t>(width * height);
        frame_bytes_ = (pixels * static_cast<std::uint64_t>(stored_bits_) + 7) / 8;
        const std::int64_t declared = header.count(field_frames, most_frames);
        count_ = std::min(declared, static_cast<std::int64_t>(fs::file_size(path_) / frame_bytes_));
        if (count_ == 0) throw CorruptPicture(path_, "no whole frame in it");
        if (count_ < declared) {
            warnings_.push_back(fmt::format("'{}' is cut short: {} whole frames of {} declared",
                                            name(), count_, declared));
        }
        const std::string colour = header.text(field_colour);
        if (!colour.empty() && lower(colour) != "mono" && !options.knows_filter) {
            warnings_.push_back(fmt::format(
                "'{}' holds pixels of colour type '{}', not Mono: if they are a mosaic, give "
                "option 'mosaic'",
                name(), colour));
        }
        const auto rate = header.number(field_rate);
        // No camera is slower or faster, and times stay finite.
        if (rate && *rate >= 1e-9 && *rate <= 1e9) rate_ = rate;
        file_.open(path_, std::ios::binary);
    }

    std::int64_t count() const override { return count_; }
    int width() const override { return width_; }
    int height() const override { return height_; }
    int bit_depth() const override { return depth_; }
    std::optional<double> frame_rate() const override { return given_rate_ ? given_rate_ : rate_; }
    std::string name() const override { return path_.string(); }
    const std::vector<std::string>& warnings() const override { return warnings_; }

    Frame read(std::int64_t index) override {
        require_frame_index(index, count_, name());
        Frame frame;
        frame.index = index;
        frame.time = static_cast<double>(index) / frame_rate().value_or(1);
        frame.bit_depth = depth_;
        const std::uint64_t place = static_cast<std::uint64_t>(index) * frame_bytes_;
        std::vector<std::uint8_t> raw(frame_bytes_);
        file_.clear();
        file_.seekg(static_cast<std::streamoff>(place));
        file_.read(reinterpret_cast<char*>(raw.data()), static_cast<std::streamsize>(raw.size()));
        if (static_cast<std::uint64_t>(file_.gcount()) != frame_bytes_) {
            frame.status = FrameStatus::corrupt;
            frame.message = fmt::format("byte {}: the file has become shorter", place);
            return frame;
        }
        frame.image = Image(width_, height_);
        unpack(raw, frame.image.pixels());
        const auto loud = std::ranges::find_if(frame.image.pixels(), [&](float v) {
            return v >= std::exp2(static_cast<float>(depth_));
        });
        if (loud != frame.image.pixels().end()) {
            frame.status = FrameStatus::corrupt;
            frame.message =
                fmt::format("a count of {} where the header says {} bit", *loud, depth_);
            frame.image = {};
        }
        return frame;
    }

 private:
    void require_depth(const Header& header) const {
        const bool is_known = stored_bits_ == 8 || stored_bits_ == 12 || stored_bits_ == 16;
        if (is_known && depth_ >= 1 && depth_ <= stored_bits_) return;
        throw InputError(
            {.problem = fmt::format("cannot use the recording '{}'", path_.string()),
             .actual = fmt::format("{} bit a pixel, {} of them used, as '{}' says", stored_bits_,
                                   depth_, header.path().filename().string()),
             .expected = "grey pixels of 8, 12 or 16 bit",
             .suggestion = "export it as 16-bit TIFF with the recording program"});
    }

    void unpack(const std::vector<std::uint8_t>& raw, std::vector<float>& counts) const {
        const auto shift = static_cast<unsigned>(is_high_ ? stored_bits_ - depth_ : 0);
        for (std::size_t i = 0; i < counts.size(); ++i) {
            counts[i] = static_cast<float>(stored(raw, i) >> shift);
        }
    }

    unsigned stored(const std::vector<std::uint8_t>& raw, std::size_t pixel) const {
        if (stored_bits_ == 8) return raw[pixel];
        if (stored_bits_ == 16) {
            return raw[2 * pixel] | static_cast<unsigned>(raw[2 * pixel + 1]) << 8U;
        }
        const std::size_t at = pixel / 2 * 3;
        if (pixel % 2 == 0) {
            return static_cast<unsigned>(raw[at]) << 4U | static_cast<unsigned>(raw[at + 1]) >> 4U;
        }
        return (raw[at + 1] & 15U) << 8U | raw[at + 2];
    }

    fs::path path_;
    std::optional<double> given_rate_, rate_;
    std::ifstream file_;
    int width_ = 0, height_ = 0;
    int stored_bits_ = 0;   ///< a pixel
    int depth_ = 0;         ///< that count
    bool is_high_ = false;  ///< the highest of those stored
    std::uint64_t frame_bytes_ = 0;
    std::int64_t count_ = 0;
    std::vector<std::string> warnings_;
};

}  // namespace

bool is_photron_name(const fs::path& path) {
    const std::string extension = lower(path.extension().string());
    return extension == ".mraw" || extension == ".cih" || extension == ".cihx";
}

std::vector<fs::path> each_photron_once(const std::vector<fs::path>& files) {
    const auto recording = [](const fs::path& file) {
        return fs::path(file).replace_extension().lexically_normal();
    };
    const auto extension = [](const fs::path& file) { return lower(file.extension().string()); };
    std::vector<fs::path> kept;
    for (const fs::path& file : files) {
        const bool is_header = is_photron_name(file) && extension(file) != ".mraw";
        const auto stands_for_it = [&](const fs::path& other) {
            if (!is_photron_name(other) || recording(other) != recording(file)) return false;
            return extension(other) == ".mraw" ||
                   (extension(file) == ".cih" && extension(other) == ".cihx");
        };
        if (!is_header || std::ranges::none_of(files, stands_for_it)) kept.push_back(file);
    }
    return kept;
}

std::unique_ptr<FrameSource> open_photron(const fs::path& path, const FrameFileOptions& options) {
    require_input_file(path);
    const auto header = sibling(path, {".cihx", ".cih"});
    const auto frames = sibling(path, {".mraw"});
    if (!header || !frames) {
        throw InputError(
            {.problem = fmt::format("'{}' is half of a recording", path.string()),
             .actual = header ? "its frames are not there" : "its header is not there",
             .expected = fmt::format(
                 "'{}' beside it",
                 fs::path(path).replace_extension(header ? ".mraw" : ".cihx").filename().string()),
             .suggestion = "copy both files from where they were recorded"});
    }
    return std::make_unique<PhotronFrames>(*frames, Header(*header), options);
}

}  // namespace grainfield::io
