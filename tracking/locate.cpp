#include "tracking/locate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "tracking/detect/local_maxima.h"

namespace grainfield::tracking {
namespace {

constexpr int kLastRounds = 4;
constexpr double kCandidateShare = 0.3;

/// Points on a grid, for "is there one within this distance?".
class PointGrid {
 public:
    explicit PointGrid(double distance) : distance_(distance) {}

    void add(Vec2 p, std::uint32_t index) {
        cells_[key(cell(p.x), cell(p.y))].push_back({p, index});
    }

    template <class Action>
    void near(Vec2 p, Action&& action) const {
        for (std::int64_t y = cell(p.y) - 1; y <= cell(p.y) + 1; ++y) {
            for (std::int64_t x = cell(p.x) - 1; x <= cell(p.x) + 1; ++x) {
                const auto found = cells_.find(key(x, y));
                if (found == cells_.end()) continue;
                for (const Entry& e : found->second) {
                    if (squared_norm(e.position - p) < distance_ * distance_) action(e.index);
                }
            }
        }
    }

    bool any(Vec2 p) const {
        bool hit = false;
        near(p, [&](std::uint32_t) { hit = true; });
        return hit;
    }

 private:
    struct Entry {
        Vec2 position;
        std::uint32_t index;
    };
    std::int64_t cell(double v) const {
        return static_cast<std::int64_t>(std::floor(v / distance_));
    }
    static std::int64_t key(std::int64_t x, std::int64_t y) { return x * 1'000'003 + y; }

    double distance_;
    std::unordered_map<std::int64_t, std::vector<Entry>> cells_;
};

/// RMS of the residual where the model is flat (clear background or core), outliers beyond four
/// robust standard deviations left out.
double flat_noise(const Image& darkness, const Image& transmission) {
    std::vector<float> deviations;
    for (std::size_t i = 0; i < transmission.size(); ++i) {
        const float t = transmission.pixels()[i];
        if (t > 0.995F || t < 0.005F) {
            deviations.push_back(std::abs(darkness.pixels()[i] - 1.0F + t));
        }
    }
    if (deviations.size() < 100) return 0;
    const auto middle = deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2);
    std::nth_element(deviations.begin(), middle, deviations.end());
    const float widest = 4 * 1.4826F * *middle;
    double sum = 0;
    double n = 0;
    for (const float d : deviations) {
        if (d > widest) continue;
        sum += static_cast<double>(d) * static_cast<double>(d);
        n += 1;
    }
    return std::sqrt(sum / n);
}

/// Weakest first: discs that explain less than `threshold`, and the weaker of every pair nearer
/// than `separation`. Neighbours of a disc that goes stay for this pass, since they may explain
/// more now.
std::vector<char> discs_to_keep(const std::vector<Vec2>& positions,
                                const std::vector<double>& explained, double threshold,
                                double separation, double influence) {
    std::vector<std::uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return explained[a] != explained[b] ? explained[a] < explained[b] : a < b;
    });
    PointGrid all(separation);
    for (std::size_t j = 0; j < positions.size(); ++j) {
        all.add(positions[j], static_cast<std::uint32_t>(j));
    }
    PointGrid gone(influence);
    std::vector<char> keep(positions.size(), 1);
    for (const std::uint32_t j : order) {
        bool too_near = false;
        all.near(positions[j], [&](std::uint32_t other) {
            if (other != j && keep[other]) too_near = true;
        });
        if (explained[j] >= threshold && !too_near) continue;
        if (gone.any(positions[j])) continue;
        keep[j] = 0;
        gone.add(positions[j], j);
    }
    return keep;
}

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

OptionTable describe(DetectionOptions& options) {
    OptionTable table("detect");
    table.number("cutoff", options.cutoff, "-", {1, 1000},
                 "first candidates need 1/chi-squared above this");
    table.number("separation", options.separation, "D", {0.05, 2},
                 "two centres nearer than this are one sphere");
    table.number("evidence", options.evidence, "-", {0, 1},
                 "share of an isolated sphere's misfit that each sphere must explain");
    table.number("border", options.border, "D", {0, 10},
                 "centres nearer to the image border than this are not reported");
    table.number("significance", options.significance, "sigma", {0, 1000},
                 "evidence for a sphere in standard deviations of the noise");
    table.integer("max-passes", options.max_passes, "-", {1, 1000},
                  "most rounds of adding and removing spheres");
    return table;
}

