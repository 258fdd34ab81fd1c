#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "analysis/spectra/mode_overlap.h"
#include "analysis/spectra/structure_factor.h"

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

// The mean amplitudes that the modes of an isotropic pattern have by chance. The relative
// deviations of S(k) from the mean of their shell have variance 1/(M + 1/n), n independent modes in
// M frames (a Dirichlet distribution), and modes that overlap share theirs; (e − mean e), e =
// exp(i m θ), takes up that the mean of the shell is one of them. V = ⟨|z|²⟩ and P = ⟨z²⟩ of the
// sum z make an ellipse of variances (V ± |P|)/2, and ⟨|z|⟩ is its elliptic integral.
std::array<std::vector<double>, 2> StructureFactor::anisotropies_by_chance(
    const Shells& shells, Estimator estimator) const {
    const std::size_t count = shells.k.size();
    const std::vector<double> dof = spectrum(estimator).dof;
    const std::vector<double> modes = independent_modes(shells, estimator);
    constexpr auto none = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> shell(grid_.modes().size(), none);
    std::vector<double> width(count, 0.0);  // standard deviation of a deviation
    double all = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (shells.members[i].size() < least_modes) continue;
        width[i] = 1 / std::sqrt(std::max(1.0, dof[i] / modes[i]) + 1 / modes[i]);
        for (const std::size_t m : shells.members[i]) shell[m] = i;
        all += static_cast<double>(shells.members[i].size());
    }
    std::array<std::vector<double>, 2> chance;
    for (std::size_t h = 0; h < chance.size(); ++h) {
        std::vector<std::complex<double>> e(shell.size());
        for (const std::vector<std::size_t>& members : shells.members) {
            std::complex<double> mean = 0;
            for (const std::size_t m : members) {
                const Mode& mode = grid_.modes()[m];
                e[m] = std::polar(
                    1.0, 2 * (static_cast<double>(h) + 1) *
                             std::atan2(mode.ny * grid_.spacing().y, mode.nx * grid_.spacing().x));
                mean += e[m] / static_cast<double>(members.size());
            }
            for (const std::size_t m : members) e[m] -= mean;
        }
        // The sums of each shell, and of all at the end.
        std::vector<double> v(count + 1, 0.0);
        std::vector<std::complex<double>> p(count + 1);
        for_overlaps(grid_, box_.length, [&](std::size_t m, std::size_t other, double weight) {
            if (shell[m] == none || shell[other] == none) return;
            weight *= width[shell[m]] * width[shell[other]];
            const double of_v = weight * (e[m] * std::conj(e[other])).real();
            const std::complex<double> of_p = weight * e[m] * e[other];
            v[count] += of_v;
            p[count] += of_p;
            if (shell[m] != shell[other]) return;
            v[shell[m]] += of_v;
            p[shell[m]] += of_p;
        });
        for (std::size_t i = 0; i <= count; ++i) {
            const double large = 0.5 * (v[i] + std::abs(p[i]));
            const double small = std::max(0.0, 0.5 * (v[i] - std::abs(p[i])));
            const double n = i == count ? all : static_cast<double>(shells.members[i].size());
            if (!(large > 0)) {
                chance[h].push_back(undefined);
                continue;
            }
            chance[h].push_back(2 / n * std::sqrt(2 * large / std::numbers::pi) *
                                std::comp_ellint_2(std::sqrt(1 - small / large)));
        }
    }
    return chance;
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
    const auto chance = anisotropies_by_chance(shells, estimator);
    const std::vector<double> dof = spectrum(estimator).dof;
    Curve curve{"sk_anisotropy",
                "Anisotropy of S(k)",
                {{"k", "1/a", "Wavevector k a", {}},
                 {"a2", "-", "Two-fold amplitude", {}},
                 {"a4", "-", "Four-fold amplitude", {}},
                 {"chance2", "-", "Mean two-fold amplitude of an isotropic pattern", {}},
                 {"chance4", "-", "Mean four-fold amplitude of an isotropic pattern", {}}},
                {}};
    double independent = 0;
    for (std::size_t i = 0; i < shells.k.size(); ++i) {
        if (!std::isfinite(whole[0][i])) continue;
        curve.columns[0].values.push_back(shells.k[i]);
        for (std::size_t h = 0; h < 2; ++h) {
            curve.columns[1 + h].values.push_back(whole[h][i]);
            curve.columns[3 + h].values.push_back(chance[h][i]);
        }
        independent += dof[i];
    }
    if (curve.columns[0].values.empty()) return;
    result.curves.push_back(std::move(curve));

    std::array<std::vector<double>, 2> left;
    const std::vector<std::size_t> filled = filled_blocks();
    for (const std::size_t b : filled) {
        if (filled.size() < least_blocks) break;
        const auto part = anisotropies(shells, total(b), estimator);
        for (std::size_t h = 0; h < left.size(); ++h) left[h].push_back(part[h].back());
    }
    for (std::size_t h = 0; h < left.size(); ++h) {
        Measurement m{h == 0 ? "anisotropy_2" : "anisotropy_4",
                      "-",
                      whole[h].back(),
                      student_jackknife_error(left[h], least_blocks),
                      independent,
                      fmt::format("relative amplitude of the {}-fold harmonic; an isotropic "
                                  "pattern shows {:.3g} by chance",
                                  2 * (h + 1), chance[h].back())};
        if (!(m.error.value_or(0) > 0)) {
            m.error.reset();
            m.reason += "; no error from so few frames";
        }
        result.measurements.push_back(std::move(m));
    }
}

}  // namespace grainfield::analysis
