#include "analysis/spectra/structure_factor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::analysis {
namespace {

double step_of(WaveGrid grid, double length, Boundary boundary) {
    const bool full =
        grid == WaveGrid::two_pi || (grid == WaveGrid::automatic && boundary == Boundary::periodic);
    return (full ? 2 : 1) * std::numbers::pi / length;
}

Vec2 spacing_of(const StructureFactorOptions& options, const Box& box) {
    return {step_of(options.grid, box.length.x, box.boundary[0]),
            step_of(options.grid, box.length.y, box.boundary[1])};
}

// The wavevector limit, once the sums over it are sure to fit into the memory.
double affordable(const StructureFactorOptions& options, const Box& box, int blocks) {
    constexpr double most_bytes = 2e9;
    constexpr double per_mode = 56;
    const double modes = ModeGrid::about(spacing_of(options, box), options.k_max);
    const double bytes = modes * per_mode * blocks;
    if (bytes < most_bytes) return options.k_max;
    throw OptionError(ErrorText{
        fmt::format("S(k) up to sk.k-max = {:.4g} /a needs too much memory", options.k_max),
        fmt::format("{:.2g} wavevectors, {:.2g} GB", modes, bytes / 1e9),
        fmt::format("at most {:.2g} GB", most_bytes / 1e9),
        fmt::format("lower sk.k-max to {:.2g} or less",
                    options.k_max * std::sqrt(most_bytes / bytes))});
}

// Throws OptionError unless there are none, or two or more that ascend from zero or more.
const std::vector<double>& checked_edges(const StructureFactorOptions& options) {
    const std::vector<double>& edges = options.edges;
    const bool is_usable =
        edges.size() != 1 && std::ranges::is_sorted(edges, std::less_equal{}) &&
        std::ranges::all_of(edges, [](double edge) { return std::isfinite(edge) && edge >= 0; });
    if (is_usable) return edges;
    throw OptionError(ErrorText{
        "the edges of the annuli of |k| are not usable", "'" + edges_text(options) + "'",
        "two or more numbers in 1/a that ascend from 0 or more", "for example 0.05,0.1,0.2,0.4"});
}

bool same_length(double a, double b) {
    return std::abs(a - b) <= 1e-9 * std::max(a, b);
}

}  // namespace

OptionTable describe(StructureFactorOptions& options, const std::string& section) {
    OptionTable table(section);
    table.number("k-max", options.k_max, "1/a", {1e-9, 1e9}, "largest wavevector");
    table.choice(
        "grid", options.grid,
        {{"auto", WaveGrid::automatic}, {"two-pi", WaveGrid::two_pi}, {"pi", WaveGrid::pi}},
        "wavevectors 2 pi n/L or pi n/L; auto: by boundary");
    table.number("shell-width", options.shell_width, "1/a", {1e-12, 1e9},
                 "width of the isotropic average; auto: distinct |k| first, then the grid step");
    table.numbers("edges", options.edges, "1/a", {.minimum = 0},
                  "edges of annuli of |k|, as 0.05,0.1,0.2, to average over instead; or empty",
                  {.minimum = 2});
    return table;
}

std::string edges_text(const StructureFactorOptions& options) {
    StructureFactorOptions copy = options;
    return to_text(describe(copy).row_of(&copy.edges).get());
}

StructureFactor::StructureFactor(const StructureFactorOptions& options, const Box& box,
                                 std::int64_t frames, std::int64_t first)
    : options_(options),
      box_(box),
      plan_(BlockPlan::of(frames)),
      edges_(checked_edges(options)),
      grid_(spacing_of(options, box), affordable(options, box, plan_.blocks)),
      transform_(std::make_shared<DensityTransform>(grid_)),
      first_(first) {
    const auto& modes = grid_.modes();
    const bool walls = box.boundary[0] == Boundary::walls && box.boundary[1] == Boundary::walls;
    const bool half_steps = same_length(grid_.spacing().x, std::numbers::pi / box.length.x) &&
                            same_length(grid_.spacing().y, std::numbers::pi / box.length.y);
    neumann_index_.assign(modes.size(), nowhere);
    for (std::size_t m = 0; walls && half_steps && m < modes.size(); ++m) {
        if (modes[m].nx == 0 || modes[m].ny <= 0) continue;
        neumann_index_[m] = neumann_modes_.size();
        neumann_modes_.push_back(m);
    }
    blocks_.assign(static_cast<std::size_t>(plan_.blocks), empty_block());
}

StructureFactor::Block StructureFactor::empty_block() const {
    Block block;
    block.rho.assign(components_ * grid_.modes().size(), {0, 0});
    block.power.assign(grid_.modes().size(), 0);
    block.cosine.assign(neumann_modes_.size(), 0);
    block.cosine2.assign(neumann_modes_.size(), 0);
    return block;
}

