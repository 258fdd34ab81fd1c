#include "report/maps/particle_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/support/parallel.h"
#include "report/maps/png.h"
#include "report/run_labels.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

bool is_usable(const Preview& preview) {
    try {
        require_consistent(preview.snapshot);
    } catch (const InputError&) {
        return false;
    }
    const std::size_t n = preview.snapshot.size();
    return (n > 0 || !preview.frame.image.empty()) &&
           (preview.abs_q4.empty() || preview.abs_q4.size() == n);
}

// `count` of them, evenly spread, the first and the last included.
std::vector<const Preview*> spread(const std::vector<Preview>& previews, std::size_t count) {
    std::vector<const Preview*> usable;
    for (const Preview& preview : previews) {
        if (is_usable(preview)) usable.push_back(&preview);
    }
    if (usable.size() <= count) return usable;
    if (count == 1) return {usable.front()};
    std::vector<const Preview*> chosen;
    for (std::size_t i = 0; i < count; ++i) {
        chosen.push_back(usable[i * (usable.size() - 1) / (count - 1)]);
    }
    return chosen;
}

void set_extent(ParticleMap& map, const Preview& preview) {
    const Box& box = preview.snapshot.box;
    const Image& image = preview.frame.image;
    if (!image.empty()) {
        // The box of a camera's frame is the frame, or the region of it that was tracked.
        const bool is_frame =
            !map.is_field && box.length == Vec2{1.0 * image.width(), 1.0 * image.height()};
        const Vec2 corner = is_frame && is_finite(box.origin) ? box.origin : Vec2{-0.5, -0.5};
        map.x = {corner.x, corner.x + image.width()};
        map.y = {corner.y, corner.y + image.height()};
    } else if (is_finite(box.origin) && is_finite(box.length) && box.length.x > 0 &&
               box.length.y > 0) {
        map.x = {box.origin.x, box.origin.x + box.length.x};
        map.y = {box.origin.y, box.origin.y + box.length.y};
    } else {
        const auto [left, right] = std::ranges::minmax(map.position, {}, &Vec2::x);
        const auto [low, high] = std::ranges::minmax(map.position, {}, &Vec2::y);
        const double margin = 0.5 * map.diameter;
        map.x = {left.x - margin, right.x + margin};
        map.y = {low.y - margin, high.y + margin};
    }
}

// "density ρ from −2.1 to 2.3": grey runs from the least to the largest value.
std::string field_title(const Preview& preview) {
    const auto [low, high] = std::ranges::minmax(preview.frame.image.pixels());
    return fmt::format("{} from {:.3g} (black) to {:.3g} (white)",
                       preview.frame.index == 0 ? "density ρ" : "order field ψ", low, high);
}

void set_heights(ParticleMap& map, const Snapshot& snapshot) {
    const auto is_known = [](double z) { return std::isfinite(z); };
    if (std::ranges::none_of(snapshot.z, is_known)) return;
    map.z = snapshot.z;
    map.z_error = snapshot.z_error;
    if (std::isfinite(snapshot.box.height)) map.height = std::max(0.0, snapshot.box.height);
}

ParticleMap describe(const Results& run, std::size_t index, const Preview& preview) {
    ParticleMap map;
    map.run = index;
    map.frame = preview.snapshot.frame;
    map.name = fmt::format("map_run{}_frame{}", index + 1, map.frame);
    const bool is_field = map.is_field = run.identity.is_field();
    map.title = is_field ? field_title(preview)
                         : fmt::format("frame {}, {} particles", map.frame,
                                       count_text(static_cast<double>(preview.snapshot.size())));
    map.y_down = is_field || run.source.length_unit == LengthUnit::pixel;
    map.unit = is_field ? "cells" : map.y_down ? "px" : "a";
    const double diameter = run.source.diameter;
    map.diameter = std::isfinite(diameter) && diameter > 0 ? diameter : 1;
    map.position = preview.snapshot.position;
    map.id = preview.snapshot.id;
    const std::vector<Layer>& layer = preview.snapshot.layer;
    const auto is_known = [](Layer l) { return l != Layer::unknown; };
    if (std::ranges::any_of(layer, is_known)) map.layer = layer;
    set_heights(map, preview.snapshot);
    map.abs_q4 = preview.abs_q4;
    map.order = order_symbol(run);
    map.time = preview.snapshot.time;
    if (const auto& frequency = run.source.vibration_frequency; frequency && !is_field) {
        const double periods = map.time * *frequency;
        if (std::isfinite(periods)) map.phase = periods - std::floor(periods);
    }
    map.places = places_to_look_at(preview.snapshot, map.diameter);
    set_extent(map, preview);
    return map;
}

