#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/io/picture_files.h"

namespace grainfield::io {

/// A writer of DNG of its own, from the descriptions of TIFF and DNG.
struct DngWriter {
    static constexpr int width = 21, height = 12;  // rows end within a byte

    int bits = 12;
    bool is_big_endian = false;
    bool is_below = true;  ///< below the page of a small picture
    unsigned photometric = 32803;
    unsigned compression = 1;
    std::array<std::uint8_t, 4> pattern{0, 1, 1, 2};
    unsigned pattern_columns = 2;
    int frame = 0;
    std::vector<std::uint16_t> table{};  ///< of linear counts; empty: none
    int rate = 0, rate_of = 1;           ///< FrameRate of CinemaDNG, a fraction [1/s]; 0: none

    std::string text() const {
        std::string out = is_big_endian ? "MM" : "II";
        append(out, 42, 2);
        append(out, 8, 4);
        const std::string pixels = packed_rows();
        std::vector<Tag> first{{254, 4, 1, number(is_below ? 1 : 0, 4)},
                               {50706, 1, 4, std::string("\1\4\0\0", 4)}};
        if (rate != 0) first.push_back({51044, 10, 1, "rate"});
        if (!is_below) add_counts(first, pixels.size());
        if (is_below) {
            for (const auto& [tag, value] : {std::pair{256U, 2U},
                                             {257U, 1U},
                                             {259U, 1U},
                                             {262U, 1U},
                                             {277U, 1U},
                                             {278U, 1U}}) {
                first.push_back({tag, 3, 1, number(value, 2)});
            }
            first.push_back({258, 3, 1, number(8, 2)});
            first.push_back({273, 4, 1, number(0, 4)});
            first.push_back({279, 4, 1, number(2, 4)});
            const std::size_t below = 8 + 2 + 12 * (first.size() + 1) + 4;
            first.push_back({330, 4, 1, number(static_cast<unsigned>(below), 4)});
            std::vector<Tag> counts{{254, 4, 1, number(0, 4)}};
            add_counts(counts, pixels.size());
            append_folder(out, first, 2 + 12 * counts.size() + 4);
            append_folder(out, counts, 0);
        } else {
            append_folder(out, first, 0);
        }
        out += pixels;
        for (const unsigned count : table) append(out, count, 2);
        if (rate != 0) {
            append(out, static_cast<unsigned>(rate), 4);
            append(out, static_cast<unsigned>(rate_of), 4);
        }
        return out;
    }

 private:
    struct Tag {
        unsigned tag = 0, type = 0, count = 0;
        std::string value;
    };

    void add_counts(std::vector<Tag>& tags, std::size_t bytes) const {
        for (const auto& [tag, value] : {std::pair{256U, static_cast<unsigned>(width)},
                                         {257U, static_cast<unsigned>(height)},
                                         {258U, static_cast<unsigned>(bits)},
                                         {259U, compression},
                                         {262U, photometric},
                                         {277U, 1U},
                                         {278U, static_cast<unsigned>(height)}}) {
            tags.push_back({tag, 3, 1, number(value, 2)});
        }
        tags.push_back({273, 4, 1, "here"});
        tags.push_back({279, 4, 1, number(static_cast<unsigned>(bytes), 4)});
        if (!table.empty()) {
            tags.push_back({50712, 3, static_cast<unsigned>(table.size()), "table"});
        }
        if (photometric == 32803) {
            tags.push_back({33421, 3, 2, number(2, 2) + number(pattern_columns, 2)});
            tags.push_back({33422, 1, 4, std::string(pattern.begin(), pattern.end())});
        }
    }

    std::string number(unsigned value, unsigned bytes) const {
        std::string out;
        append(out, value, bytes);
        return out;
    }
    void append(std::string& out, unsigned value, unsigned bytes) const {
        for (unsigned i = 0; i < bytes; ++i) {
            const unsigned shift = 8 * (is_big_endian ? bytes - 1 - i : i);
            out += static_cast<char>(value >> shift & 255U);
        }
    }
    /// The pixels stand behind the last folder, the table behind them, then the rate. `more`: bytes
    /// of the folders that follow.
    void append_folder(std::string& out, std::vector<Tag> tags, std::size_t more) const {
        std::ranges::sort(tags, {}, &Tag::tag);
        const std::size_t end = out.size() + 2 + 12 * tags.size() + 4 + more;
        const std::size_t of_table = end + packed_rows().size();
        append(out, static_cast<unsigned>(tags.size()), 2);
        for (const Tag& tag : tags) {
            append(out, tag.tag, 2);
            append(out, tag.type, 2);
            append(out, tag.count, 4);
            std::string value = tag.value;
            if (value == "here") value = number(static_cast<unsigned>(end), 4);
            if (value == "table") value = number(static_cast<unsigned>(of_table), 4);
            if (value == "rate") {
                value = number(static_cast<unsigned>(of_table + 2 * table.size()), 4);
            }
            value.resize(4);
            out += value;
        }
        append(out, 0, 4);
    }

    std::string packed_rows() const {
        std::string out;
        for (int y = 0; y < height; ++y) {
            std::string row;  // of bits
            for (int x = 0; x < width; ++x) {
                const unsigned count = picture_files::count_at(x, y, bits, frame);
                if (bits == 16) {
                    append(out, count, 2);
                    continue;
                }
                row += picture_files::bits_of(count, bits);
            }
            out += picture_files::packed(row);
        }
        return out;
    }
};

}  // namespace grainfield::io
