#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "analysis/recorded_options.h"
#include "analysis/spectra/mode_overlap.h"
#include "analysis/spectra/structure_factor.h"

// Estimators and curves of the structure factor: what is made of the sums that
// structure_factor.cpp gathers.

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t least_blocks = 8;  // for a jackknife

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
    std::vector<int> times(blocks_.size(), 1);
    if (without) times[*without] = 0;
    return total_of(times);
}

void StructureFactor::add_block(Block& to, const Block& from, double weight) {
    to.frames += weight * from.frames;
    to.particles += weight * from.particles;
    for (std::size_t m = 0; m < to.rho.size(); ++m) to.rho[m] += weight * from.rho[m];
    for (std::size_t m = 0; m < to.power.size(); ++m) to.power[m] += weight * from.power[m];
    for (std::size_t c = 0; c < to.cosine.size(); ++c) {
        to.cosine[c] += weight * from.cosine[c];
        to.cosine2[c] += weight * from.cosine2[c];
    }
}

StructureFactor::Block StructureFactor::total_of(std::span<const int> times) const {
    Block sums = empty_block();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        if (times[b] != 0) add_block(sums, blocks_[b], times[b]);
    }
    return sums;
}

StructureFactor::Shells StructureFactor::shells(Estimator estimator) const {
    const double step = std::min(grid_.spacing().x, grid_.spacing().y);
    std::map<std::int64_t, std::vector<std::size_t>> by_shell;
    for (std::size_t m = 0; m < grid_.modes().size(); ++m) {
        if (estimator == Estimator::neumann && neumann_index_[m] == nowhere) continue;
        const double k = grid_.modes()[m].k;
        if (edges_.empty()) {
            by_shell[shell_of(k, step, options_.shell_width)].push_back(m);
        } else if (k >= edges_.front() && k <= edges_.back()) {
            const auto above = std::ranges::upper_bound(edges_.begin(), edges_.end() - 1, k);
            by_shell[above - edges_.begin()].push_back(m);
        }
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
        case Estimator::connected: {
            double of_mean = 0;
            for (std::size_t m = mode; m < sums.rho.size(); m += sums.power.size()) {
                of_mean += std::norm(sums.rho[m] / frames);
            }
            return (sums.power[mode] / frames - of_mean) / particles;
        }
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
    const std::vector<std::size_t> filled = filled_blocks();
    const auto k = static_cast<double>(filled.size());
    std::vector<double> samples(shells.k.size(), frames);
    if (frames <= k) return samples;
    // Of one block of several it is not known: all its frames count as one.
    if (k < 2) return std::vector<double>(shells.k.size(), blocks_.size() > 1 ? k : frames);
    for (std::size_t s = 0; s < samples.size(); ++s) {
        double of_frames = 0;
        double of_blocks = 0;
        for (std::size_t m : shells.members[s]) {
            of_frames +=
                mode_value(sums, estimator == Estimator::raw ? Estimator::connected : estimator,
                           m) *
                (sums.particles / frames);
            for (const std::size_t b : filled) {
                const Block& block = blocks_[b];
                if (estimator == Estimator::neumann) {
                    const std::size_t c = neumann_index_[m];
                    const double d = block.cosine[c] / block.frames - sums.cosine[c] / frames;
                    of_blocks += 4 * d * d / (k - 1);
                    continue;
                }
                for (std::size_t c = m; c < sums.rho.size(); c += sums.power.size()) {
                    of_blocks +=
                        std::norm(block.rho[c] / block.frames - sums.rho[c] / frames) / (k - 1);
                }
            }
        }
        if (of_blocks > 0) samples[s] = std::clamp(k * of_frames / of_blocks, k, frames);
    }
    return samples;
}

std::vector<std::size_t> StructureFactor::filled_blocks() const {
    std::vector<std::size_t> filled;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        if (blocks_[b].frames > 0) filled.push_back(b);
    }
    return filled;
}

