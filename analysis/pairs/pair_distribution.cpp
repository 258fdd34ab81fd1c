#include "analysis/pairs/pair_distribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "analysis/geometry/neighbours.h"
#include "core/errors.h"

namespace grainfield::analysis {
namespace {

constexpr std::int64_t most_stored = 1'000'000'000'000;

// Less a strip along walls.
Box window_of(Box box, double border) {
    for (const auto& [boundary, axis] :
         {std::pair(box.boundary[0], &Vec2::x), std::pair(box.boundary[1], &Vec2::y)}) {
        if (boundary == Boundary::periodic) continue;
        box.origin.*axis += border;
        box.length.*axis -= 2 * border;
    }
    return box;
}

double border_of(const PairDistributionOptions& options, const Box& box) {
    if (options.border) return *options.border;
    return std::min(10.0, 0.1 * std::min(box.length.x, box.length.y));
}

// A/A_w(s): what walls cut off of the pairs this far apart.
double wall_weight(const Box& box, Vec2 s) {
    const double x =
        box.boundary[0] == Boundary::walls ? box.length.x - std::abs(s.x) : box.length.x;
    const double y =
        box.boundary[1] == Boundary::walls ? box.length.y - std::abs(s.y) : box.length.y;
    return box.area() / (x * y);
}

bool is_inside(const Box& box, Vec2 p, double border) {
    const auto along = [border](Boundary boundary, double x, double length) {
        return boundary == Boundary::periodic || (x >= border && x <= length - border);
    };
    return along(box.boundary[0], p.x - box.origin.x, box.length.x) &&
           along(box.boundary[1], p.y - box.origin.y, box.length.y);
}

template <class Number>
void add_each(std::vector<Number>& to, const std::vector<Number>& from) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
}

// Pairs of particles that stand exactly above each other, which the cells leave out.
template <class Visit>
void visit_columns(const std::vector<Vec2>& position, const Visit& visit) {
    std::vector<std::size_t> order(position.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {},
                      [&](std::size_t i) { return std::pair(position[i].x, position[i].y); });
    for (std::size_t a = 0; a < order.size(); ++a) {
        for (std::size_t b = a + 1; b < order.size(); ++b) {
            if (!(position[order[a]] == position[order[b]])) break;
            visit(order[a], order[b]);
        }
    }
}

// Σ over ordered pairs i ≠ j of π max(0, r² − (z_i − z_j)²); z ascending.
class DiscAreas {
 public:
    explicit DiscAreas(std::vector<double> z) : z_(std::move(z)) {
        std::ranges::sort(z_);
        // About a height nearby, so that nothing cancels.
        const double middle = z_[z_.size() / 2];
        for (double& h : z_) {
            h -= middle;
            sum_ += h;
            squares_ += h * h;
        }
    }

    double within(double r) const {
        const auto n = static_cast<double>(z_.size());
        if (r > z_.back() - z_.front()) {  // no pair is left out
            return std::numbers::pi * (n * (n - 1) * r * r - 2 * (n * squares_ - sum_ * sum_));
        }
        double sum = 0, squares = 0, area = 0;  // of those below i by less than r
        std::size_t first = 0;
        for (std::size_t i = 0; i < z_.size(); ++i) {
            const double h = z_[i];
            for (; h - z_[first] >= r; ++first) {
                sum -= z_[first];
                squares -= z_[first] * z_[first];
            }
            area += static_cast<double>(i - first) * (r * r - h * h) + 2 * h * sum - squares;
            sum += h;
            squares += h * h;
        }
        return 2 * std::numbers::pi * area;
    }

 private:
    std::vector<double> z_;
    double sum_ = 0, squares_ = 0;
};

}  // namespace

