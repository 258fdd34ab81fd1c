#include "simulate/render/optics/raytrace.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/parallel.h"
#include "simulate/render/optics/lens_aperture.h"

namespace grainfield::simulate {

namespace {

constexpr float mixed = std::numeric_limits<float>::quiet_NaN();

// Of the variance of the bright field's noise: what is left in the dark (read noise, rounding and
// stray light of the default camera).
constexpr double dark_noise = 0.06;
// Where no neighbour has a value [bright field].
constexpr double usual_rim = 0.4;
constexpr int seen_around = 2;  // pixels to each side

// Of the default camera 0.22: the image then differs from the exact one by less than the noise, in
// a dark crystal as in a liquid (bench/results/render.md). The error goes as the root of the
// tolerance.
constexpr double tolerance_over_variance = 1835;
// Of the bright field of the default camera: 8500 electrons, read noise 10.
constexpr double usual_noise = (8500.0 + 10 * 10) / (8500.0 * 8500);
constexpr int reference_samples = 32;

// Through `pixel` and the point of the lens at slope `lens` (lens_points), from just above the
// spheres: single precision would not bear the true distance.
LightPath camera_ray(const View& view, Vec2 pixel, Vec2 lens, double top) {
    const double above = top - view.mid_height();
    const Vec3 in_middle = view.at_height(pixel, top);
    const Vec3 origin = in_middle + Vec3{lens.x * above, lens.y * above, 0};
    Vec3 down{-lens.x, -lens.y, -1};
    if (view.projection() == Projection::perspective) {
        const double below_pinhole = view.distance() - above;
        down = down + Vec3{(in_middle.x - view.centre().x) / below_pinhole,
                           (in_middle.y - view.centre().y) / below_pinhole, 0};
    }
    return {origin, down * (1 / norm(down))};
}

// Point k of the R2 sequence, within ± 1/2, shifted differently in every pixel: the errors of
// neighbours are then unrelated, and the blur averages them.
Vec2 sub_pixel(int k, int column, int row) {
    constexpr double a = 0.7548776662466927;
    constexpr double b = 0.5698402909980532;
    const double x = 0.5 + a * (k + 1) + 0.8191725134 * column + 0.6710436067 * row;
    const double y = 0.5 + b * (k + 1) + 0.5497004779 * column + 0.8566748838 * row;
    return {x - std::floor(x) - 0.5, y - std::floor(y) - 0.5};
}

/// The passes over the pixels of one image.
class Picture {
 public:
    Picture(const MirrorCell& cell, const View& view, const RaytraceOptions& options, Image open)
        : cell_(cell),
          view_(view),
          options_(options),
          tolerance_(sampling_tolerance(options, usual_noise)),
          lens_(lens_points(view.aperture())),
          open_(std::move(open)),
          pilot_(open_.width(), open_.height(), mixed) {}

    // One ray into each pixel that spheres cover wholly.
    void probe(int y, RowCost& cost) {
        for (int x = 0; x < view_.width(); ++x) {
            if (open_(x, y) <= 0) pilot_(x, y) = static_cast<float>(sample(x, y, 0, cost).radiance);
        }
    }

    void settle(int y, Image& image, RowCost& cost) const {
        for (int x = 0; x < view_.width(); ++x) {
            if (open_(x, y) >= 1) {
                image(x, y) = static_cast<float>(panel(x, y));
                ++cost.settled;
            } else {
                image(x, y) = sampled(x, y, cost);
            }
        }
    }

    // Every pixel alike, plain means: what adaptive sampling is compared with.
    void sample_uniformly(int y, Image& image, RowCost& cost) const {
        for (int x = 0; x < view_.width(); ++x) {
            double sum = 0;
            for (int k = 0; k < options_.most_samples; ++k) {
                sum += sample(x, y, k, cost).radiance;
            }
            ++cost.unsettled;
            cost.unsettled_samples += options_.most_samples;
            image(x, y) = static_cast<float>(sum / options_.most_samples);
        }
    }

 private:
    LightPath ray_of(int x, int y, int k) const {
        const Vec2 pixel{static_cast<double>(x), static_cast<double>(y)};
        const auto point = static_cast<std::size_t>(3 * x + 5 * y + 7 * k) % lens_.size();
        LightPath ray = camera_ray(view_, pixel + sub_pixel(k, x, y), lens_[point], cell_.top());
        ray.instant = (x + 2 * y + k) % cell_.instants();
        return ray;
    }

