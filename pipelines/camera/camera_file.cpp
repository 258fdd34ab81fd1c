#include "pipelines/camera/camera_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "pipelines/detail/toml_values.h"

namespace grainfield::pipelines {

namespace {

using tracking::Camera;
using tracking::PlaneUnit;

constexpr const char* kFormat = "grainfield camera 1";
constexpr int kLargestFrame = 1 << 24;
constexpr double kLargest = 1e12;

constexpr std::string_view kChecksum = "checksum = ";

/// Of the text without carriage returns, which some systems add.
std::string checksum_of(std::string_view text) {
    std::string plain;
    std::ranges::copy_if(text, std::back_inserter(plain), [](char c) { return c != '\r'; });
    const uLong sum = crc32(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(plain.data()),
                            static_cast<uInt>(plain.size()));
    return fmt::format("crc32:{:08x}", sum);
}

std::string content_of(const std::filesystem::path& path) {
    std::ifstream in;
    if (std::filesystem::is_regular_file(path)) in.open(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string pair_of(Vec2 p) {
    return list_of(std::vector{p.x, p.y});
}

Vec2 pair_in(TomlValues& values, const std::string& key) {
    const std::vector<double> pair = values.list(key);
    if (pair.size() != 2) values.refuse_value(key, "two numbers");
    return {pair[0], pair[1]};
}

}  // namespace

std::string text_of(const Camera& camera, const std::string& before) {
    const tracking::Lens& lens = camera.lens;
    std::string text = fmt::format("[{}frame]  # px\nwidth = {}\nheight = {}\n\n", before,
                                   camera.width, camera.height);
    text += fmt::format(
        "[{}lens]  # focal length and centre in px; distortion as OpenCV has it\nfocal = {}\n"
        "centre = {}\nk1 = {}\nk2 = {}\np1 = {}\np2 = {}\n\n",
        before, text_of_number(lens.focal), pair_of(lens.centre), text_of_number(lens.k1),
        text_of_number(lens.k2), text_of_number(lens.p1), text_of_number(lens.p2));
    text += fmt::format(
        "[{}tilt]  # undistorted px to corrected px in the plane of the cell, row by row\n"
        "homography = {}\n",
        before, list_of(std::vector(camera.homography.begin(), camera.homography.end())));
    if (camera.scale) {
        text += fmt::format("\n[{}scale]  # of one corrected px\nlength = {}\nunit = \"{}\"\n",
                            before, text_of_number(camera.scale->length),
                            camera.scale->unit == PlaneUnit::mm ? "mm" : "a");
    }
    if (camera.cell) {
        text += fmt::format("\n[{}cell]  # walls in corrected px\ncorner = {}\nsides = {}\n",
                            before, pair_of(camera.cell->origin), pair_of(camera.cell->length));
    }
    text += fmt::format("\n[{}check]  # px, per axis\nresidual = {}\n", before,
                        text_of_number(camera.residual_rms));
    return text;
}

std::string camera_file_text(const Camera& camera) {
    std::string text = fmt::format(
        "# Lens and tilt of a camera, of 'grainfield calibrate-camera'; use with --camera.\n"
        "# A file that was changed or cut is refused.\n"
        "format = \"{}\"\n\n{}",
        kFormat, text_of(camera, ""));
    text += fmt::format("{}\"{}\"\n", kChecksum, checksum_of(text));
    return text;
}

Camera camera_in(TomlValues& values, const std::string& before) {
    Camera camera;
    camera.width = values.whole(before + "frame.width", 1, kLargestFrame);
    camera.height = values.whole(before + "frame.height", 1, kLargestFrame);
    tracking::Lens& lens = camera.lens;
    lens.focal = values.number(before + "lens.focal", 1e-6, kLargest);
    lens.centre = pair_in(values, before + "lens.centre");
    lens.k1 = values.number(before + "lens.k1", -kLargest, kLargest);
    lens.k2 = values.number(before + "lens.k2", -kLargest, kLargest);
    lens.p1 = values.number(before + "lens.p1", -kLargest, kLargest);
    lens.p2 = values.number(before + "lens.p2", -kLargest, kLargest);
    const std::string homography = before + "tilt.homography";
    const std::vector<double> elements = values.list(homography);
    if (elements.size() != camera.homography.size()) values.refuse_value(homography, "9 numbers");
    std::ranges::copy(elements, camera.homography.begin());
    if (values.has(before + "scale")) {
        camera.scale.emplace();
        camera.scale->length = values.number(before + "scale.length", 1e-12, kLargest);
        camera.scale->unit = values.choice<PlaneUnit>(
            before + "scale.unit", {{"mm", PlaneUnit::mm}, {"a", PlaneUnit::diameter}});
    }
    if (values.has(before + "cell")) {
        camera.cell.emplace();
        camera.cell->origin = pair_in(values, before + "cell.corner");
        camera.cell->length = pair_in(values, before + "cell.sides");
        if (!(camera.cell->length.x > 0 && camera.cell->length.y > 0)) {
            values.refuse_value(before + "cell.sides", "two lengths above zero");
        }
    }
    camera.residual_rms = values.number(before + "check.residual", 0, kLargest);
    if (const std::string fault = tracking::fault_of(camera); !fault.empty()) {
        values.refuse("positions cannot be corrected with this camera", fault,
                      "a map that is one to one over the whole frame");
    }
    return camera;
}

Camera read_camera(const std::filesystem::path& path) {
    TomlValues values(path, "camera file", "a file of 'grainfield calibrate-camera'",
                      "calibrate the camera again");
    values.choice<int>("format", {{kFormat, 1}});
    Camera camera = camera_in(values, "");
    const std::string text = content_of(path);
    const std::string sum = checksum_of(std::string_view(text).substr(0, text.rfind(kChecksum)));
    const std::string written = values.text("check.checksum");
    values.require_no_others();
    if (written != sum) {
        values.refuse("it was changed or cut after it was made", "its content gives " + sum,
                      written);
    }
    return camera;
}

bool is_camera_file(const std::filesystem::path& path) {
    return content_of(path).find("grainfield camera") != std::string::npos;
}

}  // namespace grainfield::pipelines
