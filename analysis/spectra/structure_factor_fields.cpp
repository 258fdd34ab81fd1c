#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "analysis/spectra/structure_factor.h"
#include "core/errors.h"
#include "core/support/fourier.h"

// What the structure factor needs to take fields, and to go on after a checkpoint.

namespace grainfield::analysis {
namespace {

RealFourier2D<double>& transform_of(int nx, int ny) {
    thread_local RealFourier2D<double> transform(1, 1);
    if (transform.nx() != nx || transform.ny() != ny) transform = RealFourier2D<double>(nx, ny);
    return transform;
}

std::vector<double> numbers(const Checkpoint& checkpoint, const std::string& name,
                            std::size_t count) {
    const auto found = checkpoint.reals.find(name);
    if (found != checkpoint.reals.end() && found->second.size() == count) return found->second;
    throw InputError({.problem = fmt::format("the checkpoint does not fit: '{}'", name),
                      .actual = found == checkpoint.reals.end()
                                    ? "it is missing"
                                    : fmt::format("{} numbers", found->second.size()),
                      .expected = fmt::format("{} numbers", count),
                      .suggestion = "begin the run anew"});
}

}  // namespace

StructureFactor StructureFactor::of_field(const StructureFactorOptions& options,
                                          const DensityField& field, const BlockPlan& instants,
                                          std::int64_t replicas) {
    StructureFactorOptions capped = options;
    capped.k_max = std::min(options.k_max, std::numbers::pi / field.spacing * (1 + 1e-12));
    StructureFactor sk(capped, field.box(), instants.frames);
    sk.counts_particles_ = false;
    sk.replicas_ = replicas;
    sk.plan_ = instants;
    sk.blocks_.assign(static_cast<std::size_t>(instants.blocks), sk.empty_block());
    return sk;
}

void StructureFactor::lengthen(const BlockPlan& plan) {
    blocks_ = lengthened_blocks(blocks_, plan_, plan, empty_block(),
                                [](Block& to, const Block& from) { add_block(to, from, 1); });
    plan_ = plan;
}

StructureFactor::Sample StructureFactor::measure(const DensityField& field, int dimension) const {
    const Box box = field.box();
    if (std::abs(box.length.x - box_.length.x) > 1e-9 * box_.length.x ||
        std::abs(box.length.y - box_.length.y) > 1e-9 * box_.length.y) {
        throw InputError({.problem = fmt::format("the lattice changes at step {}", field.step),
                          .actual = fmt::format("{} x {}", box.length.x, box.length.y),
                          .expected = fmt::format("{} x {}", box_.length.x, box_.length.y),
                          .suggestion = "analyse the parts one by one"});
    }
    RealFourier2D<double>& transform = transform_of(field.nx, field.ny);
    std::ranges::copy(field.value, transform.real().begin());
    transform.forward();
    const double cell = dimension == 1 ? field.spacing : field.spacing * field.spacing;
    const std::size_t columns = static_cast<std::size_t>(field.nx) / 2 + 1;
    Sample sample;
    sample.particles = cell * static_cast<double>(field.size());
    sample.rho.reserve(grid_.modes().size());
    for (const Mode& mode : grid_.modes()) {
        const auto row = static_cast<std::size_t>((mode.ny + field.ny) % field.ny);
        sample.rho.push_back(
            cell * transform.complex()[row * columns + static_cast<std::size_t>(mode.nx)]);
    }
    return sample;
}

void StructureFactor::save(Checkpoint& checkpoint, const std::string& prefix) const {
    checkpoint.integers[prefix + "added"] = {added_};
    std::vector<double>& sums = checkpoint.reals[prefix + "sums"];
    for (const Block& block : blocks_) {
        sums.insert(sums.end(), {block.frames, block.particles});
        for (const auto& rho : block.rho) sums.insert(sums.end(), {rho.real(), rho.imag()});
        for (const auto* list : {&block.power, &block.cosine, &block.cosine2}) {
            sums.insert(sums.end(), list->begin(), list->end());
        }
    }
}

void StructureFactor::restore(const Checkpoint& checkpoint, const std::string& prefix) {
    const Block& like = blocks_.front();
    const std::size_t in_block =
        2 + 2 * like.rho.size() + like.power.size() + 2 * like.cosine.size();
    const auto sums = numbers(checkpoint, prefix + "sums", in_block * blocks_.size());
    const auto added = checkpoint.integers.find(prefix + "added");
    if (added == checkpoint.integers.end() || added->second.size() != 1) {
        throw InputError(fmt::format("the checkpoint does not fit: '{}added' is missing.", prefix));
    }
    const double* next = sums.data();
    for (Block& block : blocks_) {
        block.frames = *next++;
        block.particles = *next++;
        for (auto& rho : block.rho) {
            rho = {next[0], next[1]};
            next += 2;
        }
        for (auto* list : {&block.power, &block.cosine, &block.cosine2}) {
            for (double& value : *list) value = *next++;
        }
    }
    added_ = added->second[0];
}

}  // namespace grainfield::analysis
