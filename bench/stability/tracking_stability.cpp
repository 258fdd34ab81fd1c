// Errors of positions far from where the fit starts, in a crystal whose holes close, and in noise
// as strong as the contrast, beside simpler methods. Prints plot,series,x,y.
//   bench.stability.tracking [start] [spacing] [noise]
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "bench/stability/rows.h"
#include "core/support/random.h"
#include "tests/support/layer_frames.h"
#include "tests/support/position_score.h"
#include "tracking/locate.h"
#include "tracking/model/known_models.h"
#include "tracking/refine/disc_sweeps.h"
#include "tracking/refine/joint_fit.h"
#include "tracking/score/position_bounds.h"
#include "tracking/tracking.h"

using namespace grainfield;
using namespace grainfield::tracking;
using grainfield::bench::print_row;

namespace {

constexpr double kDiameter = 16;  // [px]
constexpr double kEdge = 1.2;     // [px]
const DiscProfile kDisc{kDiameter, kEdge, &kTanhEdge};

/// Darkness in units of the contrast, with white noise.
Image darkness_of(const std::vector<Vec2>& discs, int side, double noise) {
    Image light(side, side, 1);
    const double reach = kDisc.reach();
    for (const Vec2 p : discs) {
        const auto from = [&](double c) { return std::max(0, static_cast<int>(c - reach)); };
        const auto to = [&](double c) { return std::min(side - 1, static_cast<int>(c + reach)); };
        for (int y = from(p.y); y <= to(p.y); ++y) {
            for (int x = from(p.x); x <= to(p.x); ++x) {
                const double r = std::hypot(x - p.x, y - p.y);
                light(x, y) *= static_cast<float>(1 - kDisc.darkness(r));
            }
        }
    }
    RandomStream random(1, "stability image");
    Image darkness(side, side);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            darkness(x, y) = 1 - light(x, y) + static_cast<float>(noise * random.normal());
        }
    }
    return darkness;
}

/// RMS over the true positions inside the frame of the distance to the nearest one found, per axis.
double rms_to_nearest(const std::vector<Vec2>& found, const std::vector<Vec2>& truth, int side,
                      double margin) {
    double sum = 0;
    int count = 0;
    for (const Vec2 p : truth) {
        if (std::min({p.x, p.y, side - 1 - p.x, side - 1 - p.y}) < margin) continue;
        double nearest = 4 * kDiameter * kDiameter;
        for (const Vec2 q : found) nearest = std::min(nearest, squared_norm(p - q));
        sum += nearest;
        ++count;
    }
    return std::sqrt(sum / count / 2);
}

/// The centroid of the darkness within D/2, again from where it lies, until it rests.
std::vector<Vec2> centroids(const Image& darkness, const std::vector<Vec2>& start) {
    std::vector<Vec2> found = start;
    const double reach = kDiameter / 2;
    for (Vec2& p : found) {
        for (int i = 0; i < 20; ++i) {
            double sum = 0;
            Vec2 moment;
            for (int y = static_cast<int>(p.y - reach); y <= static_cast<int>(p.y + reach); ++y) {
                for (int x = static_cast<int>(p.x - reach); x <= static_cast<int>(p.x + reach);
                     ++x) {
                    if (x < 0 || y < 0 || x >= darkness.width() || y >= darkness.height()) continue;
                    const Vec2 at{static_cast<double>(x), static_cast<double>(y)};
                    if (squared_norm(at - p) > reach * reach) continue;
                    const double weight = std::max(0.0, static_cast<double>(darkness(x, y)));
                    sum += weight;
                    moment += weight * at;
                }
            }
            if (!(sum > 0)) break;
            const Vec2 next{moment.x / sum, moment.y / sum};
            const bool rests = squared_norm(next - p) < 1e-6;
            p = next;
            if (rests) break;
        }
    }
    return found;
}

struct DiscSlope {
    double darkness = 0;
    Vec2 slope;  ///< ∂P/∂(x, y) of the centre [1/px]
};

DiscSlope disc_at(Vec2 centre, int x, int y) {
    const Vec2 off{x - centre.x, y - centre.y};
    const double r = norm(off);
    if (r > kDisc.reach()) return {};
    return {kDisc.darkness(r), r > 0 ? (kDisc.slope(r) / r) * off : Vec2{}};
}