OptionTable describe(PairDistributionOptions& options) {
    OptionTable table("gr");
    table.number("range", options.range, "a", {0.1, 1e4},
                 "largest distance of a pair; at most half the box");
    table.number("bin", options.bin, "a", {1e-4, 10}, "width of the bins");
    table.number("border", options.border, "a", {0, 1e6},
                 "strip left free along walls; auto: 10, at most a tenth of the box");
    table.number("contact", options.contact, "a", {0.1, 10},
                 "spheres whose centres are nearer in space count as touching");
    table.integer("most-frames", options.frames, "", {0, 1'000'000'000},
                  "most frames that are used, evenly spread; 0: all");
    return table;
}

void PairDistribution::Sums::add(const Sums& more) {
    add_each(weight, more.weight);
    add_each(expected, more.expected);
    add_each(pairs, more.pairs);
}

std::int64_t PairDistribution::stride(const PairDistributionOptions& options, std::int64_t frames) {
    if (options.frames == 0) return 1;
    return std::max<std::int64_t>(1, (frames + options.frames - 1) / options.frames);
}

PairDistribution::PairDistribution(const PairDistributionOptions& options, const Box& box,
                                   std::int64_t frames, std::int64_t first)
    : options_(options),
      box_(box),
      window_(window_of(box, border_of(options, box))),
      plan_(BlockPlan::of(frames)),
      first_(first),
      stride_(stride(options, frames)) {
    const double side = std::min(window_.length.x, window_.length.y);
    const double range = std::max(0.0, std::min(options.range, 0.5 * side));
    bins_ = static_cast<std::size_t>(std::floor(range / options.bin * (1 + 1e-12)));
    if (bins_ > 100'000) {
        throw OptionError(ErrorText{"too many bins of the pair distribution",
                                    fmt::format("{}", bins_), "100,000 at most",
                                    "take a smaller gr.range or a larger gr.bin"});
    }
    blocks_.assign(static_cast<std::size_t>(plan_.blocks), empty_block());
}

PairDistribution::Block PairDistribution::empty_block() const {
    Block block;
    for (Sums* sums : {&block.plane, &block.space}) {
        sums->weight.assign(bins_, 0);
        sums->expected.assign(bins_, 0);
        sums->pairs.assign(bins_, 0);
    }
    block.spheres_with.assign(most_contacts + 1, 0);
    return block;
}

PairDistribution::Sample PairDistribution::measure(const Pattern& pattern,
                                                   std::int64_t ordinal) const {
    const Vec2 change = pattern.box.length - box_.length;
    if (std::abs(change.x) > 1e-9 * box_.length.x || std::abs(change.y) > 1e-9 * box_.length.y) {
        throw InputError(
            ErrorText{fmt::format("the box changes at frame {}", pattern.frame),
                      fmt::format("{} x {} a", pattern.box.length.x, pattern.box.length.y),
                      fmt::format("{} x {} a as before", box_.length.x, box_.length.y),
                      "analyse the parts with a constant box one by one"});
    }
    if (ordinal % stride_ != 0 || bins_ == 0) return {};
    Sample sample = empty_block();
    sample.frames = 1;
    Box window = window_;
    window.origin += pattern.box.origin - box_.origin;
    std::vector<double> known;
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        if (!is_inside(window, pattern.position[i], 0)) continue;
        sample.particles += 1;
        if (!pattern.z.empty() && !std::isnan(pattern.z[i])) known.push_back(pattern.z[i]);
    }
    sample.known = static_cast<double>(known.size());
    count(pattern, window, sample);
    expect(std::vector<double>(static_cast<std::size_t>(sample.particles), 0), window.area(),
           sample.plane);
    expect(std::move(known), window.area(), sample.space);
    return sample;
}

// Each pair once, for the plane and, where both heights are known, for space.
void PairDistribution::count(const Pattern& pattern, const Box& window, Sample& sample) const {
    const bool has_heights = !pattern.z.empty();
    const double range = static_cast<double>(bins_) * options_.bin;
    const double reach = has_heights ? std::max(range, options_.contact) : range;
    std::vector<std::int64_t> contacts(has_heights ? pattern.size() : 0, 0);
    std::vector<bool> is_too_near(contacts.size(), false);
    std::vector<char> is_in(pattern.size());
    for (std::size_t i = 0; i < is_in.size(); ++i) {
        is_in[i] = is_inside(window, pattern.position[i], 0) ? 1 : 0;
    }
    const auto enter = [&](Sums& sums, double r, double weight) {
        const auto bin = static_cast<std::size_t>(r / options_.bin);
        if (bin >= bins_) return;
        sums.weight[bin] += 2 * weight;
        ++sums.pairs[bin];
    };
    const auto enter_pair = [&](std::size_t i, std::size_t j, Vec2 d, double r2) {
        const bool counts = is_in[i] != 0 && is_in[j] != 0;
        const double weight = counts ? wall_weight(window, d) : 0;
        if (counts) enter(sample.plane, std::sqrt(r2), weight);
        if (!has_heights) return;
        const double h = pattern.z[j] - pattern.z[i];
        if (std::isnan(h)) return;
        const double r = std::sqrt(r2 + h * h);
        if (counts) enter(sample.space, r, weight);
        if (r >= options_.contact) return;
        ++contacts[i];
        ++contacts[j];
        if (r < too_near) is_too_near[i] = is_too_near[j] = true;
    };
    const CellList cells(pattern.position, pattern.box);
    NeighbourList near;
    for (const int i : cells.order()) {
        cells.within(i, reach, near);
        for (const Neighbour& other : near) {
            if (other.index < i) continue;
            enter_pair(static_cast<std::size_t>(i), static_cast<std::size_t>(other.index), other.d,
                       other.r2);
        }
    }
    visit_columns(pattern.position, [&](std::size_t i, std::size_t j) {
        enter_pair(i, j, {0, 0}, 0);
    });
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (std::isnan(pattern.z[i])) continue;
        if (is_in[i] == 0 || !is_inside(pattern.box, pattern.position[i], options_.contact))
            continue;
        ++sample.spheres_with[std::min(static_cast<std::size_t>(contacts[i]), most_contacts)];
        sample.contacts += contacts[i];
        sample.too_near += is_too_near[i] ? 1 : 0;
    }
}

