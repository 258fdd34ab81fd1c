#include "io/images/tiff_description.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace grainfield::io {

namespace {

/// The text of attribute `name` of an XML tag.
std::optional<std::string_view> attribute(std::string_view tag, std::string_view name) {
    for (std::size_t at = tag.find(name); at != std::string_view::npos;
         at = tag.find(name, at + 1)) {
        const bool begins = at > 0 && (tag[at - 1] == ' ' || tag[at - 1] == '\n' ||
                                       tag[at - 1] == '\t' || tag[at - 1] == '\r');
        std::string_view rest = tag.substr(at + name.size());
        if (!begins || rest.size() < 2 || rest[0] != '=') continue;
        const char quote = rest[1];
        if (quote != '"' && quote != '\'') continue;
        rest.remove_prefix(2);
        const std::size_t end = rest.find(quote);
        if (end == std::string_view::npos) return std::nullopt;
        return rest.substr(0, end);
    }
    return std::nullopt;
}

/// A positive number that is the whole of `text`.
template <class Number>
std::optional<Number> positive(std::optional<std::string_view> text) {
    if (!text) return std::nullopt;
    Number value{};
    const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
    if (error != std::errc() || end != text->data() + text->size()) return std::nullopt;
    if (!(value > 0) || !std::isfinite(static_cast<double>(value))) return std::nullopt;
    return value;
}

/// The number after "name=" at the beginning of a line.
template <class Number>
std::optional<Number> line(std::string_view text, const std::string& name) {
    const std::size_t at = text.find("\n" + name + "=");
    if (at == std::string_view::npos) return std::nullopt;
    const std::string_view rest = text.substr(at + name.size() + 2);
    return positive<Number>(rest.substr(0, rest.find_first_of("\r\n")));
}

/// Seconds of a time unit of OME; 0: unknown.
double seconds_of(std::string_view unit) {
    if (unit == "s") return 1;
    if (unit == "ms") return 1e-3;
    if (unit == "\xc2\xb5s" || unit == "us") return 1e-6;
    if (unit == "ns") return 1e-9;
    if (unit == "min") return 60;
    return unit == "h" ? 3600 : 0;
}

/// Millimetres of a length unit of OME; 0: unknown, or not a length ("pixel").
double millimetres_of(std::string_view unit) {
    if (unit == "\xc2\xb5m" || unit == "um") return 1e-3;
    if (unit == "mm") return 1;
    if (unit == "nm") return 1e-6;
    if (unit == "cm") return 10;
    return unit == "m" ? 1000 : 0;
}

std::optional<double> length(std::string_view tag, const std::string& name) {
    const auto value = positive<double>(attribute(tag, name));
    const double unit = millimetres_of(attribute(tag, name + "Unit").value_or("\xc2\xb5m"));
    if (!value || unit == 0) return std::nullopt;
    return *value * unit;
}

/// Frames a second, where they are such as a camera can have.
std::optional<double> rate_of(double step) {
    constexpr double longest = 1e9;  // [s]
    if (!(step >= 1 / longest && step <= longest)) return std::nullopt;
    return 1 / step;
}

TiffDescription of_ome(std::string_view text) {
    TiffDescription found;
    const std::size_t begin = text.find("<Pixels");
    if (begin == std::string_view::npos) return found;
    const std::string_view tag = text.substr(begin, text.find('>', begin) - begin);
    const auto step = positive<double>(attribute(tag, "TimeIncrement"));
    const double unit = seconds_of(attribute(tag, "TimeIncrementUnit").value_or("s"));
    if (step) found.frame_rate = rate_of(*step * unit);
    const auto x = length(tag, "PhysicalSizeX");
    const auto y = length(tag, "PhysicalSizeY");
    constexpr double square = 1e-3;
    if (x && (!y || std::abs(*y / *x - 1) < square)) found.pixel_mm = x;
    found.depths = positive<std::int64_t>(attribute(tag, "SizeZ")).value_or(1);
    found.channels = positive<std::int64_t>(attribute(tag, "SizeC")).value_or(1);
    // Colours of one page are channels to OME.
    const std::size_t channel = std::min(text.find("<Channel", begin), text.size());
    const std::string_view first = text.substr(channel, text.find('>', channel) - channel);
    const auto samples = positive<std::int64_t>(attribute(first, "SamplesPerPixel")).value_or(1);
    if (found.channels % samples == 0) found.channels /= samples;
    return found;
}

TiffDescription of_imagej(std::string_view text) {
    TiffDescription found;
    found.pages = line<std::uint64_t>(text, "images");
    if (const auto step = line<double>(text, "finterval")) found.frame_rate = rate_of(*step);
    found.channels = line<std::int64_t>(text, "channels").value_or(1);
    // A film without "frames" has its times as slices.
    if (line<std::int64_t>(text, "frames").value_or(1) > 1) {
        found.depths = line<std::int64_t>(text, "slices").value_or(1);
    }
    return found;
}

}  // namespace

TiffDescription tiff_description(std::string_view text) {
    if (text.starts_with("ImageJ=")) return of_imagej(text);
    const bool is_xml = text.starts_with("<?xml") || text.starts_with("<OME");
    return is_xml && text.find("<OME") != std::string_view::npos ? of_ome(text) : TiffDescription{};
}

}  // namespace grainfield::io
