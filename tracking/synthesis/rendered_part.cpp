#include "tracking/synthesis/rendered_part.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/support/random.h"
#include "tracking/synthesis/mirror_image.h"
#include "tracking/synthesis/mirror_scene.h"
#include "tracking/synthesis/synthesis_fit.h"

namespace grainfield::tracking {
namespace {

constexpr double kAround = 3;  // [a] spheres beyond the part that are mirrored in it
constexpr int kRounds =
    2;  // of Gauss–Newton; more, with the optics again, move errors by 3 % at most
constexpr double kBlurOfEdge = 0.7;  // [w] as in synthesise()
constexpr double kLarge = 1.5;       // [side] from here on a frame is sampled
constexpr int kAcross = 3;           // parts

FramePart part_about(const Image& counts, const ImageModel& model, Vec2 middle, int width,
                     int height) {
    const float brightest = *std::max_element(counts.pixels().begin(), counts.pixels().end());
    FramePart part{.x0 = static_cast<int>(middle.x - 0.5 * width),
                   .y0 = static_cast<int>(middle.y - 0.5 * height),
                   .brightness = Image(width, height),
                   .ceiling = Image(width, height)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto darkness = model.darkness_of(part.x0 + x, part.y0 + y);
            part.brightness(x, y) = 1 - darkness(counts(part.x0 + x, part.y0 + y));
            part.ceiling(x, y) = 1 - darkness(brightest - 0.5F);
        }
    }
    return part;
}

}  // namespace

double FramePart::inside(Vec2 place) const {
    return std::min({place.x - x0, place.y - y0, x0 + brightness.width() - 1 - place.x,
                     y0 + brightness.height() - 1 - place.y});
}

std::vector<FramePart> parts_of(const Image& counts, const ImageModel& model, double side) {
    const double width = counts.width();
    const double height = counts.height();
    if (std::min(width, height) < kLarge * side) {
        return {part_about(counts, model, {0.5 * width, 0.5 * height},
                           static_cast<int>(std::min(width, side)),
                           static_cast<int>(std::min(height, side)))};
    }
    std::vector<FramePart> parts;
    const int half = static_cast<int>(0.5 * side);
    for (int row = 0; row < kAcross; ++row) {
        for (int column = 0; column < kAcross; ++column) {
            const Vec2 middle{(column + 0.5) * width / kAcross, (row + 0.5) * height / kAcross};
            parts.push_back(part_about(counts, model, middle, half, half));
        }
    }
    return parts;
}

RenderedPart fitted_part(const FramePart& part, const ImageModel& model,
                         const std::vector<Vec2>& discs, const RenderSetting& setting,
                         int threads) {
    const double a = setting.diameter;
    std::vector<Point3> spheres;
    const auto middle = static_cast<float>(0.5 * (setting.height - 1));
    for (const Vec2 p : discs) {
        if (part.inside(p) < -kAround * a) continue;
        spheres.push_back({static_cast<float>((p.x - part.x0) / a),
                           static_cast<float>((p.y - part.y0) / a), middle});
    }
    if (spheres.empty()) return {};
    MirrorOptics optics;
    optics.blur = kBlurOfEdge * model.disc.edge_width / a;
    optics.distance = setting.camera_distance;
    optics.middle_x = (0.5 * (setting.frame_width - 1) - part.x0) / a;
    optics.middle_y = (0.5 * (setting.frame_height - 1) - part.y0) / a;
    SynthesisLimits limits{.height = setting.height};
    SynthesisFit rough(part.brightness, part.ceiling, a, threads, kHeightRays);
    rough.start(std::move(spheres), optics);
    rough.find_heights(limits);
    SynthesisFit fit(part.brightness, part.ceiling, a, threads);
    fit.start(rough.spheres(), optics);
    fit.fit_optics();
    limits.most_rounds = kRounds;
    fit.refine(limits);
    fit.fit_optics();
    return {fit.spheres(), fit.optics(), fit.light(), fit.rms()};
}

Image frame_of(const std::vector<Point3>& spheres, const RenderedPart& rendered,
               const FramePart& part, double diameter, double noise, std::uint64_t seed,
               std::uint64_t stream) {
    const int width = part.brightness.width();
    const int height = part.brightness.height();
    MirrorImage image(width, height, diameter, 1);
    image.render_only(MirrorScene(spheres, rendered.optics));
    RandomStream random(seed, "camera", stream);
    Image darkness(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double light = rendered.light(static_cast<double>(image.image()(x, y)),
                                                from_middle(part.brightness, x, y));
            const double seen =
                std::min(light + noise * random.normal(), static_cast<double>(part.ceiling(x, y)));
            darkness(x, y) = std::clamp(static_cast<float>(1 - seen), -0.5F, 1.5F);
        }
    }
    return darkness;
}

double rms_at(const std::vector<Vec2>& places, const RenderedPart& rendered, const FramePart& part,
              double diameter, int threads) {
    std::vector<Point3> spheres = rendered.spheres;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        spheres[i].x = static_cast<float>((places[i].x - part.x0) / diameter);
        spheres[i].y = static_cast<float>((places[i].y - part.y0) / diameter);
    }
    SynthesisFit fit(part.brightness, part.ceiling, diameter, threads);
    fit.start(std::move(spheres), rendered.optics, std::vector<char>(rendered.spheres.size(), 0),
              rendered.light);
    return fit.rms();
}

}  // namespace grainfield::tracking