/// Gauss–Newton of all positions at once, as it stands in books: d = (JᵀJ)⁻¹ Jᵀ(I − M), the whole
/// step taken, thirty times. Discs may leave the frame.
std::vector<Vec2> plain_gauss_newton(const Image& darkness, const std::vector<Vec2>& start) {
    std::vector<Vec2> found = start;
    const auto unknowns = static_cast<Eigen::Index>(2 * found.size());
    for (int iteration = 0; iteration < 30; ++iteration) {
        std::vector<std::vector<std::size_t>> near(darkness.size());
        const double reach = kDisc.reach();
        for (std::size_t j = 0; j < found.size(); ++j) {
            const Vec2 p = found[j];
            const auto last = [](double c, int size) {
                return static_cast<int>(std::min(c, size - 1.0));
            };
            for (int y = static_cast<int>(std::max(0.0, std::ceil(p.y - reach)));
                 y <= last(p.y + reach, darkness.height()); ++y) {
                for (int x = static_cast<int>(std::max(0.0, std::ceil(p.x - reach)));
                     x <= last(p.x + reach, darkness.width()); ++x) {
                    near[static_cast<std::size_t>(y * darkness.width() + x)].push_back(j);
                }
            }
        }
        Eigen::MatrixXd a = Eigen::MatrixXd::Zero(unknowns, unknowns);
        Eigen::VectorXd b = Eigen::VectorXd::Zero(unknowns);
        for (int y = 0; y < darkness.height(); ++y) {
            for (int x = 0; x < darkness.width(); ++x) {
                const auto& here = near[static_cast<std::size_t>(y * darkness.width() + x)];
                std::vector<DiscSlope> discs;
                double light = 1;
                for (const std::size_t j : here) {
                    discs.push_back(disc_at(found[j], x, y));
                    light *= 1 - discs.back().darkness;
                }
                const double left = static_cast<double>(darkness(x, y)) - 1 + light;
                Eigen::VectorXd row(static_cast<Eigen::Index>(2 * here.size()));
                for (std::size_t i = 0; i < here.size(); ++i) {
                    double others = 1;
                    for (std::size_t k = 0; k < here.size(); ++k) {
                        if (k != i) others *= 1 - discs[k].darkness;
                    }
                    row(static_cast<Eigen::Index>(2 * i)) = others * discs[i].slope.x;
                    row(static_cast<Eigen::Index>(2 * i + 1)) = others * discs[i].slope.y;
                }
                const auto index = [&](Eigen::Index i) {
                    return static_cast<Eigen::Index>(2 * here[static_cast<std::size_t>(i / 2)]) +
                           i % 2;
                };
                for (Eigen::Index i = 0; i < row.size(); ++i) {
                    b(index(i)) += left * row(i);
                    for (Eigen::Index k = 0; k < row.size(); ++k) {
                        a(index(i), index(k)) += row(i) * row(k);
                    }
                }
            }
        }
        // Positions that the image says nothing about stay; the factor would be singular.
        for (Eigen::Index i = 0; i < unknowns; ++i) a(i, i) += 1e-12;
        const Eigen::VectorXd d = a.ldlt().solve(b);
        for (std::size_t j = 0; j < found.size(); ++j) {
            const Vec2 step{d(static_cast<Eigen::Index>(2 * j)),
                            d(static_cast<Eigen::Index>(2 * j + 1))};
            if (is_finite(step)) found[j] += step;
        }
    }
    return found;
}