// What the block means of the modes tell. Shells within a fifth in k are taken together.
std::vector<BlockDrift> StructureFactor::drifts(const Shells& shells, Estimator estimator) const {
    const std::vector<std::size_t> filled = filled_blocks();
    std::vector<double> frames;
    for (const std::size_t b : filled) frames.push_back(blocks_[b].frames);
    std::vector<BlockScatter> scatter(shells.k.size());
    for (std::size_t s = 0; s < scatter.size(); ++s) {
        for (const std::size_t m : shells.members[s]) {
            if (estimator == Estimator::neumann) {
                std::vector<double> means;
                for (const std::size_t b : filled) {
                    means.push_back(blocks_[b].cosine[neumann_index_[m]] / blocks_[b].frames);
                }
                add_scatter<double>(scatter[s], frames, means);
                continue;
            }
            for (std::size_t c = m; c < blocks_[0].rho.size(); c += grid_.modes().size()) {
                std::vector<std::complex<double>> means;
                for (const std::size_t b : filled) {
                    means.push_back(blocks_[b].rho[c] / blocks_[b].frames);
                }
                add_scatter<std::complex<double>>(scatter[s], frames, means);
            }
        }
    }
    std::vector<BlockDrift> drifts;
    for (std::size_t i = 0; i < scatter.size(); ++i) {
        BlockScatter near;
        for (std::size_t j = 0; j < scatter.size(); ++j) {
            if (std::abs(std::log(shells.k[j] / shells.k[i])) > 0.2) continue;
            near.squares += scatter[j].squares;
            near.steps += scatter[j].steps;
        }
        drifts.push_back(block_drift(near, filled.size()));
    }
    return drifts;
}

// frames_of_mean of the shells. Where the scatter of blocks is not what tells `samples`, they are
// the frames themselves: one more than that.
std::vector<double> StructureFactor::samples_of_mean(const std::vector<double>& samples,
                                                     const std::vector<BlockDrift>& drifts) const {
    double frames = 0;
    for (const Block& block : blocks_) frames += block.frames;
    const auto filled = static_cast<double>(filled_blocks().size());
    const double more = frames <= filled || filled < 2 ? 1 : 0;
    std::vector<double> of_mean;
    for (std::size_t s = 0; s < samples.size(); ++s) {
        of_mean.push_back(frames_of_mean(samples[s] - more, drifts[s]));
    }
    return of_mean;
}

// How many independent modes a shell is worth: plane waves that do not fit between the walls
// overlap.
std::vector<double> StructureFactor::independent_modes(const Shells& shells,
                                                       Estimator estimator) const {
    if (estimator == Estimator::neumann) return shells.modes;
    std::vector<std::size_t> shell(grid_.modes().size(), nowhere);
    for (std::size_t s = 0; s < shells.members.size(); ++s) {
        for (std::size_t m : shells.members[s]) shell[m] = s;
    }
    std::vector<double> sums(shells.k.size(), 0.0);
    for_overlaps(grid_, box_.length, [&](std::size_t m, std::size_t other, double weight) {
        if (shell[m] != nowhere && shell[m] == shell[other]) sums[shell[m]] += weight;
    });
    std::vector<double> independent;
    for (std::size_t s = 0; s < sums.size(); ++s) {
        const double components = static_cast<double>(components_);
        independent.push_back(components * shells.modes[s] * shells.modes[s] / sums[s]);
    }
    return independent;
}

std::vector<double> StructureFactor::few_frames_error(const Shells& shells, Estimator estimator,
                                                      const std::vector<double>& s) const {
    // Fields of one instant are no independent ones.
    const std::int64_t instants = added_ / replicas_;
    const auto frames = static_cast<double>(instants);
    const double each = estimator == Estimator::raw         ? frames
                        : estimator == Estimator::connected ? frames - 1
                                                            : 0.5 * (frames - 1);
    const std::vector<double> modes = independent_modes(shells, estimator);
    std::vector<double> error(s.size(), undefined);
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double n = each * modes[i];
        if (n > 2) error[i] = s[i] * std::sqrt((n + 2) / ((n - 1) * (n - 2)));
    }
    return error;
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