std::string StructureFactor::method(std::size_t particles) const {
    return fmt::format(
        "{} wavevectors by {}", grid_.modes().size(),
        transform_->is_direct(particles) ? "direct sums" : "a non-uniform Fourier transform");
}

double StructureFactor::particles_mean() const {
    double frames = 0;
    double particles = 0;
    for (const Block& block : blocks_) {
        frames += block.frames;
        particles += block.particles;
    }
    return frames > 0 ? particles / frames : 0;
}

bool StructureFactor::has_neumann() const {
    return !neumann_modes_.empty();
}

StructureFactor StructureFactor::of_order(const StructureFactorOptions& options, const Box& box,
                                          std::int64_t frames, std::int64_t first) {
    StructureFactor order(options, box, frames, first);
    order.components_ = 2;
    order.neumann_modes_.clear();
    order.blocks_.assign(order.blocks_.size(), order.empty_block());
    return order;
}

void StructureFactor::require_same_box(const Pattern& pattern) const {
    if (!same_length(pattern.box.length.x, box_.length.x) ||
        !same_length(pattern.box.length.y, box_.length.y)) {
        throw InputError(
            ErrorText{fmt::format("the box changes at frame {}", pattern.frame),
                      fmt::format("{} x {} a", pattern.box.length.x, pattern.box.length.y),
                      fmt::format("{} x {} a as before", box_.length.x, box_.length.y),
                      "analyse the parts with a constant box one by one"});
    }
}

StructureFactor::Sample StructureFactor::measure(const Pattern& pattern) const {
    require_same_box(pattern);
    return {static_cast<double>(pattern.size()),
            transform_->modes(pattern.position, {}, pattern.box.origin, grid_)};
}

StructureFactor::Sample StructureFactor::measure(
    const Pattern& pattern, std::span<const std::complex<double>> order) const {
    require_same_box(pattern);
    std::vector<double> real(order.size(), 0.0);
    std::vector<double> imaginary(order.size(), 0.0);
    double particles = 0;
    for (std::size_t j = 0; j < order.size(); ++j) {
        if (!std::isfinite(order[j].real()) || !std::isfinite(order[j].imag())) continue;
        real[j] = order[j].real();
        imaginary[j] = order[j].imag();
        particles += 1;
    }
    const std::array<std::span<const double>, 2> parts{real, imaginary};
    return {particles, transform_->modes(pattern.position, parts, pattern.box.origin, grid_)};
}

void StructureFactor::add(Sample sample) {
    Block& block = blocks_[static_cast<std::size_t>(plan_.block_of(first_ + added_++ / replicas_))];
    block.frames += 1;
    block.particles += sample.particles;
    const std::size_t modes = grid_.modes().size();
    for (std::size_t first = 0; first < sample.rho.size(); first += modes) {
        for (std::size_t m = 0; m < modes; ++m) {
            block.rho[first + m] += sample.rho[first + m];
            block.power[m] += std::norm(sample.rho[first + m]);
        }
    }
    for (std::size_t c = 0; c < neumann_modes_.size(); ++c) {
        const Mode& mode = grid_.modes()[neumann_modes_[c]];
        // cos a cos b = (cos(a + b) + cos(a − b)) / 2
        const double cosine = 0.5 * (sample.rho[neumann_modes_[c]].real() +
                                     sample.rho[grid_.index(mode.nx, -mode.ny)].real());
        block.cosine[c] += cosine;
        block.cosine2[c] += cosine * cosine;
    }
}

void StructureFactor::merge(const StructureFactor& later) {
    if (later.grid_.modes().size() != grid_.modes().size() || later.components_ != components_) {
        throw InputError(ErrorText{"the parts to merge have different wavevectors",
                                   fmt::format("{} modes", later.grid_.modes().size()),
                                   fmt::format("{}", grid_.modes().size()), ""});
    }
    const std::int64_t end = first_ + added_;
    added_ += later.added_;
    if (are_cut_alike(plan_, end, later.plan_, later.first_)) {
        for (std::size_t b = 0; b < blocks_.size(); ++b) add_block(blocks_[b], later.blocks_[b], 1);
        return;
    }
    plan_.frames = std::max(plan_.frames, added_);
    blocks_.insert(blocks_.end(), later.blocks_.begin(), later.blocks_.end());
    blocks_ = joined_blocks(std::move(blocks_),
                            [](Block& to, const Block& from) { add_block(to, from, 1); });
    if (blocks_.empty()) blocks_.push_back(empty_block());
    plan_.blocks = static_cast<int>(blocks_.size());
}

}  // namespace grainfield::analysis