    MirrorCell::Seen sample(int x, int y, int k, RowCost& cost) const {
        ++cost.samples;
        return cell_.look(ray_of(x, y, k), cost.rays);
    }

    double panel(int x, int y) const {
        const LightPath ray =
            camera_ray(view_, {static_cast<double>(x), static_cast<double>(y)}, {}, cell_.top());
        return cell_.panel(ray.origin, ray.direction);
    }

    // What the rays of the pixels around it saw; few of them where the sphere ends. Four would not
    // do: they miss the thin bright lines of the mirror images.
    struct Around {
        double brightness = usual_rim;
        double deviation = usual_rim / 2;
    };

    Around around(int x, int y) const {
        int count = 0;
        double sum = 0;
        double squares = 0;
        const int end_x = std::min(x + seen_around + 1, view_.width());
        const int end_y = std::min(y + seen_around + 1, view_.height());
        for (int j = std::max(0, y - seen_around); j < end_y; ++j) {
            for (int i = std::max(0, x - seen_around); i < end_x; ++i) {
                const float value = pilot_(i, j);
                if (std::isnan(value) || (i == x && j == y)) continue;
                const auto seen = static_cast<double>(value);
                ++count;
                sum += seen;
                squares += seen * seen;
            }
        }
        if (count < 2) return {};
        const double mean = sum / count;
        return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean))};
    }

    // Its own ray has no say: if it had, the bright ones among dark neighbours would be looked at
    // again and the dark ones among bright ones not, and the image would be too dark.
    int samples_wanted(int x, int y) const {
        const auto [covered, deviation] = around(x, y);
        const auto open = std::max(0.0, static_cast<double>(open_(x, y)));
        const double brightness = open + (1 - open) * covered;
        const double tolerance =
            tolerance_ * std::sqrt((dark_noise + brightness) / (dark_noise + 1));
        const double wanted = std::ceil(2 * std::sqrt(1 - open) * deviation / tolerance);
        return static_cast<int>(
            std::clamp(wanted, 1.0, static_cast<double>(options_.most_samples)));
    }

    float sampled(int x, int y, RowCost& cost) const {
        const auto open = static_cast<double>(open_(x, y));
        const int wanted = samples_wanted(x, y);
        double sum = 0;
        int hits = 0;
        int k = 0;
        if (open <= 0) {
            sum = static_cast<double>(pilot_(x, y));
            hits = k = 1;
        }
        for (; k < wanted || (hits == 0 && k < options_.most_samples); ++k) {
            const MirrorCell::Seen seen = sample(x, y, k, cost);
            if (!seen.sphere) continue;
            sum += seen.radiance;
            ++hits;
        }
        if (k > 1) {
            ++cost.unsettled;
            cost.unsettled_samples += k;
        }
        // The exact share of what is open; a sliver of a sphere that no ray met is taken as open.
        if (hits == 0) return static_cast<float>(panel(x, y));
        const double free = open > 0 ? open * panel(x, y) : 0;
        return static_cast<float>(free + (1 - open) * sum / hits);
    }

    const MirrorCell& cell_;
    const View& view_;
    const RaytraceOptions& options_;
    double tolerance_;
    std::vector<Vec2> lens_;
    Image open_;
    Image pilot_;  // `mixed` where spheres do not cover the pixel
};

}  // namespace

double sampling_tolerance(const RaytraceOptions& options, double noise) {
    return options.tolerance.value_or(std::min(1.0, tolerance_over_variance * noise));
}

OptionTable Raytrace::describe() {
    OptionTable t(name());
    t.number("panel-distance", panel_distance, "a", {0, 1e5},
             "distance of the panel below the cell, plate included");
    t.number("panel-half-size", panel_half_size, "a", {1e-3, 1e6},
             "half of the side of the square panel");
    t.number("emission-power", emission_power, "-", {0.1, 100},
             "power of the panel's radiance, ∝ cos^(power − 1)");
    t.number("glass-thickness", glass_thickness, "a", {0, 1e4},
             "thickness of either plate; 0: none");
    t.number("reflectivity", reflectivity, "-", {0, 1},
             "of spheres met straight on; auto: of iron, by Fresnel's equations");
    t.number("ring-level", ring_level, "-", {0, 100}, "radiance of an LED ring above / panel");
    t.number("ring-angle", ring_angle, "deg", {1, 80}, "angle of the ring from the vertical");
    t.integer("bounces", bounces, "-", {1, 32}, "most mirror reflections of a ray");
    t.flag("neighbours", neighbours, "spheres mirror one another, not only the light");
    t.integer("most-samples", most_samples, "-", {1, 65536}, "most camera rays per pixel");
    t.number("tolerance", tolerance, "-", {0, 1},
             "scatter around a pixel that takes one more ray; 0: all pixels alike; auto: from the "
             "camera's noise");
    return t;
}

