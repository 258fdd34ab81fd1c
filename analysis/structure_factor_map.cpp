#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "analysis/structure_factor.h"

// The structure factor as a function of the vector k, and how far it is from isotropic.

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr double most_modes = 20000;  // in the map
constexpr std::size_t least_blocks = 8;
constexpr std::size_t least_modes = 8;  // of a shell that says something about directions

}  // namespace

std::array<std::vector<double>, 2> StructureFactor::anisotropies(const Shells& shells,
                                                                 const Block& sums,
                                                                 Estimator estimator) const {
    std::array<std::vector<double>, 2> amplitudes;
    double all = 0;
    std::array<std::complex<double>, 2> over_all{};
    for (const std::vector<std::size_t>& members : shells.members) {
        std::vector<double> s;
        double mean = 0;
        for (const std::size_t m : members) {
            s.push_back(mode_value(sums, estimator, m));
            mean += s.back() / static_cast<double>(members.size());
        }
        std::array<std::complex<double>, 2> harmonic{};
        for (std::size_t i = 0; i < s.size() && mean > 0; ++i) {
            const Mode& mode = grid_.modes()[members[i]];
            const double angle =
                std::atan2(mode.ny * grid_.spacing().y, mode.nx * grid_.spacing().x);
            for (std::size_t h = 0; h < harmonic.size(); ++h) {
                // The deviation: what the grid itself prefers drops out.
                harmonic[h] +=
                    (s[i] / mean - 1) * std::polar(1.0, 2 * (static_cast<double>(h) + 1) * angle);
            }
        }
        const auto n = static_cast<double>(members.size());
        const bool enough = members.size() >= least_modes && mean > 0;
        for (std::size_t h = 0; h < harmonic.size(); ++h) {
            amplitudes[h].push_back(enough ? 2 * std::abs(harmonic[h]) / n : undefined);
            if (enough) over_all[h] += harmonic[h];
        }
        if (enough) all += n;
    }
    for (std::size_t h = 0; h < over_all.size(); ++h) {
        amplitudes[h].push_back(all > 0 ? 2 * std::abs(over_all[h]) / all : undefined);
    }
    return amplitudes;
}

Curve StructureFactor::map_curve(Estimator estimator) const {
    const Block sums = total(std::nullopt);
    const auto& modes = grid_.modes();
    double largest = 0;
    for (const Mode& mode : modes) largest = std::max(largest, mode.k);
    const double share = most_modes / static_cast<double>(modes.size());
    const double limit = share < 1 ? largest * std::sqrt(share) : largest;
    Curve curve{"sk_map",
                "Structure factor by wavevector, half plane",
                {{"kx", "1/a", "Wavevector, x", {}},
                 {"ky", "1/a", "Wavevector, y", {}},
                 {"s", "-", "S(k)", {}}},
                {}};
    for (std::size_t m = 0; m < modes.size(); ++m) {
        if (modes[m].k > limit) continue;
        curve.columns[0].values.push_back(modes[m].nx * grid_.spacing().x);
        curve.columns[1].values.push_back(modes[m].ny * grid_.spacing().y);
        curve.columns[2].values.push_back(mode_value(sums, estimator, m));
    }
    return curve;
}

void StructureFactor::add_directions(ObservableResult& result, Estimator estimator) const {
    if (grid_.rows().front() == 1 || grid_.rows().size() == 1) return;  // one axis only
    result.curves.push_back(map_curve(estimator));
    const Shells shells = this->shells(estimator);
    const auto whole = anisotropies(shells, total(std::nullopt), estimator);
    // An isotropic pattern has an amplitude too: of n independent modes in M frames
    // sqrt(π/(n M)) on average.
    const std::vector<double> modes = independent_modes(shells, estimator);
    const std::vector<double> frames = samples(shells, estimator);
    Curve curve{"sk_anisotropy",
                "Anisotropy of S(k)",
                {{"k", "1/a", "Wavevector k a", {}},
                 {"a2", "-", "Two-fold amplitude", {}},
                 {"a4", "-", "Four-fold amplitude", {}},
                 {"chance", "-", "Mean amplitude of an isotropic pattern", {}}},
                {}};
    double independent = 0;
    double count = 0;
    for (std::size_t i = 0; i < shells.k.size(); ++i) {
        if (!std::isfinite(whole[0][i])) continue;
        curve.columns[0].values.push_back(shells.k[i]);
        curve.columns[1].values.push_back(whole[0][i]);
        curve.columns[2].values.push_back(whole[1][i]);
        curve.columns[3].values.push_back(std::sqrt(std::numbers::pi / (modes[i] * frames[i])));
        // Σ over modes of 1/M of each: the variance of the sum over all shells.
        independent += shells.modes[i] * shells.modes[i] / (modes[i] * frames[i]);
        count += shells.modes[i];
    }
    if (curve.columns[0].values.empty()) return;
    result.curves.push_back(std::move(curve));

    std::array<std::vector<double>, 2> left;
    const std::size_t k = filled_blocks();
    for (std::size_t b = 0; k >= least_blocks && b < k; ++b) {
        const auto part = anisotropies(shells, total(b), estimator);
        for (std::size_t h = 0; h < left.size(); ++h) left[h].push_back(part[h].back());
    }
    const double chance = std::sqrt(std::numbers::pi * independent) / count;
    for (std::size_t h = 0; h < left.size(); ++h) {
        Measurement m{h == 0 ? "anisotropy_2" : "anisotropy_4",
                      "-",
                      whole[h].back(),
                      jackknife_error(left[h], least_blocks),
                      count,
                      fmt::format("relative amplitude of the {}-fold harmonic; an isotropic "
                                  "pattern shows {:.2g} by chance",
                                  2 * (h + 1), chance)};
        if (!(m.error.value_or(0) > 0)) {
            m.error.reset();
            m.reason += "; no error from so few frames";
        }
        result.measurements.push_back(std::move(m));
    }
}

}  // namespace grainfield::analysis