void PairDistribution::expect(std::vector<double> z, double area, Sums& sums) const {
    if (z.size() < 2) return;
    const DiscAreas discs(std::move(z));
    double within = 0;
    for (std::size_t bin = 0; bin < bins_; ++bin) {
        const double further = discs.within(static_cast<double>(bin + 1) * options_.bin);
        sums.expected[bin] = (further - within) / area;
        within = further;
    }
}

void PairDistribution::add(const Sample& sample) {
    Block& block = blocks_[static_cast<std::size_t>(plan_.block_of(first_ + added_++))];
    if (sample.frames > 0) add_block(block, sample);
}

void PairDistribution::add_block(Block& to, const Block& from) {
    to.frames += from.frames;
    to.particles += from.particles;
    to.known += from.known;
    to.plane.add(from.plane);
    to.space.add(from.space);
    add_each(to.spheres_with, from.spheres_with);
    to.contacts += from.contacts;
    to.too_near += from.too_near;
}

void PairDistribution::merge(const PairDistribution& later) {
    if (later.bins_ != bins_ || later.window_.length != window_.length) {
        throw InputError(ErrorText{"the parts to merge have different boxes or bins", "", "",
                                   "analyse them one by one"});
    }
    const std::int64_t end = first_ + added_;
    added_ += later.added_;
    if (are_cut_alike(plan_, end, later.plan_, later.first_)) {
        for (std::size_t b = 0; b < blocks_.size(); ++b) add_block(blocks_[b], later.blocks_[b]);
        return;
    }
    plan_.frames = std::max(plan_.frames, added_);
    blocks_.insert(blocks_.end(), later.blocks_.begin(), later.blocks_.end());
    blocks_ = joined_blocks(std::move(blocks_), add_block);
    if (blocks_.empty()) blocks_.push_back(empty_block());
    plan_.blocks = static_cast<int>(blocks_.size());
}

void PairDistribution::save(Checkpoint& checkpoint, const std::string& prefix) const {
    std::vector<double>& reals = checkpoint.reals[prefix + "sums"];
    std::vector<std::int64_t>& counts = checkpoint.integers[prefix + "counts"];
    counts = {added_};
    for (const Block& block : blocks_) {
        reals.insert(reals.end(), {block.particles, block.known});
        counts.insert(counts.end(), {block.frames, block.too_near, block.contacts});
        counts.insert(counts.end(), block.spheres_with.begin(), block.spheres_with.end());
        for (const Sums* sums : {&block.plane, &block.space}) {
            reals.insert(reals.end(), sums->weight.begin(), sums->weight.end());
            reals.insert(reals.end(), sums->expected.begin(), sums->expected.end());
            counts.insert(counts.end(), sums->pairs.begin(), sums->pairs.end());
        }
    }
}

void PairDistribution::restore(const Checkpoint& checkpoint, const std::string& prefix) {
    const auto reals = checkpoint.reals.find(prefix + "sums");
    const auto counts = checkpoint.integers.find(prefix + "counts");
    // So that sums over all parts stay exact.
    const auto is_bad = [](std::int64_t count) { return count < 0 || count > most_stored; };
    if (reals == checkpoint.reals.end() || counts == checkpoint.integers.end() ||
        reals->second.size() != blocks_.size() * (2 + 4 * bins_) ||
        counts->second.size() != 1 + blocks_.size() * (4 + most_contacts + 2 * bins_) ||
        std::ranges::any_of(counts->second, is_bad) ||
        !std::ranges::all_of(reals->second, [](double sum) { return sum >= 0 && sum < 1e300; })) {
        throw InputError(ErrorText{"stored sums of the pair distribution do not fit",
                                   "another number of bins or blocks, or no sums", "",
                                   "measure the part again"});
    }
    auto real = reals->second.begin();
    auto count = counts->second.begin();
    added_ = *count++;
    for (Block& block : blocks_) {
        block.particles = *real++;
        block.known = *real++;
        block.frames = *count++;
        block.too_near = *count++;
        block.contacts = *count++;
        for (std::int64_t& number : block.spheres_with) number = *count++;
        for (Sums* sums : {&block.plane, &block.space}) {
            for (double& sum : sums->weight) sum = *real++;
            for (double& sum : sums->expected) sum = *real++;
            for (std::int64_t& number : sums->pairs) number = *count++;
        }
    }
}

PairDistribution::Block PairDistribution::total() const {
    Block all = empty_block();
    for (const Block& block : blocks_) add_block(all, block);
    return all;
}

}  // namespace grainfield::analysis
