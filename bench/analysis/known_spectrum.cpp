// Layers whose S(k) = S0 + S1 (ka)^α is put in (tests/support/known_spectrum.h), analysed from
// their true positions: every number with its error beside the truth, one a line.
//   bench.analysis.known_spectrum fits ALPHA REPETITIONS [margin = 0] [diffusion = 0] [seed = 1]
//   bench.analysis.known_spectrum write OUTPUT.h5 ALPHA S0/S1 FRAMES [seed = 1] [side = 100]
// A repetition is a series of four runs of 300 frames, S0/S1 = 0.1, 0.05, 0.02 and 0 at Γ = 3.7,
// 4.2, 4.5 and 4.7, which is the critical point. Ten repetitions make a run of 3,000 frames.
// bench/analysis/known-spectrum-table makes a table of the lines.
#include "tests/support/known_spectrum.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/density/number_variance.h"
#include "analysis/spectra/fit_result.h"
#include "analysis/statistics/critical.h"
#include "io/h5/trajectory_file.h"

using namespace grainfield;
using namespace grainfield::analysis;
using grainfield::testing::KnownSpectrumLayer;
using grainfield::testing::KnownSpectrumOptions;
using grainfield::testing::SlitScene;

namespace {

constexpr double fit_end = 0.2;  // [1/a]; the law holds to 0.25
constexpr int run_frames = 300;
constexpr int long_runs = 10;  // short ones in a long one
constexpr double window = 20;  // of the slope of the number variance [a]
constexpr double critical_gamma = 4.7;

double gamma_of(double ratio) {
    return critical_gamma - 10 * ratio;
}

// S(0.25/a) − S0 is a half for every α.
double s1_of(double alpha) {
    return 0.5 * std::pow(4.0, alpha);
}

KnownSpectrumOptions layer_options(double alpha, double ratio) {
    KnownSpectrumOptions options;
    options.wanted.alpha = alpha;
    options.wanted.s1 = s1_of(alpha);
    options.wanted.s0 = ratio * options.wanted.s1;
    return options;
}

Pattern pattern_of_scene(SlitScene scene, std::int64_t frame) {
    Pattern pattern;
    pattern.frame = frame;
    pattern.time = static_cast<double>(frame);
    pattern.box = {
        {0, 0}, {scene.side, scene.side}, {Boundary::walls, Boundary::walls}, scene.height};
    pattern.position = std::move(scene.position);
    return pattern;
}

// σ² of windows of side ℓ at distance `border` from the walls, from S(k) of the cosine modes:
//   σ² = N/L⁴ ((Lℓ)² − ℓ⁴ + Σ ε_n ε_m (S(k_nm) − 1) W_n W_m),  W_n = ⟨(∫ cos k_n x dx)²⟩,
// ε = 1 for n = 0, else 2; means over the positions of the window.
double predicted_variance(const KnownSpectrumOptions& options, const Curve& high, double grains,
                          double length) {
    const double side = options.side;
    const double border = 10;
    const auto& k_high = high.find("k")->values;
    const auto& s_high = high.find("s")->values;
    const int most = static_cast<int>(k_high.back() * side / std::numbers::pi);
    std::vector<double> w;
    for (int n = 0; n <= most; ++n) {
        double sum = 0;
        int places = 0;
        for (double p = border; p <= side - border - length + 1e-9; p += 0.5) {
            const double k = std::numbers::pi * n / side;
            const double part =
                n == 0 ? length : (std::sin(k * (p + length)) - std::sin(k * p)) / k;
            sum += part * part;
            ++places;
        }
        w.push_back((n == 0 ? 1.0 : 2.0) * sum / places);
    }
    double sum = 0;
    for (int n = 0; n <= most; ++n) {
        for (int m = 0; m <= most; ++m) {
            const double k = std::numbers::pi / side * std::hypot(n, m);
            if (k == 0 || k > k_high.back()) continue;
            const auto at = static_cast<std::size_t>(
                std::lower_bound(k_high.begin(), k_high.end(), k) - k_high.begin());
            const double s = k < options.wanted.cut ? options.wanted.at(k) : s_high[at];
            sum += (s - 1) * w[static_cast<std::size_t>(n)] * w[static_cast<std::size_t>(m)];
        }
    }
    const double flat = side * side * length * length - std::pow(length, 4);
    return grains / std::pow(side, 4) * (flat + sum);
}

// d ln σ²/d ln ℓ as NumberVariance takes it: a line through the sizes within 1.3 ℓ.
double predicted_slope(const KnownSpectrumOptions& options, const Curve& high, double grains) {
    std::vector<std::pair<double, double>> points;
    for (double l = window - 4; l <= window + 6; l += 2) {
        if (l * 1.3 < window - 1e-9 || l > 1.3 * window + 1e-9) continue;
        points.emplace_back(std::log(l), std::log(predicted_variance(options, high, grains, l)));
    }
    double x = 0, y = 0, xx = 0, xy = 0;
    for (const auto& [a, b] : points) x += a, y += b;
    x /= static_cast<double>(points.size());
    y /= static_cast<double>(points.size());
    for (const auto& [a, b] : points) xx += (a - x) * (a - x), xy += (a - x) * (b - y);
    return xy / xx;
}

struct Line {
    double alpha;
    const char* modes;
    int frames;
};

void print(const Line& line, double ratio, const char* what, double truth, double value,
           double error, double low = std::nan(""), double high = std::nan("")) {
    std::printf("%g,%g,%s,%d,%s,%.6g,%.6g,%.6g,%.6g,%.6g\n", line.alpha, ratio, line.modes,
                line.frames, what, truth, value, error, low, high);
}

/// The sums of one run.
struct Sums {
    StructureFactor sk;
    NumberVariance variance;