const char* StructureFactor::symbol() const {
    return components_ == 1 ? "S(k)" : "S4(k)";
}

Curve StructureFactor::curve(const char* name, const char* method, Estimator estimator) const {
    const Shells shells = this->shells(estimator);
    const std::vector<double> independent = this->samples(shells, estimator);
    const std::vector<BlockDrift> drifts = this->drifts(shells, estimator);
    const std::vector<double> samples = samples_of_mean(independent, drifts);
    const std::vector<BlockDrift> uncorrelated(drifts.size());
    const Block sums = total(std::nullopt);
    const std::vector<double> s = averages(shells, sums, estimator, samples);
    std::vector<double> error(s.size(), undefined);
    if (blocks_.size() >= least_blocks) {
        const std::vector<std::size_t> filled = filled_blocks();
        std::vector<std::vector<double>> left(s.size());
        for (const std::size_t b : filled) {
            if (filled.size() < least_blocks) break;
            const std::vector<double> part = averages(shells, total(b), estimator, samples);
            for (std::size_t i = 0; i < s.size(); ++i) left[i].push_back(part[i]);
        }
        // What correlation adds is as uncertain as the few block means that tell it.
        const std::vector<double> of_independent =
            averages(shells, sums, estimator, samples_of_mean(independent, uncorrelated));
        for (std::size_t i = 0; i < s.size(); ++i) {
            const auto spread = student_jackknife_error(left[i], least_blocks);
            if (!spread || drifts[i].step_ratio < least_step_ratio) continue;
            error[i] = std::hypot(*spread, s[i] - of_independent[i]);
        }
    } else {
        error = few_frames_error(shells, estimator, s);
    }
    Curve curve;
    curve.name = name;
    curve.title =
        fmt::format("Structure factor{}, {}", components_ == 1 ? "" : " of the order", method);
    curve.columns = {Column{"k", "1/a", "Wavevector k a", shells.k}, Column{"s", "-", symbol(), s},
                     Column{"s_err", "-", fmt::format("Standard error of {}", symbol()), error},
                     Column{"n", "-", "Modes in the half plane", shells.modes}};
    return curve;
}

bool StructureFactor::allows(Estimator estimator) const {
    const bool measured = added_ > 0 && !grid_.modes().empty();
    if (estimator == Estimator::raw) return measured;
    return measured && added_ >= 2 && (estimator == Estimator::connected || has_neumann());
}

Spectrum StructureFactor::spectrum(Estimator estimator, std::span<const int> times) const {
    const Shells shells = this->shells(estimator);
    const std::vector<double> samples = this->samples(shells, estimator);
    const std::vector<double> modes = independent_modes(shells, estimator);
    const Block sums = times.empty() ? total(std::nullopt) : total_of(times);
    Spectrum spectrum;
    spectrum.k = shells.k;
    const std::vector<BlockDrift> drifts = this->drifts(shells, estimator);
    spectrum.s = averages(shells, sums, estimator, samples_of_mean(samples, drifts));
    const auto frames = static_cast<double>(added_);
    const double block = frames / static_cast<double>(filled_blocks().size());
    for (std::size_t i = 0; i < shells.k.size(); ++i) {
        // T/M from few blocks is noisy: the mean over shells within a fifth or so in k.
        double sum = 0;
        double weight = 0;
        for (std::size_t j = 0; j < shells.k.size(); ++j) {
            const double u = std::log(shells.k[j] / shells.k[i]) / 0.2;
            if (std::abs(u) > 3) continue;
            const double w = shells.modes[j] * std::exp(-0.5 * u * u);
            sum += w * frames / samples[j];
            weight += w;
        }
        const double r = correlation_of_excess(sum / weight, block);
        const double kept = (1 - r) / (1 + r);
        double nu = modes[i] * frames * (1 - r * r) / (1 + r * r);
        if (estimator != Estimator::raw) nu *= std::max(0.0, 1 - 1 / (frames * kept));
        if (estimator == Estimator::neumann) nu *= 0.5;
        // Too slow for the run: one look, and nothing at all where the mean had to be subtracted.
        const bool is_slow = drifts[i].step_ratio < least_step_ratio;
        if (is_slow) nu = estimator == Estimator::raw ? modes[i] : 0;
        spectrum.dof.push_back(nu);
        spectrum.error.push_back(spectrum.s[i] / std::sqrt(nu));
    }
    return spectrum;
}

