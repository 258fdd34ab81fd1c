#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <unistd.h>

#include "core/results.h"
#include "core/support/random.h"

/// Results as an analysis would make them, for looking at reports: a square crystal patch
/// (spacing 8.2 px) in disordered surroundings, about 10,000 particles in a frame of 1012 x 1012,
/// and curves of realistic shape. Seeded.
namespace grainfield::report::sample {

struct Scene {
    std::uint64_t seed = 1;
    int size = 1012;             ///< of the frame [px]
    double patch = 260;          ///< radius of the crystal [px]
    bool several_frames = true;  ///< false: one frame, no MSD
    std::string label = "Γ = 4.50";
};

namespace detail {

inline bool in_patch(Vec2 p, const Scene& s) {
    return norm(p - Vec2{0.42 * s.size, 0.55 * s.size}) < s.patch;
}

inline std::vector<Vec2> crystal(const Scene& s, RandomStream& random) {
    const Vec2 e1 = 8.2 * Vec2{std::cos(0.3), std::sin(0.3)};
    const Vec2 e2{-e1.y, e1.x};
    std::vector<Vec2> points;
    const int n = s.size / 8;
    for (int i = -n; i <= n; ++i) {
        for (int j = -n; j <= n; ++j) {
            const Vec2 jitter{0.3 * random.normal(), 0.3 * random.normal()};
            const Vec2 p =
                Vec2{0.42 * s.size, 0.55 * s.size} + 1.0 * i * e1 + 1.0 * j * e2 + jitter;
            const bool inside = p.x > 0 && p.y > 0 && p.x < s.size - 1 && p.y < s.size - 1;
            if (inside && in_patch(p, s)) points.push_back(p);
        }
    }
    return points;
}

/// Random sequential addition with 6 px between centres, to one particle per 108 px^2.
inline void add_liquid(std::vector<Vec2>& points, const Scene& s, RandomStream& random) {
    constexpr double apart = 6;
    const int cells = static_cast<int>(s.size / apart) + 1;
    std::vector<std::vector<Vec2>> grid(static_cast<std::size_t>(cells * cells));
    const auto cell = [&](Vec2 p, int dx, int dy) -> std::vector<Vec2>* {
        const int x = static_cast<int>(p.x / apart) + dx;
        const int y = static_cast<int>(p.y / apart) + dy;
        if (x < 0 || y < 0 || x >= cells || y >= cells) return nullptr;
        return &grid[static_cast<std::size_t>(y * cells + x)];
    };
    for (Vec2 p : points) cell(p, 0, 0)->push_back(p);
    const auto trials = static_cast<int>(2.4 * s.size * s.size / 108);
    for (int i = 0; i < trials; ++i) {
        const Vec2 p{random.uniform(0, s.size - 1.0), random.uniform(0, s.size - 1.0)};
        if (in_patch(p, s)) continue;
        bool is_free = true;
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                const auto* near = cell(p, dx, dy);
                if (near == nullptr) continue;
                is_free = is_free && std::ranges::none_of(*near, [&](Vec2 q) {
                              return squared_norm(p - q) < apart * apart;
                          });
            }
        }
        if (!is_free) continue;
        cell(p, 0, 0)->push_back(p);
        points.push_back(p);
    }
}

inline Image draw(const std::vector<Vec2>& points, const Scene& s, RandomStream& random) {
    Image image(s.size, s.size, 1);
    for (Vec2 p : points) {
        const int x0 = static_cast<int>(p.x);
        const int y0 = static_cast<int>(p.y);
        for (int y = std::max(0, y0 - 7); y <= std::min(s.size - 1, y0 + 7); ++y) {
            for (int x = std::max(0, x0 - 7); x <= std::min(s.size - 1, x0 + 7); ++x) {
                const double r = std::hypot(x - p.x, y - p.y);
                image(x, y) *= static_cast<float>(0.5 + 0.5 * std::tanh((r - 4.45) / 1.25));
            }
        }
    }
    for (float& value : image.pixels()) {
        value = std::clamp(std::round(22 + 230 * value + static_cast<float>(3 * random.normal())),
                           0.0F, 255.0F);
    }
    return image;
}