/// Damped Gauss–Newton of each disc alone: the image within its reach, as if there were no other.
std::vector<Vec2> fitted_alone(const Image& darkness, const std::vector<Vec2>& start) {
    std::vector<Vec2> found = start;
    const double reach = kDisc.reach();
    for (Vec2& p : found) {
        for (int i = 0; i < 20; ++i) {
            NormalEquations sum{};
            for (int y = static_cast<int>(p.y - reach); y <= static_cast<int>(p.y + reach); ++y) {
                for (int x = static_cast<int>(p.x - reach); x <= static_cast<int>(p.x + reach);
                     ++x) {
                    if (x < 0 || y < 0 || x >= darkness.width() || y >= darkness.height()) continue;
                    const DiscSlope disc = disc_at(p, x, y);
                    const double left = static_cast<double>(darkness(x, y)) - disc.darkness;
                    sum.xx += disc.slope.x * disc.slope.x;
                    sum.xy += disc.slope.x * disc.slope.y;
                    sum.yy += disc.slope.y * disc.slope.y;
                    sum.bx += left * disc.slope.x;
                    sum.by += left * disc.slope.y;
                }
            }
            p += DampedInverse(sum) * Vec2{sum.bx, sum.by};
        }
    }
    return found;
}

std::vector<Vec2> located(const Image& darkness, const std::vector<Vec2>& start, double step) {
    Locator locator(darkness.width(), darkness.height(), {kDisc}, 1);
    return locator.locate(darkness, {}, {}, start, step).position;
}

std::vector<Vec2> swept(const Image& darkness, const std::vector<Vec2>& start) {
    JointFit fit(darkness, kDisc, 1);
    fit.add_all(start);
    fit.refine({});
    return fit.positions();
}

// ---- starts far from the spheres ----

/// A square bilayer lattice over the whole frame; the least distance of spheres is `spacing`.
std::vector<Vec2> crystal(int side, double spacing, double jitter) {
    std::vector<Vec2> sites;
    RandomStream random(1, "stability crystal");
    for (double v = -side; v < side; v += spacing) {
        for (double u = -side; u < side; u += spacing) {
            const Vec2 p{
                side / 2.0 + u * std::cos(0.3) - v * std::sin(0.3) + jitter * random.normal(),
                side / 2.0 + u * std::sin(0.3) + v * std::cos(0.3) + jitter * random.normal()};
            if (std::min(p.x, p.y) >= 0 && std::max(p.x, p.y) <= side - 1) sites.push_back(p);
        }
    }
    return sites;
}

void far_starts() {
    constexpr int side = 256;
    struct Case {
        const char* name;
        std::vector<Vec2> truth;
    };
    const std::vector<Case> cases{
        {"liquid", testing::hard_disc_liquid(side, side, kDiameter, 0.72, 1).position},
        {"crystal", crystal(side, 0.78 * kDiameter, 0.03 * kDiameter)}};
    for (const auto& [name, truth] : cases) {
        const Image image = darkness_of(truth, side, 0.02);
        for (const double far : {0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5}) {
            std::vector<Vec2> start = truth;
            RandomStream random(1, "stability start");
            for (Vec2& p : start) {
                const double angle = 2 * std::numbers::pi * random.uniform();
                p += far * kDiameter * Vec2{std::cos(angle), std::sin(angle)};
            }
            const auto print = [&](const std::string& series, const std::vector<Vec2>& found) {
                print_row(std::string("start ") + name, series, far,
                          rms_to_nearest(found, truth, side, 2 * kDiameter) / kDiameter);
            };
            print("ours", located(image, start, far * kDiameter));
            print("ours, sweeps alone", swept(image, start));
            print("naive, Gauss–Newton", plain_gauss_newton(image, start));
            print("naive, centroid", centroids(image, start));
        }
    }
}

// ---- two layers whose holes close ----

