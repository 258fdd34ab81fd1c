#include "io/images/phantom_cine.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
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

constexpr std::size_t file_header_bytes = 44, bitmap_header_bytes = 40, setup_bytes = 900;
constexpr unsigned kind_grey = 0, kind_raw = 2;
constexpr unsigned version_read = 1;  // places of images in 8 bytes; in 4 before it
constexpr std::uint32_t packed_10 = 0x100, packed_12 = 0x400;
constexpr std::uint32_t filter_gbrg = 3, filter_rggb = 4;
constexpr std::uint64_t block_of_times = 1002;
constexpr double same_rate = 0.02;

struct Header {
    unsigned kind = 0;
    unsigned version = 0;
    std::uint64_t images = 0;
    std::uint64_t bitmap_at = 0, setup_at = 0, table_at = 0;
    std::int64_t width = 0, height = 0;
    bool is_upside_down = false;  ///< the lowest row stands first
    unsigned bits = 0;            ///< of a pixel, all colours of it
    std::uint32_t packing = 0;
    std::uint64_t setup_length = 0;
    double rate = 0;  ///< [1/s]
    std::uint32_t filter = 0;
    unsigned real_bits = 0;  ///< of a count

    bool has_colours() const { return bits == 24 || bits == 48; }
    unsigned stored_bits() const { return has_colours() ? bits / 3 : bits; }
    std::uint64_t image_bytes() const {
        return (static_cast<std::uint64_t>(width * height) * bits + 7) / 8;
    }
};

bool is_cine(std::string_view head) {
    if (head.size() < 8 || !head.starts_with("CI")) return false;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(head.data());
    return word(bytes + 2, 2) >= file_header_bytes && word(bytes + 4, 2) <= kind_raw &&
           word(bytes + 6, 2) <= 1;
}

class CineFrames : public FrameSource, public FrameClock {
 public:
    CineFrames(fs::path path, const FrameFileOptions& options)
        : path_(std::move(path)), given_rate_(options.fps) {
        require_input_file(path_);
        file_.open(path_, std::ios::binary);
        file_bytes_ = fs::file_size(path_);
        read_headers();
        require_usable(options.max_pixels);
        read_table();
        read_stamps();
        find_rate();
        warn(options.knows_filter);
    }

