#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "analysis/bond_statistics.h"
#include "analysis/structure_factor.h"

// Estimators and curves of the structure factor: what is made of the sums that
// structure_factor.cpp gathers.

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

// Number of the shell of a mode, growing with k. Without a given width every distinct |k| below 5.5
// grid steps is a shell of its own, above shells are one step wide.
std::int64_t shell_of(double k, double step, const std::optional<double>& width) {
    if (width) return std::llround(k / *width);
    constexpr double distinct = 1e6;
    const double n = k / step;
    return n < 5.5 ? std::llround(n * distinct) : std::llround(n) * std::llround(distinct);
}

}  // namespace

StructureFactor::Block StructureFactor::total(std::optional<std::size_t> without) const {
    Block sums = empty_block();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        if (without && *without == b) continue;
        const Block& block = blocks_[b];
        sums.frames += block.frames;
        sums.particles += block.particles;
        for (std::size_t m = 0; m < sums.rho.size(); ++m) {
            sums.rho[m] += block.rho[m];
            sums.power[m] += block.power[m];
        }
        for (std::size_t c = 0; c < sums.cosine.size(); ++c) {
            sums.cosine[c] += block.cosine[c];
            sums.cosine2[c] += block.cosine2[c];
        }
    }
    return sums;
}

StructureFactor::Shells StructureFactor::shells(Estimator estimator) const {
    const double step = std::min(grid_.spacing().x, grid_.spacing().y);
    std::map<std::int64_t, std::vector<std::size_t>> by_shell;
    for (std::size_t m = 0; m < grid_.modes().size(); ++m) {
        if (estimator == Estimator::neumann && neumann_index_[m] == nowhere) continue;
        by_shell[shell_of(grid_.modes()[m].k, step, options_.shell_width)].push_back(m);
    }
    Shells shells;
    for (auto& [number, members] : by_shell) {
        double k = 0;
        for (std::size_t m : members) k += grid_.modes()[m].k;
        shells.k.push_back(k / static_cast<double>(members.size()));
        shells.modes.push_back(static_cast<double>(members.size()));
        shells.members.push_back(std::move(members));
    }
    return shells;
}

// S of one mode without the factor M/(M − 1).
double StructureFactor::mode_value(const Block& sums, Estimator estimator, std::size_t mode) const {
    const double frames = sums.frames;
    const double particles = sums.particles / frames;
    switch (estimator) {
        case Estimator::raw:
            return sums.power[mode] / frames / particles;
        case Estimator::connected:
            return (sums.power[mode] / frames - std::norm(sums.rho[mode] / frames)) / particles;
        case Estimator::neumann:
            break;
    }
    const std::size_t c = neumann_index_[mode];
    const double mean = sums.cosine[c] / frames;
    return 4 * (sums.cosine2[c] / frames - mean * mean) / particles;
}

// Independent frames behind each shell: K blocks, var(frame)/var(block mean) of them in each.
std::vector<double> StructureFactor::samples(const Shells& shells, Estimator estimator) const {
    const Block sums = total(std::nullopt);
    const double frames = sums.frames;
    const auto k = static_cast<double>(blocks_.size());
    std::vector<double> samples(shells.k.size(), frames);
    if (frames <= k) return samples;
    for (std::size_t s = 0; s < samples.size(); ++s) {
        double of_frames = 0;
        double of_blocks = 0;
        for (std::size_t m : shells.members[s]) {
            of_frames +=
                mode_value(sums, estimator == Estimator::raw ? Estimator::connected : estimator,
                           m) *
                (sums.particles / frames);
            for (const Block& block : blocks_) {
                if (estimator == Estimator::neumann) {
                    const std::size_t c = neumann_index_[m];
                    const double d = block.cosine[c] / block.frames - sums.cosine[c] / frames;
                    of_blocks += 4 * d * d / (k - 1);
                } else {
                    of_blocks +=
                        std::norm(block.rho[m] / block.frames - sums.rho[m] / frames) / (k - 1);
                }
            }
        }
        if (of_blocks > 0) samples[s] = std::clamp(k * of_frames / of_blocks, k, frames);
    }
    return samples;
}

std::vector<double> StructureFactor::averages(const Shells& shells, const Block& sums,
                                              Estimator estimator,
                                              const std::vector<double>& samples) const {
    std::vector<double> s(shells.k.size(), undefined);
    if (!(sums.particles > 0)) return s;
    for (std::size_t i = 0; i < s.size(); ++i) {
        double sum = 0;
        for (std::size_t m : shells.members[i]) sum += mode_value(sums, estimator, m);
        // Leaving a block out leaves that share of the independent frames out.
        const double left = samples[i] * sums.frames / static_cast<double>(added_);
        const double bias = estimator == Estimator::raw ? 1 : left / (left - 1);
        s[i] = left > 1 || estimator == Estimator::raw ? sum / shells.modes[i] * bias : undefined;
    }
    return s;
}