void Raytrace::require_valid() const {
    if (panel_distance >= glass_thickness) return;
    throw OptionError(
        {.problem = "raytrace.panel-distance: the panel lies within the glass plate",
         .actual = fmt::format("{:g} a", panel_distance),
         .expected = fmt::format("at least raytrace.glass-thickness, {:g} a", glass_thickness),
         .suggestion = "both are measured from the upper face of the low plate"});
}

std::unique_ptr<Optics> Raytrace::make(double noise, int threads) const {
    RaytraceOptions own = *this;
    own.tolerance = sampling_tolerance(*this, noise);
    return std::make_unique<RaytraceOptics>(own, threads);
}

void Raytrace::explain(double noise, RunPlan& plan) const {
    const double spread = sampling_tolerance(*this, noise);
    if (spread <= 0) {
        plan.run("uniform sampling", fmt::format("{} camera rays in every pixel", most_samples));
        return;
    }
    plan.skip(
        "uniform sampling",
        fmt::format("no ray where only the panel is seen, one where neighbours agree (twice their "
                    "standard deviation below {:.2g} of the bright field), up to {} elsewhere",
                    spread, most_samples),
        "a third to most of the rays; the summary says how many and what it changes");
}

bool Raytrace::become_reference() {
    if (tolerance && *tolerance <= 0) return false;
    tolerance = 0;
    most_samples = std::max(reference_samples, most_samples);
    return true;
}

RaytraceOptics::RaytraceOptics(const RaytraceOptions& options, int threads)
    : options_(options),
      threads_(threads),
      silhouette_({}, threads),
      device_(std::make_unique<EmbreeDevice>()) {}

RaytraceOptics::~RaytraceOptics() = default;

Image RaytraceOptics::radiance(std::span<const SphereScene> instants, const View& view) {
    const MirrorCell cell(*device_, instants, view.centre(), options_);
    const bool uniform = options_.tolerance && *options_.tolerance <= 0;
    Picture picture(cell, view, options_, uniform ? Image() : silhouette_.radiance(instants, view));
    Image image(view.width(), view.height());
    std::vector<RowCost> costs(static_cast<std::size_t>(view.height()));
    const auto each_row = [&](const auto& body) {
        parallel_for(view.height(), threads_, [&](std::int64_t y) {
            body(static_cast<int>(y), costs[static_cast<std::size_t>(y)]);
        });
    };
    if (uniform) {
        each_row([&](int y, RowCost& cost) { picture.sample_uniformly(y, image, cost); });
    } else {
        each_row([&](int y, RowCost& cost) { picture.probe(y, cost); });
        each_row([&](int y, RowCost& cost) { picture.settle(y, image, cost); });
    }
    RowCost sum;
    for (const RowCost& row : costs) {
        sum.rays += row.rays;
        sum.samples += row.samples;
        sum.settled += row.settled;
        sum.unsettled += row.unsettled;
        sum.unsettled_samples += row.unsettled_samples;
    }
    add_cost(static_cast<double>(image.size()), sum);
    return image;
}

// Uniform sampling: in every pixel as many samples as those have on average that one did not
// settle; one ray each where there is only the panel.
void RaytraceOptics::add_cost(double pixels, const RowCost& cost) {
    const auto settled = static_cast<double>(cost.settled);
    const auto rays = static_cast<double>(cost.rays);
    const auto samples = static_cast<double>(cost.samples);
    cost_.pixels += pixels;
    cost_.settled += settled;
    cost_.rays += rays;
    cost_.samples += samples;
    const double per_sample = samples > 0 ? rays / samples : 1;
    const double usual = cost.unsettled > 0 ? static_cast<double>(cost.unsettled_samples) /
                                                  static_cast<double>(cost.unsettled)
                                            : 1;
    cost_.uniform_rays += usual * (settled + (pixels - settled) * per_sample);
}

}  // namespace grainfield::simulate