void closing_holes() {
    constexpr int side = 360;
    constexpr double noise = 0.02;
    for (const double excess : {3e-4, 1e-3, 2e-3, 4e-3, 7e-3, 0.013, 0.025, 0.05, 0.09, 0.15}) {
        const double spacing = (std::numbers::sqrt2 / 2 + excess) * kDiameter;
        const std::vector<Vec2> truth = crystal(side, spacing, 0.01 * kDiameter);
        RandomStream random(1, "stability start");
        const Image image = darkness_of(truth, side, noise);
        std::vector<Vec2> start = truth;
        for (Vec2& p : start) p += 0.03 * kDiameter * Vec2{random.normal(), random.normal()};
        const auto print = [&](const char* series, const std::vector<Vec2>& found) {
            print_row("spacing", series, excess,
                      rms_to_nearest(found, truth, side, 3 * kDiameter) / kDiameter);
        };
        double squares = 0;
        int count = 0;
        const std::vector<Vec2> bounds = position_bounds(truth, kDisc, side, side, noise, 1);
        for (std::size_t i = 0; i < truth.size(); ++i) {
            const Vec2 p = truth[i];
            if (std::min({p.x, p.y, side - 1 - p.x, side - 1 - p.y}) < 3 * kDiameter) continue;
            if (!is_finite(bounds[i])) continue;
            squares += squared_norm(bounds[i]) / 2;
            ++count;
        }
        print_row("spacing", "joint Cramér–Rao bound", excess,
                  std::sqrt(squares / count) / kDiameter);
        print("start", start);
        print("ours, from the start", located(image, start, 0.03 * kDiameter));
        const std::vector<Vec2> cold = located(image, {}, 0);
        print("ours, without a start", cold);
        const auto score =
            testing::score_positions(cold, truth, kDiameter / 4, side, side, 3 * kDiameter);
        const auto n = static_cast<double>(score.matched + score.missed);
        print_row("cold", "ours, missed per true", excess, static_cast<double>(score.missed) / n);
        print_row("cold", "ours, false per true", excess, static_cast<double>(score.spurious) / n);
        print("ours, sweeps without the joint step", swept(image, start));
        print("naive, each disc alone", fitted_alone(image, start));
    }
}

// ---- noise as strong as the contrast ----

/// Centroids of the connected regions darker than half of the contrast, 20 pixels or more.
std::vector<Vec2> thresholded(const Image& darkness) {
    const int w = darkness.width(), h = darkness.height();
    std::vector<char> seen(darkness.size(), 0);
    std::vector<Vec2> found;
    std::vector<std::pair<int, int>> stack;
    const auto open = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= w || y >= h || darkness(x, y) < 0.5f) return;
        char& flag = seen[static_cast<std::size_t>(y * w + x)];
        if (flag != 0) return;
        flag = 1;
        stack.emplace_back(x, y);
    };
    for (int y0 = 0; y0 < h; ++y0) {
        for (int x0 = 0; x0 < w; ++x0) {
            open(x0, y0);
            Vec2 sum;
            int count = 0;
            while (!stack.empty()) {
                const auto [x, y] = stack.back();
                stack.pop_back();
                sum += Vec2{static_cast<double>(x), static_cast<double>(y)};
                ++count;
                open(x - 1, y);
                open(x + 1, y);
                open(x, y - 1);
                open(x, y + 1);
            }
            if (count >= 20) found.push_back((1.0 / count) * sum);
        }
    }
    return found;
}

void strong_noise() {
    constexpr int side = 640;
    const testing::LayerScene scene =
        testing::isolated_discs(side, side, kDiameter, 2 * kDiameter, 1);
    for (const double noise : {0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.7, 1.0}) {
        const Image darkness = darkness_of(scene.position, side, noise);
        Image counts(side, side);
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                counts(x, y) = std::round(30'000 - 10'000 * darkness(x, y));
            }
        }
        const auto print = [&](const std::string& name, const std::vector<Vec2>& found) {
            const auto score = testing::score_positions(found, scene.position, kDiameter / 4, side,
                                                        side, kDiameter);
            print_row("noise", name, noise, score.rms);
            const auto n = static_cast<double>(score.matched + score.missed);
            print_row("lost", name, noise, static_cast<double>(score.missed + score.spurious) / n);
        };
        RunPlan plan;
        LocateOptions options;
        options.threads = 1;
        print("ours, calibrated on the frame", locate(counts, options, &plan).position);
        options.calibration.diameter = kDiameter;
        print("ours, diameter given", locate(counts, options, &plan).position);
        print("ours, model given", located(darkness, {}, 0));
        print("naive, threshold and centroid", thresholded(darkness));
        print_row("noise", "Cramér–Rao bound", noise, noise / std::sqrt(kDisc.information()));
        for (const Warning& warning : plan.warnings()) {
            std::fprintf(stderr, "noise %g: %s\n", noise, warning.text.c_str());
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    return bench::print_plots(
        argc, argv, {{"start", far_starts}, {"spacing", closing_holes}, {"noise", strong_noise}});
}