Curve StructureFactor::curve(const char* name, const char* title, Estimator estimator) const {
    const Shells shells = this->shells(estimator);
    const std::vector<double> samples = this->samples(shells, estimator);
    const Block sums = total(std::nullopt);
    const std::vector<double> s = averages(shells, sums, estimator, samples);
    std::vector<double> error(s.size(), undefined);
    if (blocks_.size() >= 4) {
        std::vector<std::vector<double>> left(s.size());
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            const std::vector<double> part = averages(shells, total(b), estimator, samples);
            for (std::size_t i = 0; i < s.size(); ++i) left[i].push_back(part[i]);
        }
        for (std::size_t i = 0; i < s.size(); ++i) {
            error[i] = jackknife_error(left[i], 4).value_or(undefined);
        }
    } else {
        for (std::size_t i = 0; i < s.size(); ++i) {
            if (shells.modes[i] < 4 || !std::isfinite(s[i])) continue;
            double mean = 0;
            double squares = 0;
            for (std::size_t m : shells.members[i]) {
                const double value = mode_value(sums, estimator, m);
                mean += value;
                squares += value * value;
            }
            mean /= shells.modes[i];
            const double spread = std::max(0.0, squares / shells.modes[i] - mean * mean);
            error[i] = std::sqrt(spread / (shells.modes[i] - 1));
        }
    }
    Curve curve;
    curve.name = name;
    curve.title = title;
    curve.columns = {Column{"k", "1/a", "Wavevector k a", shells.k}, Column{"s", "-", "S(k)", s},
                     Column{"s_err", "-", "Standard error of S(k)", error},
                     Column{"n", "-", "Modes in the half plane", shells.modes}};
    return curve;
}

Curve StructureFactor::samples_curve(Estimator estimator) const {
    const Shells shells = this->shells(estimator);
    Curve curve;
    curve.name = "sk_samples";
    curve.title = "Independent frames behind S(k)";
    curve.columns = {Column{"k", "1/a", "Wavevector k a", shells.k},
                     Column{"samples", "-", "Independent frames", samples(shells, estimator)}};
    return curve;
}

void StructureFactor::add_measurements(ObservableResult& result, const std::string& reason) const {
    const auto lowest = [&](const char* curve_name, const std::string& name) {
        const Curve* curve = result.find_curve(curve_name);
        if (curve == nullptr || curve->columns[0].values.empty()) return;
        const double s = curve->find("s")->values.front();
        const double error = curve->find("s_err")->values.front();
        Measurement m{name, "-", s, std::nullopt, static_cast<double>(blocks_.size()), reason};
        if (std::isfinite(error)) {
            m.error = error;
        } else if (m.reason.empty()) {
            m.reason = "too few frames or modes for an error";
        }
        result.measurements.push_back(m);
    };
    lowest("sk", "s_lowest_k");
    lowest("sk_raw", "s_raw_lowest_k");
    lowest("sk_neumann", "s_neumann_lowest_k");
    const Curve* sk = result.find_curve("sk");
    result.measurements.push_back({"lowest_k", "1/a", sk->columns[0].values.front(), std::nullopt,
                                   0, "fixed by the box, not measured"});
}

ObservableResult StructureFactor::result() const {
    ObservableResult result;
    result.name = "sk";
    StructureFactorOptions options = options_;
    result.options = recorded(describe(options));
    const Block sums = total(std::nullopt);
    if (grid_.modes().empty()) {
        result.reason =
            fmt::format("no wavevector below k_max = {} /a fits into the box", options_.k_max);
        return result;
    }
    if (sums.particles <= 0) {
        result.reason = added_ == 0 ? "no frames" : "no particles";
        return result;
    }
    const bool connected = added_ >= 2 && !box_.is_periodic();
    std::string reason;
    if (added_ < 2 && !box_.is_periodic()) {
        reason = "one frame: the mean density cannot be subtracted, raw estimator with walls in it";
    }
    const Estimator best = connected ? Estimator::connected : Estimator::raw;
    result.curves.push_back(
        curve("sk", connected ? "Structure factor, connected" : "Structure factor, raw", best));
    result.curves.push_back(curve("sk_raw", "Structure factor, raw", Estimator::raw));
    if (added_ >= 2 && has_neumann()) {
        result.curves.push_back(
            curve("sk_neumann", "Structure factor, modes of a walled box", Estimator::neumann));
    }
    if (added_ >= 2) result.curves.push_back(samples_curve(best));
    add_measurements(result, reason);
    return result;
}

}  // namespace grainfield::analysis
