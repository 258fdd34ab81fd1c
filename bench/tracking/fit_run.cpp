#include "bench/tracking/fit_run.h"

#include <utility>

#include <fmt/format.h>

#include "bench/tracking/reference_fit.h"
#include "core/support/random.h"
#include "tracking/model/known_models.h"
#include "tracking/model/product_image.h"
#include "tracking/refine/joint_fit.h"

namespace grainfield::bench {

namespace {

using namespace tracking;

/// As Locator does it: the last refinement again on the image that the product should see.
std::vector<Vec2> tracker_fit(const Image& darkness, const DiscProfile& disc,
                              const std::vector<Vec2>& start, const OverlapRule& rule) {
    JointFit fit(darkness, disc, 1);
    fit.add_all(start);
    fit.refine({});
    if (rule.is_product()) return fit.positions();
    const std::vector<Vec2> rough = fit.positions();
    fit.restart(product_image(darkness, rough, {disc, rule}, 1));
    fit.add_all(rough);
    fit.refine({});
    return fit.positions();
}

}  // namespace

std::optional<Located> FitRun::find() {
    Located found;
    found.position = fit_();
    return found;
}

std::vector<Vec2> displaced(const std::vector<Vec2>& positions, double diameter) {
    RandomStream random(1, "bench displaced");
    std::vector<Vec2> start = positions;
    for (Vec2& p : start) p += 0.03 * diameter * Vec2{random.normal(), random.normal()};
    return start;
}

std::vector<std::unique_ptr<TimedRun>> fit_runs(const Image& darkness, const DiscProfile& disc,
                                                const std::vector<Vec2>& start) {
    std::vector<std::unique_ptr<TimedRun>> runs;
    const auto add = [&]<class Real>(Real, const char* option, const std::string& value,
                                     const ReferenceFitOptions& options) {
        runs.push_back(std::make_unique<FitRun>(option, value, [=, &darkness, &start] {
            return reference_fit<Real>(darkness, disc, start, options);
        }));
    };
    add(double{}, "model", "product", {});
    add(double{}, "model", "maximum", {.sum = ImageSum::maximum});
    add(double{}, "model", "additive", {.sum = ImageSum::additive});
    add(float{}, "precision", "float", {});
    for (const double ring : {0.5, 1.0, 1.5, 2.0, 2.5}) {
        add(double{}, "ring", fmt::format("{:g}", ring), {.ring = ring});
    }
    for (const int sweeps : {1, 2, 3, 4, 6}) {
        add(double{}, "sweeps", fmt::format("{}", sweeps), {.max_sweeps = sweeps});
    }
    for (const OverlapRule* rule : overlap_rules()) {
        runs.push_back(std::make_unique<FitRun>(
            "tracker", std::string(rule->name()),
            [=, &darkness, &start] { return tracker_fit(darkness, disc, start, *rule); }));
    }
    return runs;
}

}  // namespace grainfield::bench