inline Preview preview(const Scene& s, std::int64_t frame) {
    RandomStream random(s.seed, "sample preview", static_cast<std::uint64_t>(frame));
    Preview preview;
    std::vector<Vec2> points = crystal(s, random);
    add_liquid(points, s, random);
    for (Vec2 p : points) {
        const double q = in_patch(p, s)
                             ? 1 - 0.04 * std::abs(random.normal()) - 0.02
                             : std::hypot(0.22 * random.normal(), 0.22 * random.normal());
        preview.abs_q4.push_back(std::clamp(q, 0.0, 1.0));
    }
    preview.abs_q4.front() = std::nan("");
    preview.frame.image = draw(points, s, random);
    preview.frame.index = preview.snapshot.frame = frame;
    preview.snapshot.box = {{-0.5, -0.5}, {1.0 * s.size, 1.0 * s.size}, {}, 0};
    preview.snapshot.position = std::move(points);
    return preview;
}

inline ObservableResult order(const Preview& preview) {
    ObservableResult result;
    result.name = "q4";
    Column q{"q4", "-", "|Q4|", {}};
    Column density{"density", "-", "Probability density", std::vector<double>(50, 0)};
    Column count{"count", "-", "Particles", std::vector<double>(50, 0)};
    for (int b = 0; b < 50; ++b) q.values.push_back((b + 0.5) / 50);
    double sum = 0;
    double n = 0;
    for (double value : preview.abs_q4) {
        if (!std::isfinite(value)) continue;
        count.values[std::min<std::size_t>(49, static_cast<std::size_t>(value * 50))] += 1;
        sum += value;
        n += 1;
    }
    for (std::size_t b = 0; b < 50; ++b) density.values[b] = 50 * count.values[b] / n;
    result.curves = {{"q4_histogram", "Distribution of |Q4|", {q, density, count}, {}}};
    result.measurements = {
        {"q4_mean", "-", sum / n, 0.0029, n, "one frame: error takes particles as independent"},
        {"q4_minimum", "-", 0.74, 0.02, n, ""},
        {"lattice_spacing", "a", 0.8123, 0.0011, n / 3,
         "one frame: error takes particles as independent"}};
    return result;
}

inline Curve spectrum(const std::string& name, double floor, const Scene& s, bool errors) {
    RandomStream random(s.seed, name);
    Column k{"k", "1/a", "Wavevector k a", {}};
    Column value{"s", "-", "S(k)", {}};
    Column error{"s_err", "-", "Standard error", {}};
    Column n{"n", "-", "Modes", {}};
    for (int i = 1; i <= 160; ++i) {
        const double q = 0.0314 * i;
        const double modes = 2 + 1.5 * i;
        const double peak = 2.4 * std::exp(-std::pow((q - 4.3) / 0.55, 2));
        const double s_true = floor + 0.09 * std::pow(q, 1.12) + peak;
        const double relative = 0.6 / std::sqrt(modes);
        k.values.push_back(q);
        value.values.push_back(s_true * std::max(0.2, 1 + relative * random.normal()));
        error.values.push_back(errors ? s_true * relative : std::nan(""));
        n.values.push_back(modes);
    }
    return {name,
            name == "sk" ? "Structure factor, connected" : "Structure factor, raw",
            {k, value, error, n},
            {}};
}

inline ObservableResult structure_factor(const Scene& s) {
    ObservableResult result;
    result.name = "sk";
    const double floor = 0.01 + 0.004 * static_cast<double>(s.seed % 7);
    result.curves = {spectrum("sk", floor, s, true), spectrum("sk_raw", 4 * floor, s, true),
                     spectrum("sk_neumann", 1.1 * floor, s, true)};
    result.measurements = {
        {"s_lowest_k", "-", floor, 0.2 * floor, 40, ""},
        {"lowest_k", "1/a", 0.0314, std::nullopt, 0, "fixed by the box, not measured"}};
    return result;
}

inline ObservableResult variance(const Scene& s) {
    ObservableResult result;
    result.name = "variance";
    RandomStream random(s.seed, "sample variance");
    Column l{"l", "a", "Window side", {}};
    Column value{"variance", "-", "Number variance", {}};
    Column error{"err", "-", "Standard error", {}};
    Column mean{"mean", "-", "Mean number", {}};
    const double ratio = 0.02 * static_cast<double>(1 + s.seed % 5);
    for (int i = 0; i < 28; ++i) {
        const double side = std::pow(80.0, i / 27.0);
        const double n = 1.17 * side * side;
        const double sigma2 = n * (ratio + 0.9 / (1 + 0.12 * side));
        const double relative = 0.01 * std::sqrt(side);
        l.values.push_back(side);
        value.values.push_back(sigma2 * (1 + relative * random.normal()));
        error.values.push_back(sigma2 * relative);
        mean.values.push_back(n);
    }
    result.curves = {{"variance", "Number variance, temporal", {l, value, error, mean}, {}}};
    result.measurements = {{"number_density", "1/a^2", 1.1704, 0.0012, 40, ""}};
    return result;
}

