#include "analysis/motion/van_hove.h"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "analysis/statistics/blocks.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

double non_gaussian(const VanHoveGroup& sum) {
    if (!(sum.squares > 0)) return undefined;
    const double square = sum.squares / sum.number;
    return sum.fourths / sum.number / (3 * square * square) - 1;
}

Curve& curve_of(ObservableResult& result) {
    for (Curve& curve : result.curves) {
        if (curve.name == "van_hove") return curve;
    }
    result.curves.push_back({"van_hove",
                             "Self part of the van Hove function",
                             {{"x", "a", "Displacement along an axis", {}},
                              {"g", "1/a", "Density of the displacements", {}},
                              {"err", "1/a", "Standard error", {}},
                              {"t", "time unit", "Lag time", {}}},
                             {}});
    return result.curves.back();
}

}  // namespace

VanHoveGroup pooled(std::span<const VanHoveGroup> groups, std::size_t without) {
    VanHoveGroup sum{std::vector<double>(van_hove_bins, 0.0)};
    for (std::size_t g = 0; g < groups.size(); ++g) {
        if (g == without) continue;
        for (std::size_t b = 0; b < van_hove_bins; ++b) sum.counts[b] += groups[g].counts[b];
        sum.number += groups[g].number;
        sum.squares += groups[g].squares;
        sum.fourths += groups[g].fourths;
    }
    return sum;
}

void VanHoveGroup::add(Vec2 d, double width) {
    for (const double x : {d.x, d.y}) {
        const double bin = std::abs(x) / width;
        if (bin < static_cast<double>(van_hove_bins)) counts[static_cast<std::size_t>(bin)] += 1;
        number += 1;
        squares += x * x;
        fourths += x * x * x * x;
    }
}

void add_van_hove_lag(std::span<const VanHoveGroup> groups, double width, std::int64_t lag,
                      double time, ObservableResult& result) {
    const std::size_t none = groups.size();
    const VanHoveGroup all = pooled(groups, none);
    const std::string name = fmt::format("alpha2_lag_{}", lag);
    if (!(all.number > 0) || !(all.squares > 0)) {
        result.measurements.push_back(missing(
            name, "-", all.number > 0 ? "nothing moves" : "no pair of sightings so far apart"));
        return;
    }
    Curve& curve = curve_of(result);
    std::vector<VanHoveGroup> left;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        if (groups[g].number > 0) left.push_back(pooled(groups, g));
    }
    for (std::size_t b = 0; b < van_hove_bins; ++b) {
        // Both signs fall in a bin of |x|.
        const auto density = [&](const VanHoveGroup& sum) {
            return sum.number > 0 ? sum.counts[b] / (2 * width * sum.number) : undefined;
        };
        std::vector<double> values;
        for (const VanHoveGroup& part : left) values.push_back(density(part));
        curve.columns[0].values.push_back((static_cast<double>(b) + 0.5) * width);
        curve.columns[1].values.push_back(density(all));
        curve.columns[2].values.push_back(student_jackknife_error(values).value_or(undefined));
        curve.columns[3].values.push_back(time);
        curve.text_columns["lag"].push_back(fmt::format("{}", lag));
    }
    std::vector<double> values;
    for (const VanHoveGroup& part : left) values.push_back(non_gaussian(part));
    Measurement m{name,
                  "-",
                  non_gaussian(all),
                  student_jackknife_error(values),
                  0.5 * all.number,
                  "non-Gaussian parameter at this lag [frames]; samples: pairs of sightings"};
    if (!(m.error.value_or(0) > 0)) {
        m.reason += m.error ? "; all particles move alike: no error from their scatter"
                            : "; particles in fewer than four groups of the jackknife: no error";
        m.error.reset();
    }
    result.measurements.push_back(std::move(m));
}

}  // namespace grainfield::analysis