Curve StructureFactor::samples_curve(const char* name, Estimator estimator) const {
    const Shells shells = this->shells(estimator);
    Curve curve;
    curve.name = name;
    curve.title = fmt::format("Independent frames behind {}", symbol());
    curve.columns = {
        Column{"k", "1/a", "Wavevector k a", shells.k},
        Column{"samples", "-", "Independent frames", samples(shells, estimator)},
        Column{"modes", "-", "Independent modes", independent_modes(shells, estimator)},
        Column{"dof", "-", "Degrees of freedom", spectrum(estimator).dof}};
    return curve;
}

void StructureFactor::add_measurements(ObservableResult& result, Estimator best,
                                       const std::string& reason) const {
    const auto lowest = [&](const char* curve_name, const std::string& name, Estimator estimator) {
        const Curve* curve = result.find_curve(curve_name);
        if (curve == nullptr || curve->columns[0].values.empty()) return;
        const Shells shells = this->shells(estimator);
        const double s = curve->find("s")->values.front();
        const double error = curve->find("s_err")->values.front();
        const double independent =
            samples(shells, estimator).front() * independent_modes(shells, estimator).front();
        Measurement m{name, "-", s, std::nullopt, independent, reason};
        const auto also = [&m](const char* text) {
            m.reason += (m.reason.empty() ? "" : "; ") + std::string(text);
        };
        if (std::isfinite(error) && error > 0) {
            m.error = error;
            if (blocks_.size() < least_blocks && added_ > 1) {
                also("fewer than eight frames: error takes them as independent");
            }
        } else {
            also(error == 0 ? "the same in every frame: no error"
                 : drifts(shells, estimator).front().step_ratio < least_step_ratio
                     ? slower_than_the_run
                     : "too few frames and modes for an error");
        }
        result.measurements.push_back(m);
    };
    lowest("sk", "s_lowest_k", best);
    lowest("sk_raw", "s_raw_lowest_k", Estimator::raw);
    lowest("sk_neumann", "s_neumann_lowest_k", Estimator::neumann);
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
    if (shells(Estimator::raw).k.empty()) {
        result.reason =
            fmt::format("no wavevector of the grid lies in the annuli {}", edges_text(options_));
        return result;
    }
    const bool connected = added_ >= 2 && !box_.is_periodic();
    std::string reason;
    if (added_ < 2 && !box_.is_periodic()) {
        reason = "one frame: the mean density cannot be subtracted, raw estimator with walls in it";
    }
    const Estimator best = connected ? Estimator::connected : Estimator::raw;
    const char* method = connected        ? "connected"
                         : reason.empty() ? "raw"
                                          : "raw: one frame, walls included";
    result.curves.push_back(curve("sk", method, best));
    result.curves.push_back(curve("sk_raw", "raw", Estimator::raw));
    if (added_ >= 2 && has_neumann()) {
        result.curves.push_back(curve("sk_neumann", "modes of a walled box", Estimator::neumann));
    }
    if (added_ >= 2) result.curves.push_back(samples_curve("sk_samples", best));
    if (added_ >= 2 && has_neumann()) {
        result.curves.push_back(samples_curve("sk_neumann_samples", Estimator::neumann));
    }
    add_measurements(result, best, reason);
    if (components_ == 1) add_directions(result, best);
    return result;
}

}  // namespace grainfield::analysis
