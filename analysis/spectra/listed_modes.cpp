#include "analysis/spectra/listed_modes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t least_blocks = 8;
constexpr std::size_t most_wavevectors = std::size_t{1} << 20;

}  // namespace

ListedModes::ListedModes(std::vector<Vec2> wavevectors, const Box& box, std::int64_t frames,
                         std::int64_t first)
    : wavevectors_(std::move(wavevectors)), box_(box), plan_(BlockPlan::of(frames)), first_(first) {
    if (wavevectors_.size() > most_wavevectors) {
        throw OptionError(ErrorText{"too many wavevectors are listed",
                                    fmt::format("{}", wavevectors_.size()),
                                    fmt::format("at most {}", most_wavevectors),
                                    "a full grid up to sk.k-max is faster for so many"});
    }
    for (const Vec2& k : wavevectors_) {
        if (is_finite(k)) continue;
        throw OptionError(ErrorText{"a listed wavevector is not usable",
                                    fmt::format("({}, {})", k.x, k.y), "finite numbers", ""});
    }
    blocks_.assign(static_cast<std::size_t>(plan_.blocks), empty_block());
}

ListedModes::Block ListedModes::empty_block() const {
    Block block;
    block.rho.assign(wavevectors_.size(), {0, 0});
    block.power.assign(wavevectors_.size(), 0);
    return block;
}

ListedModes::Sample ListedModes::measure(const Pattern& pattern) const {
    Sample sample{static_cast<double>(pattern.size()), {}};
    sample.rho.reserve(wavevectors_.size());
    for (const Vec2& k : wavevectors_) {
        double re = 0;
        double im = 0;
        for (const Vec2& p : pattern.position) {
            const double phase = dot(k, p - pattern.box.origin);
            re += std::cos(phase);
            im -= std::sin(phase);
        }
        sample.rho.emplace_back(re, im);
    }
    return sample;
}

void ListedModes::add(Sample sample) {
    Block& block = blocks_[static_cast<std::size_t>(plan_.block_of(first_ + added_++))];
    block.frames += 1;
    block.particles += sample.particles;
    for (std::size_t m = 0; m < sample.rho.size(); ++m) {
        block.rho[m] += sample.rho[m];
        block.power[m] += std::norm(sample.rho[m]);
    }
}

void ListedModes::merge(const ListedModes& later) {
    if (later.wavevectors_.size() != wavevectors_.size()) {
        throw InputError(ErrorText{"the parts to merge have different lists of wavevectors",
                                   fmt::format("{}", later.wavevectors_.size()),
                                   fmt::format("{}", wavevectors_.size()), ""});
    }
    const auto add_block = [](Block& to, const Block& from) {
        to.frames += from.frames;
        to.particles += from.particles;
        for (std::size_t m = 0; m < to.rho.size(); ++m) {
            to.rho[m] += from.rho[m];
            to.power[m] += from.power[m];
        }
    };
    const std::int64_t end = first_ + added_;
    added_ += later.added_;
    if (are_cut_alike(plan_, end, later.plan_, later.first_)) {
        for (std::size_t b = 0; b < blocks_.size(); ++b) add_block(blocks_[b], later.blocks_[b]);
        return;
    }
    plan_.frames = std::max(plan_.frames, added_);
    blocks_.insert(blocks_.end(), later.blocks_.begin(), later.blocks_.end());
    std::erase_if(blocks_, [](const Block& block) { return block.frames <= 0; });
    blocks_ = joined_blocks(std::move(blocks_), add_block);
    if (blocks_.empty()) blocks_.push_back(empty_block());
    plan_.blocks = static_cast<int>(blocks_.size());
}

void ListedModes::save(Checkpoint& checkpoint, const std::string& prefix) const {
    checkpoint.integers[prefix + "added"] = {added_};
    std::vector<double>& sums = checkpoint.reals[prefix + "sums"];
    for (const Block& block : blocks_) {
        sums.insert(sums.end(), {block.frames, block.particles});
        for (const auto& rho : block.rho) sums.insert(sums.end(), {rho.real(), rho.imag()});
        sums.insert(sums.end(), block.power.begin(), block.power.end());
    }
}

void ListedModes::restore(const Checkpoint& checkpoint, const std::string& prefix) {
    const auto sums = checkpoint.reals.find(prefix + "sums");
    const auto added = checkpoint.integers.find(prefix + "added");
    if (sums == checkpoint.reals.end() || added == checkpoint.integers.end() ||
        added->second.size() != 1 ||
        sums->second.size() != (2 + 3 * wavevectors_.size()) * blocks_.size()) {
        throw InputError(ErrorText{"stored sums of listed wavevectors do not fit",
                                   "another number of wavevectors or blocks", "",
                                   "measure the part again"});
    }
    added_ = added->second[0];
    const double* next = sums->second.data();
    for (Block& block : blocks_) {
        block.frames = *next++;
        block.particles = *next++;
        for (auto& rho : block.rho) {
            rho = {next[0], next[1]};
            next += 2;
        }
        for (double& power : block.power) power = *next++;
    }
}

ListedModes::Block ListedModes::total(std::optional<std::size_t> without) const {
    Block sums = empty_block();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        if (without == b) continue;
        sums.frames += blocks_[b].frames;
        sums.particles += blocks_[b].particles;
        for (std::size_t m = 0; m < sums.rho.size(); ++m) {
            sums.rho[m] += blocks_[b].rho[m];
            sums.power[m] += blocks_[b].power[m];
        }
    }
    return sums;
}

