#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace grainfield {

/// The bijection behind the streams: Philox4x32 with 10 rounds (`salmon2011`), 128 random bits for
/// each counter and key.
std::array<std::uint32_t, 4> philox_block(const std::array<std::uint32_t, 4>& counter,
                                          const std::array<std::uint32_t, 2>& key);

/// Counter-based random numbers: Philox4x32-10 (Salmon et al. 2011, `salmon2011`).
///
/// A stream is named by (seed, stream name, index): "the read noise of frame 17". Streams are
/// statistically independent. The n-th number of a stream does not depend on any other stream or
/// thread, so results are the same for any number of threads.
///
/// Period 2^66 numbers a stream. Not thread-safe; make one per thread or per row, it costs nothing.
class RandomStream {
 public:
    RandomStream(std::uint64_t seed, std::string_view stream, std::uint64_t index = 0);

    std::uint32_t bits();  ///< 32 uniform bits
    double uniform();      ///< in [0, 1), 53 bits
    double uniform(double low, double high);
    double normal();  ///< mean 0, variance 1 (Box–Muller)
    /// Product of uniforms for mean < 30, transformed rejection (`hoermann1993`) above; throws
    /// OptionError if the mean is negative or not finite.
    std::uint64_t poisson(double mean);
    std::uint64_t below(std::uint64_t bound);  ///< unbiased integer in [0, bound)

 private:
    void refill();

    std::array<std::uint32_t, 4> counter_;
    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> block_{};
    unsigned used_ = 4;
    double spare_normal_ = 0;
    bool has_spare_normal_ = false;
};

}  // namespace grainfield
