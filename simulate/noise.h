#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace grainfield::simulate {

/// Names a stream of lattice noise: (seed, name). Streams of two names or seeds are independent.
class NoiseStream {
 public:
    NoiseStream(std::uint64_t seed, std::string_view name, std::uint64_t index = 0);

    /// Fills `out` with independent numbers of mean 0 and variance 1, which depend on the stream,
    /// `step`, `line` and the position in `out` only: neither on threads nor on the width of the
    /// machine's vectors.
    ///
    /// Philox4x32-10 (`salmon2011`), counter = (block, line, step). `uniform`: 16-bit uniform
    /// numbers, symmetric about 0, of variance exactly 1 (n = 2^16 levels of spacing
    /// sqrt(12/(n² − 1))), extent ± sqrt(3): for equations that are linear in the noise it gives
    /// the same second moments as a Gaussian at a third of the cost. `normal`: Box–Muller with
    /// 31-bit radius and 32-bit angle, |x| < 6.6, polynomial sine of error < 1e-7.
    void uniform(std::uint64_t step, std::uint32_t line, std::span<float> out) const;
    void normal(std::uint64_t step, std::uint32_t line, std::span<float> out) const;

    /// The 32-bit words behind group `group` of 32 numbers (normal) or 64 (uniform), for tests.
    void words(std::uint64_t step, std::uint32_t line, std::uint32_t group,
               std::span<std::uint32_t, 32> out) const;

 private:
    std::uint32_t key_[2];
};

}  // namespace grainfield::simulate