void encode(ParticleMap& map, const Image& image, std::size_t budget) {
    if (image.empty()) return;
    const int largest = std::max(1, std::min({8, image.width(), image.height()}));
    // The size falls with the number of pixels: most steps in between need not be tried.
    for (map.reduction = 1;;) {
        map.png = encode_png(image, map.reduction);
        if (map.png.size() <= budget || map.reduction >= largest) break;
        const double excess = static_cast<double>(map.png.size()) / static_cast<double>(budget);
        const int guess = static_cast<int>(0.8 * map.reduction * std::sqrt(excess));
        map.reduction = std::clamp(guess, map.reduction + 1, largest);
    }
    const int r = map.reduction;
    const int width = image.width() / r * r;
    const int height = image.height() / r * r;
    map.image_size = {static_cast<double>(width), static_cast<double>(height)};
    if (r > 1) map.title += fmt::format(" (image reduced {}×)", r);
}

// How many previews each run gives: one more in turn, while the budget lasts and it has more.
std::vector<std::size_t> shares(const std::vector<Results>& runs, std::size_t budget) {
    constexpr std::size_t most = 20;
    std::vector<std::size_t> share(runs.size(), 1);
    std::size_t given = runs.size();
    for (std::size_t round = 2; round <= most && given < budget; ++round) {
        for (std::size_t r = 0; r < runs.size() && given < budget; ++r) {
            if (runs[r].previews.size() < round) continue;
            share[r] = round;
            ++given;
        }
    }
    return share;
}

void append_uint16(std::vector<std::uint8_t>& bytes, double part, int steps = 65535) {
    const auto step = static_cast<unsigned>(std::lround(std::clamp(part, 0.0, 1.0) * steps));
    bytes.push_back(static_cast<std::uint8_t>(step & 255U));
    bytes.push_back(static_cast<std::uint8_t>(step >> 8U));
}

// Adds what map_json says of heights.
void add_heights(const ParticleMap& map, nlohmann::ordered_json& page) {
    std::array<double, 2> range{std::numeric_limits<double>::max(),
                                std::numeric_limits<double>::lowest()};
    for (const double z : map.z) {
        if (std::isfinite(z)) range = {std::min(range[0], z), std::max(range[1], z)};
    }
    const double span = range[1] > range[0] ? range[1] - range[0] : map.diameter;
    std::vector<std::uint8_t> heights;
    for (const double z : map.z) {
        if (std::isfinite(z)) {
            append_uint16(heights, (z - range[0]) / span, 65534);
        } else {
            heights.insert(heights.end(), {255, 255});
        }
    }
    std::vector<std::uint8_t> errors;
    for (const double error : map.z_error) {
        const double hundredths = std::clamp(100 * error / map.diameter, 0.0, 254.0);
        errors.push_back(std::isnan(error) ? 255
                                           : static_cast<std::uint8_t>(std::lround(hundredths)));
    }
    page["zRange"] = {range[0], range[0] + span};
    page["z"] = base64(heights);
    page["zErrors"] = base64(errors);
    page["height"] = map.height;
}

}  // namespace