    std::int64_t count() const override { return static_cast<std::int64_t>(places_.size()); }
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
        require_frame_index(index, count(), name());
        Frame frame;
        frame.index = index;
        frame.time = time_of(index);
        frame.bit_depth = bit_depth();
        frame.message = read_image(places_[static_cast<std::size_t>(index)], frame.image);
        if (!frame.message.empty()) {
            frame.status = FrameStatus::corrupt;
            frame.image = {};
        }
        return frame;
    }

 private:
    [[noreturn]] void refuse(std::string actual, std::string expected) const {
        throw InputError({.problem = fmt::format("cannot use the Phantom recording '{}'", name()),
                          .actual = std::move(actual),
                          .expected = std::move(expected),
                          .suggestion = "save it as raw cine or 16-bit TIFF with the recording "
                                        "program"});
    }

    bool read_bytes(std::uint64_t at, std::vector<std::uint8_t>& bytes) {
        if (at > file_bytes_ || bytes.size() > file_bytes_ - at) return false;
        file_.clear();
        file_.seekg(static_cast<std::streamoff>(at));
        file_.read(reinterpret_cast<char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        return static_cast<std::size_t>(file_.gcount()) == bytes.size();
    }

    std::vector<std::uint8_t> required(std::uint64_t at, std::size_t count, const char* what) {
        std::vector<std::uint8_t> bytes(count);
        if (!read_bytes(at, bytes)) {
            throw CorruptPicture(path_, fmt::format("byte {}: its {} is cut", at, what));
        }
        return bytes;
    }

    void read_headers() {
        const auto file = required(0, file_header_bytes, "header");
        header_.kind = static_cast<unsigned>(word(file.data() + 4, 2));
        header_.version = static_cast<unsigned>(word(file.data() + 6, 2));
        require_version();
        header_.images = word(file.data() + 20, 4);
        header_.bitmap_at = word(file.data() + 24, 4);
        header_.setup_at = word(file.data() + 28, 4);
        header_.table_at = word(file.data() + 32, 4);

        const auto bitmap = required(header_.bitmap_at, bitmap_header_bytes, "bitmap header");
        const auto side = [&](std::size_t at) {
            return static_cast<std::int32_t>(word(bitmap.data() + at, 4));
        };
        header_.width = side(4);
        const std::int64_t height = side(8);
        header_.height = std::abs(height);
        header_.bits = static_cast<unsigned>(word(bitmap.data() + 14, 2));
        header_.packing = static_cast<std::uint32_t>(word(bitmap.data() + 16, 4));
        header_.is_upside_down = header_.packing == 0 && height > 0;

        const auto setup = required(header_.setup_at, setup_bytes, "setup");
        if (setup[140] != 'S' || setup[141] != 'T') {
            throw CorruptPicture(
                path_, fmt::format("byte {}: no mark of a setup", header_.setup_at + 140));
        }
        header_.setup_length = word(setup.data() + 142, 2);
        const auto in_setup = [&](std::size_t at) {
            const bool is_there = at + 4 <= header_.setup_length;
            return static_cast<std::uint32_t>(is_there ? word(setup.data() + at, 4) : 0);
        };
        header_.rate = in_setup(768);
        if (header_.rate == 0) header_.rate = static_cast<double>(word(setup.data(), 2));
        header_.filter = in_setup(808);
        header_.real_bits = in_setup(896);
    }

    // Nothing behind the version is read as what it may not be.
    void require_version() const {
        if (header_.version == version_read) return;
        refuse(fmt::format("version {} of the format", header_.version),
               fmt::format("version {}, whose image offsets have 64 bit", version_read));
    }

    void require_usable(std::int64_t max_pixels) {
        Header& h = header_;
        if (h.kind != kind_grey && h.kind != kind_raw) {
            refuse("images in JPEG", "images that are not compressed");
        }
        require_pixel_count(path_, h.width, h.height, max_pixels);
        if (h.packing == packed_10 || h.packing == packed_12) {
            h.bits = h.real_bits = h.packing == packed_10 ? 10 : 12;
            return;
        }
        const bool is_known =
            h.bits == 8 || h.bits == 16 || (h.kind == kind_grey && h.has_colours());
        if (h.packing != 0 || !is_known) {
            refuse(fmt::format("{} bit a pixel, packing {:#x}", h.bits, h.packing),
                   "8 or 16 bit a count, or packed 10 (0x100) or 12 bit (0x400)");
        }
        if (h.real_bits == 0) h.real_bits = h.stored_bits();
        if (h.real_bits > h.stored_bits()) {
            refuse(fmt::format("{} bit stored, {} of them used", h.stored_bits(), h.real_bits),
                   "no more bits used than stored");
        }
    }

    /// Frames up to the last whole one.
    void read_table() {
        const std::uint64_t per_image = header_.image_bytes() + 8;
        const std::uint64_t room =
            header_.table_at < file_bytes_ ? file_bytes_ - header_.table_at : 0;
        // A table as long as its declaration could ask for more memory than there are images.
        const std::uint64_t most = std::min(header_.images, room / (per_image + 8) + 1);
        std::vector<std::uint8_t> table(static_cast<std::size_t>(std::min(most, room / 8)) * 8);
        if (!read_bytes(header_.table_at, table)) table.clear();
        for (std::size_t i = 0; i < table.size(); i += 8) {
            places_.push_back(word(table.data() + i, 8));
        }
        while (!places_.empty() &&
               (places_.back() > file_bytes_ || file_bytes_ - places_.back() < per_image)) {
            places_.pop_back();
        }
        if (places_.empty()) throw CorruptPicture(path_, "no whole frame in it");
    }

    void read_stamps() {
        std::uint64_t at = header_.setup_at + header_.setup_length;
        std::vector<std::uint8_t> block(8);
        while (at + block.size() <= header_.table_at && read_bytes(at, block)) {
            const std::uint64_t length = word(block.data(), 4);
            if (length < block.size()) return;
            if (word(block.data() + 4, 2) == block_of_times) {
                const std::uint64_t wanted = places_.size() * 8;
                if (length - block.size() >= wanted) take_stamps(at + block.size(), wanted);
                return;
            }
            at += length;
        }
    }

    void take_stamps(std::uint64_t at, std::uint64_t length) {
        std::vector<std::uint8_t> times(static_cast<std::size_t>(length));
        if (!read_bytes(at, times)) return;
        for (std::size_t i = 0; i < times.size(); i += 8) {
            // The two lowest bits say how the clock was kept.
            const auto fraction =
                static_cast<double>(word(times.data() + i, 4) & ~std::uint64_t{3});
            const double stamp =
                static_cast<double>(word(times.data() + i + 4, 4)) + std::ldexp(fraction, -32);
            if (!stamps_.empty() && !(stamp > stamps_.back())) {
                warnings_.push_back(fmt::format(
                    "the time stamps of '{}' do not increase at frame {}; they are not used",
                    name(), i / 8));
                stamps_.clear();
                return;
            }
            stamps_.push_back(stamp);
        }
    }

    void find_rate() {
        if (header_.rate > 0) rate_ = header_.rate;
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
        if (places_.size() < header_.images) {
            warnings_.push_back(fmt::format("'{}' is cut short: {} whole frames of {} declared",
                                            name(), places_.size(), header_.images));
        }
        // The highest byte says which heads of a camera are grey.
        const std::uint32_t filter = header_.filter & 0xffffffU;
        if (header_.kind == kind_raw && filter != 0 && !knows_filter) {
            warnings_.push_back(mosaic_warning(name(), filter == filter_gbrg ? ColourFilter::gbrg
                                                       : filter == filter_rggb
                                                           ? ColourFilter::rggb
                                                           : ColourFilter::none));
        }
        if (header_.packing == packed_10) {
            warnings_.push_back(fmt::format(
                "'{}' is packed 10 bit: its counts lie on a curve of the camera, not in proportion "
                "to the light; they are taken as they are",
                name()));
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

    /// The reason why there is none; empty if there is.
    std::string read_image(std::uint64_t at, Image& image) {
        std::vector<std::uint8_t> length(4);
        if (!read_bytes(at, length)) return fmt::format("byte {}: beyond the end of the file", at);
        const std::uint64_t note = word(length.data(), 4);
        if (note < 8) return fmt::format("byte {}: a note of {} bytes", at, note);
        if (!read_bytes(at + note - 4, length)) {
            return fmt::format("byte {}: a note of {} bytes, beyond the end of the file", at, note);
        }
        const std::uint64_t bytes = word(length.data(), 4);
        if (bytes != header_.image_bytes()) {
            return fmt::format("byte {}: an image of {} bytes, not {}", at + note - 4, bytes,
                               header_.image_bytes());
        }
        raw_.resize(static_cast<std::size_t>(bytes));
        if (!read_bytes(at + note, raw_)) {
            return fmt::format("byte {}: the image is cut", at + note);
        }
        image = Image(width(), height());
        const std::uint64_t largest = fill(image);
        if (largest >> header_.real_bits == 0) return {};
        return fmt::format("byte {}: a count of {} where the header says {} bit", at + note,
                           largest, header_.real_bits);
    }

    /// Writes the counts; returns the largest.
    std::uint64_t fill(Image& image) const {
        const auto columns = static_cast<std::size_t>(header_.width);
        const auto rows = static_cast<std::size_t>(header_.height);
        std::uint64_t largest = 0;
        for (std::size_t y = 0; y < rows; ++y) {
            const std::size_t first = (header_.is_upside_down ? rows - 1 - y : y) * columns;
            float* out = image.pixels().data() + y * columns;
            for (std::size_t x = 0; x < columns; ++x) {
                out[x] = count_at(first + x, largest);
            }
        }
        return largest;
    }

    float count_at(std::size_t pixel, std::uint64_t& largest) const {
        const std::uint8_t* raw = raw_.data();
        const auto taken = [&](std::uint64_t count) {
            largest = std::max(largest, count);
            return static_cast<float>(count);
        };
        switch (header_.bits) {
            case 8:
                return taken(raw[pixel]);
            case 10:
            case 12:
                return taken(packed(pixel));
            case 16:
                return taken(word(raw + 2 * pixel, 2));
            default: {
                const unsigned bytes = header_.bits / 24;
                const auto colour = [&](std::size_t channel) {
                    const std::uint64_t count = word(raw + (3 * pixel + channel) * bytes, bytes);
                    largest = std::max(largest, count);
                    return static_cast<std::int32_t>(count);
                };
                return luma(colour(2), colour(1), colour(0));
            }
        }
    }

    /// Pixels of 10 or 12 bit begin within a byte and end in the next one.
    std::uint64_t packed(std::size_t pixel) const {
        const std::size_t bit = pixel * header_.bits;
        const std::uint8_t* at = raw_.data() + bit / 8;
        const unsigned two = static_cast<unsigned>(at[0]) << 8U | at[1];
        return two >> (16U - header_.bits - bit % 8) & ((1U << header_.bits) - 1U);
    }

    fs::path path_;
    std::optional<double> given_rate_;
    std::ifstream file_;
    std::uint64_t file_bytes_ = 0;
    Header header_;
    std::vector<std::uint64_t> places_;  ///< of the images [bytes]
    std::vector<double> stamps_;         ///< of every frame [s]; empty: none that increase
    std::optional<double> rate_;
    std::vector<std::string> warnings_;
    std::vector<std::uint8_t> raw_;  ///< one image
};

std::unique_ptr<FrameSource> open_cine(const fs::path& path, const FrameFileOptions& options) {
    return std::make_unique<CineFrames>(path, options);
}

Picture read_cine(const fs::path& path, std::int64_t max_pixels) {
    CineFrames frames(path, {.fps = {}, .max_pixels = max_pixels});
    return only_picture(frames, path);
}

}  // namespace

ImageFormat cine_format() {
    return {
        .name = "Phantom cine", .recognises = is_cine, .read = read_cine, .open_pages = open_cine};
}

}  // namespace grainfield::io