    Sums(const Box& box, int frames)
        : sk({.k_max = 0.45}, box, frames),
          variance({.smallest = window - 4, .largest = window + 6, .increment = 2, .step = 0.5},
                   box, frames) {}
};

std::optional<CriticalPoint> point(const ObservableResult& fit, double ratio) {
    const Measurement* m = fit.find_measurement("s0_over_s1");
    if (!fit.reason.empty() || m == nullptr || !m->value || !m->error) return std::nullopt;
    return CriticalPoint{gamma_of(ratio), *m->value, *m->error};
}

void say(const Line& line, double ratio, const char* what, const char* name, double truth,
         const ObservableResult& fit) {
    const Measurement* m = fit.find_measurement(name);
    if (!fit.reason.empty() || m == nullptr || !m->value) {
        print(line, ratio, what, truth, std::nan(""), std::nan(""));
        return;
    }
    print(line, ratio, what, truth, *m->value, m->error.value_or(std::nan("")));
}

class Series {
 public:
    Series(double alpha, double margin, double diffusion, std::uint64_t seed) : alpha_(alpha) {
        for (const double ratio : {0.1, 0.05, 0.02, 0.0}) {
            KnownSpectrumOptions options = layer_options(alpha, ratio);
            options.margin = margin;
            options.diffusion = diffusion;
            options.tolerance = 1e-4;
            options.seed = seed + static_cast<std::uint64_t>(1e6 * ratio + 1e8 * alpha);
            ratios_.push_back(ratio);
            layers_.emplace_back(options);
            options_.push_back(options);
            long_.emplace_back(box_, long_runs * run_frames);
        }
        predict();
    }

    void run(int repetition) {
        std::vector<Sums> sums;
        for (std::size_t r = 0; r < ratios_.size(); ++r) {
            sums.emplace_back(box_, run_frames);
            for (int f = 0; f < run_frames; ++f) {
                const int in_long = repetition % long_runs * run_frames + f;
                const Pattern p = pattern_of_scene(layers_[r].next(), f);
                auto modes = sums[r].sk.measure(p);
                auto counts = sums[r].variance.measure(p);
                long_[r].sk.add(modes);
                auto later = counts;
                later.frame = in_long;
                long_[r].variance.add(std::move(later));
                sums[r].sk.add(std::move(modes));
                sums[r].variance.add(std::move(counts));
            }
        }
        report(sums, run_frames);
        if (repetition % long_runs == long_runs - 1) {
            report(long_, long_runs * run_frames);
            for (Sums& s : long_) s = Sums(box_, long_runs * run_frames);
        }
        std::fflush(stdout);
    }

 private:
    // The slope of the number variance needs S beyond the waves that are set: measured, and the
    // same for every frame.
    void predict() {
        for (std::size_t r = 0; r < ratios_.size(); ++r) {
            const int frames = 24;
            StructureFactor sk({.k_max = 6}, box_, frames);
            for (int f = 0; f < frames; ++f) {
                sk.add(sk.measure(pattern_of_scene(layers_[r].next(), f)));
            }
            const ObservableResult result = sk.result();
            slopes_.push_back(predicted_slope(options_[r], *result.find_curve("sk_neumann"),
                                              static_cast<double>(layers_[r].grains())));
        }
    }