std::vector<ParticleMap> make_maps(const std::vector<Results>& runs, const MapBudget& budget) {
    std::vector<ParticleMap> maps;
    std::vector<const Image*> images;
    const std::vector<std::size_t> share = shares(runs, budget.maps);
    for (std::size_t r = 0; r < runs.size(); ++r) {
        for (const Preview* preview : spread(runs[r].previews, share[r])) {
            maps.push_back(describe(runs[r], r, *preview));
            images.push_back(&preview->frame.image);
        }
    }
    const auto count = static_cast<std::int64_t>(maps.size());
    parallel_for(count, thread_count(budget.threads), [&](std::int64_t i) {
        const auto m = static_cast<std::size_t>(i);
        encode(maps[m], *images[m], budget.image_bytes / maps.size());
    });
    return maps;
}

std::string map_image(const ParticleMap& map) {
    return map.png.empty() ? "" : "data:image/png;base64," + base64(map.png);
}

std::string map_json(const ParticleMap& map, bool with_image) {
    const double margin = 0.5 * map.diameter;
    const std::array<double, 2> x{map.x[0] - margin, map.x[1] + margin};
    const std::array<double, 2> y{map.y[0] - margin, map.y[1] + margin};
    std::vector<std::uint8_t> points;
    std::vector<std::uint8_t> order;
    points.reserve(4 * map.position.size());
    for (std::size_t i = 0; i < map.position.size(); ++i) {
        append_uint16(points, (map.position[i].x - x[0]) / (x[1] - x[0]));
        append_uint16(points, (map.position[i].y - y[0]) / (y[1] - y[0]));
        if (map.abs_q4.empty()) continue;
        const double q = map.abs_q4[i];
        order.push_back(std::isfinite(q)
                            ? static_cast<std::uint8_t>(std::lround(std::clamp(q, 0.0, 1.0) * 254))
                            : std::uint8_t{255});
    }
    std::vector<std::uint8_t> ids;
    for (const std::int64_t id : map.id) {
        const auto low = static_cast<std::uint32_t>(static_cast<std::uint64_t>(id));
        for (unsigned shift = 0; shift < 32; shift += 8) {
            ids.push_back(static_cast<std::uint8_t>(low >> shift & 255U));
        }
    }
    std::vector<std::uint8_t> layers;
    for (const Layer layer : map.layer) {
        layers.push_back(layer == Layer::unknown ? 255 : static_cast<std::uint8_t>(layer));
    }
    nlohmann::json image;
    if (with_image) image = map_image(map);
    nlohmann::json places = nlohmann::json::array();
    for (const Place& place : map.places) places.push_back({place.position.x, place.position.y});
    nlohmann::json phase;
    if (map.phase) phase = *map.phase;
    nlohmann::ordered_json page{{"run", map.run},
                                {"frame", map.frame},
                                {"phase", phase},
                                {"places", places},
                                {"title", clean_text(map.title)},
                                {"x", {map.x[0], map.x[1]}},
                                {"y", {map.y[0], map.y[1]}},
                                {"yDown", map.y_down},
                                {"unit", map.unit},
                                {"is_field", map.is_field},
                                {"diameter", map.diameter},
                                {"imageSize", {map.image_size[0], map.image_size[1]}},
                                {"image", image},
                                {"pointsX", {x[0], x[1]}},
                                {"pointsY", {y[0], y[1]}},
                                {"points", base64(points)},
                                {"order", base64(order)},
                                {"orderName", clean_text(map.order)},
                                {"ids", base64(ids)},
                                {"layers", base64(layers)}};
    if (map.has_heights()) add_heights(map, page);
    return escape_json_for_script(page.dump());
}

std::string map_csv(const ParticleMap& map) {
    std::string out =
        map.has_heights() ? "frame,particle,x,y,z,abs_q4\n" : "frame,particle,x,y,abs_q4\n";
    for (std::size_t i = 0; i < map.position.size(); ++i) {
        const auto particle = map.id.empty() ? static_cast<std::int64_t>(i) : map.id[i];
        const std::string q = map.abs_q4.empty() ? "" : csv_cell(map.abs_q4[i]);
        const std::string z = map.has_heights() ? csv_cell(map.z[i]) + "," : "";
        out += fmt::format("{},{},{:.3f},{:.3f},{}{}\n", map.frame, particle, map.position[i].x,
                           map.position[i].y, z, q);
    }
    return out;
}

}  // namespace grainfield::report