// K blocks that hold frames, var(frame)/var(block mean) of them in each. Of one block of several it
// is not known: all its frames count as one.
double ListedModes::independent_frames(const Block& sums, std::size_t mode) const {
    const auto k = static_cast<double>(
        std::ranges::count_if(blocks_, [](const Block& block) { return block.frames > 0; }));
    if (sums.frames <= k) return sums.frames;
    if (k < 2) return blocks_.size() > 1 ? k : sums.frames;
    const std::complex<double> mean = sums.rho[mode] / sums.frames;
    double of_blocks = 0;
    for (const Block& block : blocks_) {
        if (block.frames > 0)
            of_blocks += std::norm(block.rho[mode] / block.frames - mean) / (k - 1);
    }
    const double of_frames = sums.power[mode] / sums.frames - std::norm(mean);
    return of_blocks > 0 ? std::clamp(k * of_frames / of_blocks, k, sums.frames) : sums.frames;
}

double ListedModes::value(const Block& sums, std::size_t mode, bool is_connected,
                          double independent) const {
    const double particles = sums.particles / sums.frames;
    if (!is_connected) return sums.power[mode] / sums.frames / particles;
    // Leaving a block out leaves that share of the independent frames out.
    const double left = independent * sums.frames / static_cast<double>(added_);
    const double s =
        (sums.power[mode] / sums.frames - std::norm(sums.rho[mode] / sums.frames)) / particles;
    return left > 1 ? s * left / (left - 1) : undefined;
}

std::optional<double> ListedModes::error(std::span<const Block> left_out, std::size_t mode,
                                         bool is_connected, double s, double independent) const {
    if (left_out.empty()) {
        const double nu = static_cast<double>(added_) - (is_connected ? 1 : 0);
        if (!(nu > 2)) return std::nullopt;
        return s * std::sqrt((nu + 2) / ((nu - 1) * (nu - 2)));
    }
    std::vector<double> left;
    for (const Block& sums : left_out) {
        left.push_back(value(sums, mode, is_connected, independent));
    }
    const auto spread = student_jackknife_error(left, least_blocks);
    if (!spread || !(*spread > 1e-13 * std::abs(s))) return std::nullopt;
    return spread;
}

// As StructureFactor::drifts: of the vectors within a fifth in |k|.
std::vector<BlockDrift> ListedModes::drifts() const {
    std::vector<double> frames;
    for (const Block& block : blocks_) {
        if (block.frames > 0) frames.push_back(block.frames);
    }
    struct Vector {
        double k = 0;
        BlockScatter scatter;
    };
    std::vector<Vector> of_each;
    for (std::size_t m = 0; m < wavevectors_.size(); ++m) {
        of_each.push_back({norm(wavevectors_[m]), {}});
        std::vector<std::complex<double>> means;
        for (const Block& block : blocks_) {
            if (block.frames > 0) means.push_back(block.rho[m] / block.frames);
        }
        add_scatter<std::complex<double>>(of_each[m].scatter, frames, means);
    }
    // By |k|, so that each looks at its neighbours only.
    std::vector<std::size_t> order(of_each.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t m) { return std::pair(of_each[m].k, m); });
    std::vector<BlockDrift> drifts(of_each.size());
    std::size_t first = 0;
    std::size_t last = 0;
    BlockScatter near;
    for (const std::size_t m : order) {
        while (last < order.size() && of_each[order[last]].k <= of_each[m].k * std::exp(0.2)) {
            near.squares += of_each[order[last]].scatter.squares;
            near.steps += of_each[order[last]].scatter.steps;
            ++last;
        }
        while (of_each[order[first]].k < of_each[m].k * std::exp(-0.2)) {
            near.squares -= of_each[order[first]].scatter.squares;
            near.steps -= of_each[order[first]].scatter.steps;
            ++first;
        }
        drifts[m] = block_drift(near, frames.size());
    }
    return drifts;
}

void ListedModes::add_to(ObservableResult& sk) const {
    const Block sums = total(std::nullopt);
    if (wavevectors_.empty() || !(sums.particles > 0)) return;
    const bool is_connected = added_ >= 2 && !box_.is_periodic();
    Curve curve{"sk_list",
                is_connected ? "Structure factor at the listed wavevectors, connected"
                             : "Structure factor at the listed wavevectors, raw",
                {{"kx", "1/a", "Wavevector k_x a", {}},
                 {"ky", "1/a", "Wavevector k_y a", {}},
                 {"s", "-", "S(k)", {}},
                 {"s_err", "-", "Standard error of S(k)", {}},
                 {"s_raw", "-", "S(k), raw", {}}},
                {}};
    std::vector<Block> left_out;
    for (std::size_t b = 0; blocks_.size() >= least_blocks && b < blocks_.size(); ++b) {
        if (blocks_[b].frames > 0) left_out.push_back(total(b));
    }
    const std::vector<BlockDrift> drifts = this->drifts();
    const auto filled = static_cast<double>(
        std::ranges::count_if(blocks_, [](const Block& block) { return block.frames > 0; }));
    for (std::size_t m = 0; m < wavevectors_.size(); ++m) {
        // Where the scatter of blocks is not what tells it, the frames themselves: one more than
        // that.
        const double more = sums.frames <= filled || filled < 2 ? 1 : 0;
        const double independent = frames_of_mean(independent_frames(sums, m) - more, drifts[m]);
        const double s = value(sums, m, is_connected, independent);
        curve.columns[0].values.push_back(wavevectors_[m].x);
        curve.columns[1].values.push_back(wavevectors_[m].y);
        curve.columns[2].values.push_back(s);
        curve.columns[3].values.push_back(
            drifts[m].step_ratio < least_step_ratio
                ? undefined
                : error(left_out, m, is_connected, s, independent).value_or(undefined));
        curve.columns[4].values.push_back(value(sums, m, false, independent));
    }
    sk.curves.push_back(std::move(curve));
}

}  // namespace grainfield::analysis