    void report(const std::vector<Sums>& sums, int frames) const {
        for (const FitModes modes : {FitModes::box, FitModes::plane_waves}) {
            const Line line{alpha_, modes == FitModes::box ? "box" : "plane", frames};
            std::vector<CriticalPoint> points;
            std::vector<CriticalPoint> of_paper;
            for (std::size_t r = 0; r < ratios_.size(); ++r) {
                const double ratio = ratios_[r];
                FitOptions options{.alpha = alpha_, .k_max = fit_end, .modes = modes};
                options.bootstrap = 100;
                const ObservableResult given = fit_result(sums[r].sk, options);
                say(line, ratio, "ratio", "s0_over_s1", ratio, given);
                say(line, ratio, "s0", "s0", options_[r].wanted.s0, given);
                if (const auto p = point(given, ratio)) points.push_back(*p);
                options.alpha = 1.12;
                const ObservableResult paper = fit_result(sums[r].sk, options);
                say(line, ratio, "ratio at 1.12", "s0_over_s1", ratio, paper);
                if (const auto p = point(paper, ratio)) of_paper.push_back(*p);
                options.exponent = Exponent::free;
                say(line, ratio, "alpha", "alpha", alpha_, fit_result(sums[r].sk, options));
                if (modes == FitModes::box) say_slope(line, r, sums[r].variance.result());
            }
            say_critical(line, "critical", points);
            say_critical(line, "critical at 1.12", of_paper);
        }
    }

    void say_slope(const Line& line, std::size_t r, const ObservableResult& variance) const {
        const Curve* curve = variance.find_curve("variance_slope");
        for (std::size_t i = 0; i < curve->columns.front().values.size(); ++i) {
            if (std::abs(curve->columns[0].values[i] - window) > 0.1) continue;
            print(line, ratios_[r], "beta", slopes_[r], curve->columns[1].values[i],
                  curve->columns[2].values[i]);
        }
    }

    static void say_critical(const Line& line, const char* what,
                             const std::vector<CriticalPoint>& points) {
        const CriticalFit fit = fit_critical(points, CriticalLine::free);
        const double none = std::nan("");
        print(line, none, what, critical_gamma, fit.critical.value_or(none), none,
              fit.interval ? fit.interval->low : none, fit.interval ? fit.interval->high : none);
    }

    double alpha_;
    Box box_{{0, 0}, {100, 100}, {Boundary::walls, Boundary::walls}, 1.94};
    std::vector<double> ratios_;
    std::vector<KnownSpectrumOptions> options_;
    std::vector<KnownSpectrumLayer> layers_;
    std::vector<Sums> long_;
    std::vector<double> slopes_;
};

void write(const char* path, double alpha, double ratio, int frames, std::uint64_t seed,
           double side) {
    KnownSpectrumOptions options = layer_options(alpha, ratio);
    options.side = side;
    options.seed = seed;
    KnownSpectrumLayer layer(options);
    TrajectoryInfo info;
    info.origin = Origin::md;
    info.diameter_origin = DiameterOrigin::simulated;
    info.source = "known spectrum";
    io::TrajectoryWriter writer(path, info, Overwrite::force);
    for (int f = 0; f < frames; ++f) {
        const SlitScene scene = layer.next();
        Snapshot s;
        s.frame = f;
        s.time = f;
        s.box = {{0, 0}, {side, side}, {Boundary::walls, Boundary::walls}, scene.height};
        s.position = scene.position;
        for (const double z : scene.z) s.z.push_back(z + 0.5);
        writer.write(s);
    }
    writer.finish({});
}

}  // namespace

int main(int argc, char** argv) {
    const std::string_view word = argc > 1 ? argv[1] : "";
    const auto number = [&](int at, double otherwise) {
        return argc > at ? std::atof(argv[at]) : otherwise;
    };
    if (word == "fits" && argc > 3) {
        Series series(number(2, 1), number(4, 0), number(5, 0),
                      static_cast<std::uint64_t>(number(6, 1)));
        std::puts("alpha,s0_over_s1,modes,frames,what,truth,value,error,low,high");
        for (int r = 0; r < static_cast<int>(number(3, 1)); ++r) series.run(r);
        return 0;
    }
    if (word == "write" && argc > 5) {
        write(argv[2], number(3, 1), number(4, 0), static_cast<int>(number(5, 1)),
              static_cast<std::uint64_t>(number(6, 1)), number(7, 100));
        return 0;
    }
    std::fputs(
        "usage: bench.analysis.known_spectrum fits ALPHA REPETITIONS [margin] [diffusion] [seed]\n"
        "       bench.analysis.known_spectrum write OUTPUT.h5 ALPHA S0/S1 FRAMES [seed] [side]\n",
        stderr);
    return 2;
}
