#include "io/images/norpix_seq.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/frame_clock.h"
#include "io/images/detail/little_endian.h"
#include "io/input_file.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

constexpr std::string_view signature = "\xed\xfe\0\0N\0o\0r\0p\0i\0x\0"sv;
constexpr std::size_t header_bytes = 624;
constexpr std::uint32_t format_grey = 100, format_bayer = 101;
constexpr double same_rate = 0.02;

struct Header {
    std::uint32_t version = 0;
    std::uint32_t width = 0, height = 0;
    std::uint32_t stored_bits = 0, real_bits = 0;
    std::uint32_t image_bytes = 0, format = 0, allocated = 0;
    std::uint32_t distance = 0;  ///< from image to image [bytes]
    std::uint32_t compression = 0;
    double rate = 0;  ///< [1/s]

    std::uint64_t first_image() const { return version >= 5 ? 8192 : 1024; }
    /// Seconds and milliseconds; from version 5 on microseconds as well.
    std::uint64_t stamp_bytes() const { return version >= 5 ? 8 : 6; }
    unsigned bytes_a_pixel() const { return stored_bits > 8 ? 2 : 1; }
};

bool is_norpix(std::string_view head) {
    return head.starts_with(signature);
}

class NorpixFrames : public FrameSource, public FrameClock {
 public:
    NorpixFrames(fs::path path, const FrameFileOptions& options)
        : path_(std::move(path)), given_rate_(options.fps) {
        require_input_file(path_);
        file_.open(path_, std::ios::binary);
        read_header();
        require_usable(options.max_pixels);
        count_frames();
        read_stamps();
        find_rate();
        warn(options.knows_filter);
    }

    std::int64_t count() const override { return count_; }
    int width() const override { return static_cast<int>(header_.width); }
    int height() const override { return static_cast<int>(header_.height); }
    int bit_depth() const override { return static_cast<int>(header_.real_bits); }
    std::optional<double> frame_rate() const override { return given_rate_ ? given_rate_ : rate_; }
    std::string name() const override { return path_.string(); }
    const std::vector<std::string>& warnings() const override { return warnings_; }

    std::optional<FrameStamps> stamps() const override {
        if (stamps_.size() < 2) return std::nullopt;
        const double span = stamps_.back() - stamps_.front();
        return FrameStamps{stamps_.front(), stamps_.back(),
                           span / static_cast<double>(stamps_.size() - 1)};
    }

    Frame read(std::int64_t index) override {
        require_frame_index(index, count_, name());
        Frame frame;
        frame.index = index;
        frame.time = time_of(index);
        frame.bit_depth = bit_depth();
        const unsigned bytes = header_.bytes_a_pixel();
        std::vector<std::uint8_t> raw(std::size_t{header_.width} * header_.height * bytes);
        if (!read_bytes(place_of(index), raw)) {
            frame.status = FrameStatus::corrupt;
            frame.message = fmt::format("byte {}: the file has become shorter", place_of(index));
            return frame;
        }
        frame.image = Image(width(), height());
        std::uint64_t largest = 0;
        for (std::size_t i = 0; i < frame.image.size(); ++i) {
            const std::uint64_t value = word(raw.data() + i * bytes, bytes);
            largest = std::max(largest, value);
            frame.image.pixels()[i] = static_cast<float>(value);
        }
        if (largest >> header_.real_bits != 0) {
            frame.image = {};
            frame.status = FrameStatus::corrupt;
            frame.message = fmt::format("byte {}: a count of {} where the header says {} bit",
                                        place_of(index), largest, header_.real_bits);
        }
        return frame;
    }

 private:
    [[noreturn]] void refuse(std::string actual, std::string expected,
                             std::string suggestion) const {
        throw InputError({.problem = fmt::format("cannot use the Norpix sequence '{}'", name()),
                          .actual = std::move(actual),
                          .expected = std::move(expected),
                          .suggestion = std::move(suggestion)});
    }