Locator::Locator(int width, int height, const DiscProfile& disc, int threads)
    : disc_(disc), threads_(threads), correlation_(width, height, disc) {}

void Locator::seed(JointFit& fit, const Image& darkness, const DetectionOptions& detection,
                   const std::vector<Vec2>& start) {
    for (const Vec2 p : start) fit.add(p);
    if (!start.empty()) return;
    Image inverse = correlation_.chi_squared(darkness);
    for (float& v : inverse.pixels()) v = 1.0F / std::max(v, 1e-3F);
    const auto cutoff = static_cast<float>(detection.cutoff);
    for (const Peak& peak : local_maxima(inverse, cutoff, 0.6 * disc_.diameter)) {
        fit.add(peak.position);
    }
}

Located Locator::locate(const Image& darkness, const DetectionOptions& detection,
                        const RefinementOptions& refinement, const std::vector<Vec2>& start) {
    Located found;
    JointFit fit(darkness, disc_, threads_);
    const double separation = detection.separation * disc_.diameter;
    // Rough rounds stop early: positions only need to be good enough to judge the residual.
    RefinementOptions rough = refinement;
    rough.tolerance = std::max(refinement.tolerance, 0.02);
    rough.max_sweeps = std::min(refinement.max_sweeps, 4);

    auto begin = Clock::now();
    seed(fit, darkness, detection, start);
    found.detect_seconds += seconds_since(begin);

    PointGrid rejected(0.25 * disc_.diameter);
    double threshold = 0;
    const auto remove_unfounded = [&] {
        found.noise = flat_noise(darkness, fit.transmission());
        threshold =
            std::max(detection.evidence * correlation_.full_gain(),
                     detection.significance * detection.significance * found.noise * found.noise);
        const std::vector<char> keep = discs_to_keep(fit.positions(), fit.explained(), threshold,
                                                     separation, 2 * disc_.reach());
        std::int64_t removed = 0;
        for (std::size_t j = 0; j < keep.size(); ++j) {
            if (keep[j]) continue;
            ++removed;
            rejected.add(fit.positions()[j], 0);
        }
        if (removed > 0) fit.keep_only(keep);
        found.removed += removed;
        return removed;
    };
    const auto add_missing = [&] {
        PointGrid present(separation);
        for (const Vec2 p : fit.positions()) present.add(p, 0);
        std::int64_t added = 0;
        // Neighbours have moved to cover for a missing sphere, so its gain before they move back is
        // only part of what it will explain; whoever disappoints is removed again, for good.
        for (const Peak& peak :
             local_maxima(correlation_.gain(darkness, fit.transmission()),
                          static_cast<float>(kCandidateShare * threshold), 0.8 * disc_.diameter)) {
            if (present.any(peak.position) || rejected.any(peak.position)) continue;
            fit.add(peak.position);
            ++added;
        }
        found.added += added;
        return added;
    };

    found.settled_detection = false;
    while (found.passes < detection.max_passes && !found.settled_detection) {
        ++found.passes;
        begin = Clock::now();
        fit.refine(rough);
        found.refine_seconds += seconds_since(begin);
        begin = Clock::now();
        const std::int64_t removed = remove_unfounded();
        found.settled_detection = add_missing() == 0 && removed == 0;
        found.detect_seconds += seconds_since(begin);
    }
    // The last refinement may bring two discs together; the weaker one goes and its neighbours
    // settle.
    for (int round = 0; round < kLastRounds; ++round) {
        begin = Clock::now();
        found.unsettled = fit.refine(refinement).unsettled;
        found.refine_seconds += seconds_since(begin);
        if (remove_unfounded() == 0) break;
    }

    found.residual_rms = fit.residual_rms();
    // Discs at the border have explained what is dark there; half unseen, they are not to be
    // trusted.
    const double border = detection.border * disc_.diameter;
    const std::vector<JointFit::Uncertainty> uncertainties = fit.uncertainties();
    for (std::size_t j = 0; j < uncertainties.size(); ++j) {
        const Vec2 p = fit.positions()[j];
        if (std::min({p.x, p.y, darkness.width() - 1 - p.x, darkness.height() - 1 - p.y}) <
            border) {
            continue;
        }
        found.position.push_back(p);
        found.error.push_back(uncertainties[j].error);
        found.residual.push_back(uncertainties[j].residual);
    }
    found.fitted = fit.positions();
    found.transmission = fit.transmission();
    return found;
}

}  // namespace grainfield::tracking
