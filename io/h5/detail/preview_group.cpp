#include "io/h5/detail/preview_group.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/h5/detail/flat_columns.h"
#include "io/h5/detail/run_record_json.h"

namespace grainfield::io {

namespace {

using nlohmann::json;

struct Scale {
    double offset = 0;
    double scale = 1;
};

Scale scale_of(const std::vector<float>& pixels) {
    const auto [low, high] = std::ranges::minmax(pixels);
    const bool exact = low >= 0 && high <= 255 &&
                       std::ranges::all_of(pixels, [](float p) { return p == std::floor(p); });
    if (exact || low == high) return {exact ? 0.0 : static_cast<double>(low), 1};
    return {static_cast<double>(low), (static_cast<double>(high) - static_cast<double>(low)) / 255};
}

void write_image(const H5Group& group, const Image& image) {
    const Scale scale = scale_of(image.pixels());
    std::vector<std::uint8_t> bytes(image.size());
    std::ranges::transform(image.pixels(), bytes.begin(), [scale](float p) {
        const double level = (static_cast<double>(p) - scale.offset) / scale.scale;
        return static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L));
    });
    // A run that was interrupted ends in time: three frames of 20 million pixels are packed in 1 s.
    const bool is_late = caught_signal() != 0;
    group.write<std::uint8_t>(
        "image", bytes, {static_cast<hsize_t>(image.height()), static_cast<hsize_t>(image.width())},
        is_late ? Compression::none : Compression::gzip);
    group.set_attribute("offset", scale.offset);
    group.set_attribute("scale", scale.scale);
}

Image read_image(const H5Group& group, const H5File& file) {
    const H5Dataset data = group.dataset("image");
    const H5Extent extent = data.extent();
    constexpr hsize_t widest = 1 << 20;
    if (extent.size() != 2 || extent[0] == 0 || extent[1] == 0 || extent[0] > widest ||
        extent[1] > widest) {
        file.fail(fmt::format("{} is not an image", data.path()));
    }
    const std::vector<std::uint8_t> bytes = data.read<std::uint8_t>();
    const double offset = group.number_attribute("offset");
    const double scale = group.number_attribute("scale");
    Image image(static_cast<int>(extent[1]), static_cast<int>(extent[0]));
    std::ranges::transform(bytes, image.pixels().begin(), [offset, scale](std::uint8_t byte) {
        return static_cast<float>(offset + scale * byte);
    });
    return image;
}

template <class T>
void write_column(const H5Group& group, const char* name, const std::vector<T>& values,
                  hsize_t width) {
    if (values.empty()) return;
    H5Extent extent{values.size() / width};
    if (width > 1) extent.push_back(width);
    group.write<T>(name, values, extent);
}

template <class T>
std::vector<T> read_column(const H5Group& group, const char* name) {
    if (!group.has(name)) return {};
    return group.dataset(name).read<T>();
}

void write_snapshot(const H5Group& group, const Snapshot& snapshot) {
    write_column(group, "position", flat(snapshot.position), 2);
    write_column(group, "id", snapshot.id, 1);
    write_column(group, "z", snapshot.z, 1);
    write_column(group, "velocity", flat(snapshot.velocity), 3);
    write_column(group, "spin", flat(snapshot.spin), 3);
    write_column(group, "position_error", flat(snapshot.position_error), 2);
    write_column(group, "z_error", snapshot.z_error, 1);
    write_column(group, "quality", snapshot.quality, 1);
    write_column(group, "layer", flat(snapshot.layer), 1);
}

Snapshot read_snapshot(const H5Group& group) {
    Snapshot snapshot;
    snapshot.position = vec2s(read_column<double>(group, "position"), 2);
    snapshot.id = read_column<std::int64_t>(group, "id");
    snapshot.z = read_column<double>(group, "z");
    snapshot.velocity = vec3s(read_column<double>(group, "velocity"));
    snapshot.spin = vec3s(read_column<double>(group, "spin"));
    snapshot.position_error = vec2s(read_column<double>(group, "position_error"), 2);
    snapshot.z_error = read_column<double>(group, "z_error");
    snapshot.quality = read_column<double>(group, "quality");
    snapshot.layer = layers(read_column<std::int8_t>(group, "layer"));
    return snapshot;
}

json describe(const Preview& preview) {
    const Frame& frame = preview.frame;
    return {{"frame", frame.index},
            {"time", to_json(frame.time)},
            {"bit_depth", frame.bit_depth},
            {"status", static_cast<int>(frame.status)},
            {"message", frame.message},
            {"snapshot_frame", preview.snapshot.frame},
            {"snapshot_time", to_json(preview.snapshot.time)},
            {"box", to_json(preview.snapshot.box)}};
}

void apply_description(const json& text, const H5File& file, Preview& preview) {
    try {
        Frame& frame = preview.frame;
        frame.index = whole_from_json<std::int64_t>(text.at("frame"));
        frame.time = number_from_json(text.at("time"));
        frame.bit_depth = whole_from_json<int>(text.at("bit_depth"));
        const int status = whole_from_json<int>(text.at("status"));
        if (status < 0 || status > static_cast<int>(FrameStatus::missing)) {
            file.fail(fmt::format("a preview has the unknown status {}", status));
        }
        frame.status = static_cast<FrameStatus>(status);
        frame.message = text.at("message").get<std::string>();
        preview.snapshot.frame = whole_from_json<std::int64_t>(text.at("snapshot_frame"));
        preview.snapshot.time = number_from_json(text.at("snapshot_time"));
        preview.snapshot.box = box_from_json(text.at("box"), file.name());
    } catch (const json::exception& error) {
        file.fail(fmt::format("the description of a preview is damaged ({})", error.what()));
    }
}

Preview read_preview(const H5Group& group, const H5File& file) {
    Preview preview;
    preview.snapshot = read_snapshot(group);
    apply_description(parse_json(group.text("description"), file.name()), file, preview);
    require_consistent(preview.snapshot);
    if (group.has("image")) preview.frame.image = read_image(group, file);
    preview.abs_q4 = read_column<double>(group, "abs_q4");
    if (!preview.abs_q4.empty() && preview.abs_q4.size() != preview.snapshot.size()) {
        file.fail(fmt::format("a preview has {} values of |Q4| for {} particles",
                              preview.abs_q4.size(), preview.snapshot.size()));
    }
    return preview;
}

}  // namespace

void write_preview(const H5Group& parent, const std::string& name, const Preview& preview) {
    const H5Group group = parent.make_group(name);
    if (!preview.frame.image.empty()) write_image(group, preview.frame.image);
    write_snapshot(group, preview.snapshot);
    write_column(group, "abs_q4", preview.abs_q4, 1);
    group.write_text("description", text_of(describe(preview)));
}

std::vector<Preview> read_previews(const H5Group& parent) {
    std::vector<Preview> previews;
    for (std::size_t i = 0; parent.has(std::to_string(i)); ++i) {
        previews.push_back(read_preview(parent.group(std::to_string(i)), parent.file()));
    }
    return previews;
}

}  // namespace grainfield::io