    bool read_bytes(std::uint64_t at, std::vector<std::uint8_t>& bytes) {
        file_.clear();
        file_.seekg(static_cast<std::streamoff>(at));
        file_.read(reinterpret_cast<char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        return static_cast<std::size_t>(file_.gcount()) == bytes.size();
    }

    void read_header() {
        std::vector<std::uint8_t> bytes(header_bytes);
        if (!read_bytes(0, bytes)) throw CorruptPicture(path_, "its header is cut");
        const auto number = [&](std::size_t at) {
            return static_cast<std::uint32_t>(word(bytes.data() + at, 4));
        };
        header_ = {.version = number(28),
                   .width = number(548),
                   .height = number(552),
                   .stored_bits = number(556),
                   .real_bits = number(560),
                   .image_bytes = number(564),
                   .format = number(568),
                   .allocated = number(572),
                   .distance = number(580),
                   .compression = number(620)};
        std::memcpy(&header_.rate, bytes.data() + 584, sizeof(double));
    }

    void require_usable(std::int64_t max_pixels) const {
        const Header& h = header_;
        if (h.compression != 0) {
            refuse(fmt::format("compression {} at byte 620", h.compression),
                   "0: images that are not compressed",
                   "export it as 16-bit TIFF with the recording program");
        }
        if (h.format != format_grey && h.format != format_bayer) {
            refuse(fmt::format("image format {}", h.format),
                   "100 (grey) or 101 (raw Bayer), not compressed",
                   "export it as 16-bit TIFF with the recording program");
        }
        require_pixel_count(path_, h.width, h.height, max_pixels);
        if ((h.stored_bits != 8 && h.stored_bits != 16) || h.real_bits < 1 ||
            h.real_bits > h.stored_bits) {
            refuse(fmt::format("{} bit stored, {} of them used", h.stored_bits, h.real_bits),
                   "8 or 16 bit stored", "export it as 16-bit TIFF with the recording program");
        }
        const std::uint64_t pixels = std::uint64_t{h.width} * h.height;
        if (h.image_bytes < pixels * h.bytes_a_pixel() ||
            h.distance < std::uint64_t{h.image_bytes} + h.stamp_bytes()) {
            throw CorruptPicture(
                path_, fmt::format("byte 564: {} bytes an image, {} from one to the next, for "
                                   "{} × {} pixels of {} bit",
                                   h.image_bytes, h.distance, h.width, h.height, h.stored_bits));
        }
    }

    std::uint64_t place_of(std::int64_t frame) const {
        return header_.first_image() + static_cast<std::uint64_t>(frame) * header_.distance;
    }

    // Behind the last image its stamp may be all that the distance holds.
    void count_frames() {
        const std::uint64_t bytes = fs::file_size(path_);
        const std::uint64_t needed = std::uint64_t{header_.image_bytes} + header_.stamp_bytes();
        if (bytes >= header_.first_image() + needed) {
            count_ = static_cast<std::int64_t>(
                (bytes - header_.first_image() - needed) / header_.distance + 1);
        }
        if (header_.allocated > 0) count_ = std::min<std::int64_t>(count_, header_.allocated);
        if (count_ == 0) throw CorruptPicture(path_, "no whole frame in it");
    }

    void read_stamps() {
        std::vector<std::uint8_t> bytes(header_.stamp_bytes());
        for (std::int64_t i = 0; i < count_; ++i) {
            if (!read_bytes(place_of(i) + header_.image_bytes, bytes)) break;
            double stamp = static_cast<double>(word(bytes.data(), 4)) +
                           1e-3 * static_cast<double>(word(bytes.data() + 4, 2));
            if (bytes.size() > 6) stamp += 1e-6 * static_cast<double>(word(bytes.data() + 6, 2));
            if (!stamps_.empty() && !(stamp > stamps_.back())) {
                warnings_.push_back(fmt::format(
                    "the time stamps of '{}' do not increase at frame {}; they are not used",
                    name(), i));
                stamps_.clear();
                return;
            }
            stamps_.push_back(stamp);
        }
    }

    void find_rate() {
        // No camera is slower or faster, and times stay finite.
        const bool is_possible = header_.rate >= 1e-9 && header_.rate <= 1e9;
        if (is_possible) rate_ = header_.rate;
        const auto known = stamps();
        if (!known) return;
        const double measured = 1 / known->interval;
        if (rate_ && std::abs(*rate_ - measured) > same_rate * measured) {
            warnings_.push_back(fmt::format(
                "'{}' declares {:.6g} frames per second, its time stamps say {:.6g}; the stamps "
                "are taken",
                name(), *rate_, measured));
            rate_ = measured;
        }
        if (!rate_) rate_ = measured;
    }

    void warn(bool knows_filter) {
        if (std::cmp_less(count_, header_.allocated)) {
            warnings_.push_back(fmt::format("'{}' is cut short: {} whole frames of {} declared",
                                            name(), count_, header_.allocated));
        }
        if (header_.format == format_bayer && !knows_filter) {
            warnings_.push_back(mosaic_warning(name(), ColourFilter::none));
        }
    }

    double time_of(std::int64_t index) const {
        if (given_rate_) return static_cast<double>(index) / *given_rate_;
        if (!rate_) return static_cast<double>(index);
        if (std::cmp_less(index, stamps_.size())) {
            return stamps_[static_cast<std::size_t>(index)] - stamps_.front();
        }
        return static_cast<double>(index) / *rate_;
    }

    fs::path path_;
    std::optional<double> given_rate_;
    std::ifstream file_;
    Header header_;
    std::int64_t count_ = 0;
    std::vector<double> stamps_;  ///< of every frame [s]; empty: none that increase
    std::optional<double> rate_;
    std::vector<std::string> warnings_;
};

std::unique_ptr<FrameSource> open_norpix(const fs::path& path, const FrameFileOptions& options) {
    return std::make_unique<NorpixFrames>(path, options);
}

Picture read_norpix(const fs::path& path, std::int64_t max_pixels) {
    NorpixFrames frames(path, {.fps = {}, .max_pixels = max_pixels});
    return only_picture(frames, path);
}

}  // namespace

ImageFormat norpix_format() {
    return {.name = "Norpix seq",
            .recognises = is_norpix,
            .read = read_norpix,
            .open_pages = open_norpix};
}

}  // namespace grainfield::io