inline ObservableResult displacement(const Scene& s) {
    ObservableResult result;
    result.name = "msd";
    if (!s.several_frames) {
        result.reason = "one frame: displacements need two";
        return result;
    }
    Curve curve{"msd",
                "Mean squared displacement",
                {{"t", "time unit", "Lag time", {}},
                 {"msd", "a^2", "MSD", {}},
                 {"err", "a^2", "Standard error", {}},
                 {"n", "-", "Pairs", {}}},
                {}};
    for (const std::string phase : {"all", "liquid", "solid"}) {
        for (int i = 0; i < 20; ++i) {
            const double t = 0.002 * std::pow(3000.0, i / 19.0);
            const double liquid = 0.05 * t + 0.0004;
            const double solid = 0.003 * std::pow(t, 0.45);
            const double value = phase == "liquid"  ? liquid
                                 : phase == "solid" ? solid
                                                    : 0.6 * liquid + 0.4 * solid;
            curve.columns[0].values.push_back(t);
            curve.columns[1].values.push_back(value);
            curve.columns[2].values.push_back(value * 0.01 * (1 + 0.5 * i));
            curve.columns[3].values.push_back(1e6 / (1 + i));
            curve.text_columns["phase"].push_back(phase);
        }
    }
    result.curves = {curve};
    result.measurements = {{"d_liquid", "a^2/time unit", 0.01253, 0.00021, 1e6, ""},
                           {"exponent_solid", "-", 0.452, 0.013, 4e5, ""}};
    return result;
}

inline ObservableResult phase(const Scene& s) {
    ObservableResult result;
    result.name = "phase";
    RandomStream random(s.seed, "sample phase");
    Curve curve{"phase",
                "Solid and liquid fraction",
                {{"frame", "-", "Frame", {}},
                 {"t", "time unit", "Time", {}},
                 {"solid_fraction", "-", "Solid", {}},
                 {"liquid_fraction", "-", "Liquid", {}}},
                {}};
    for (int i = 0; i < (s.several_frames ? 60 : 1); ++i) {
        const double solid = 0.27 + 0.02 * std::sin(0.2 * i) + 0.004 * random.normal();
        curve.columns[0].values.push_back(200.0 * i);
        curve.columns[1].values.push_back(0.4 * i);
        curve.columns[2].values.push_back(solid);
        curve.columns[3].values.push_back(0.9 - solid);
    }
    result.curves = {curve};
    result.measurements = {{"solid_fraction", "-", 0.2713, 0.0031, 60, ""},
                           {"averaging_time", "time unit", std::nullopt, std::nullopt, 0,
                            "one frame: classified by |Q4| of this frame alone"}};
    return result;
}

}  // namespace detail

inline Results results(const Scene& scene = {}) {
    Results results;
    results.label = scene.label;
    results.source = {.origin = Origin::video,
                      .length_unit = LengthUnit::pixel,
                      .time_unit = TimeUnit::second,
                      .diameter = 10.09,
                      .diameter_origin = DiameterOrigin::given,
                      .vibration_frequency = 80,
                      .frame_rate = 500,
                      .source = "layer.avi"};
    results.identity = identity_of(results.source);
    results.box = {{-0.5, -0.5}, {1.0 * scene.size, 1.0 * scene.size}, {}, 0};
    results.frames = scene.several_frames ? 12000 : 1;
    results.previews = {detail::preview(scene, 0)};
    results.particles_mean = static_cast<double>(results.previews[0].snapshot.size());
    results.observables = {detail::order(results.previews[0]), detail::phase(scene),
                           detail::displacement(scene), detail::structure_factor(scene),
                           detail::variance(scene)};
    results.record.command = "analyze";
    results.record.version = "0.1.0";
    results.record.seconds = 12.4;
    results.record.configuration = {{"q4.rule", "near-four"}, {"sk.k-max", "5"}, {"seed", "0"}};
    results.record.inputs = {{"layer_4.50.h5", 123456789, "crc32:9ae0daaf"}};
    results.record.skipped = {"background fit: illumination uniform to 0.3 %"};
    if (!scene.several_frames) {
        results.record.warnings = {
            {.text = "one frame only: errors take particles as independent"}};
    }
    return results;
}

/// A fresh folder of its own for each test, removed at the end.
class TemporaryFolder {
 public:
    explicit TemporaryFolder(const std::string& name)
        : path_(std::filesystem::temp_directory_path() /
                ("grainfield_" + name + "_" + std::to_string(::getpid()))) {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

 private:
    std::filesystem::path path_;
};

}  // namespace grainfield::report::sample
