#include "core/support/random.h"

#include <cmath>
#include <numbers>

// Random123's headers trip warnings that we hold ourselves to.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <Random123/philox.h>
#pragma GCC diagnostic pop

#include "core/errors.h"

namespace grainfield {

namespace {

// FNV-1a, then the finaliser of SplitMix64, so that similar names land far apart.
std::uint64_t scramble(std::uint64_t x) {
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
}

std::uint64_t hash(std::string_view name) {
    std::uint64_t h = 0xcbf29ce484222325U;
    for (const char c : name) {
        h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    }
    return scramble(h);
}

std::uint32_t low(std::uint64_t x) {
    return static_cast<std::uint32_t>(x & 0xffffffffU);
}

std::uint32_t high(std::uint64_t x) {
    return static_cast<std::uint32_t>(x >> 32U);
}

}  // namespace

std::array<std::uint32_t, 4> philox_block(const std::array<std::uint32_t, 4>& counter,
                                          const std::array<std::uint32_t, 2>& key) {
    const philox4x32_ctr_t c = {{counter[0], counter[1], counter[2], counter[3]}};
    const philox4x32_key_t k = {{key[0], key[1]}};
    const philox4x32_ctr_t r = philox4x32_R(10, c, k);
    return {r.v[0], r.v[1], r.v[2], r.v[3]};
}

RandomStream::RandomStream(std::uint64_t seed, std::string_view stream, std::uint64_t index) {
    // The name alone fixes an offset to which the index is added, so two indices of one name never
    // meet. Streams of two names meet with probability 2^-64 a pair.
    const std::uint64_t upper = scramble(hash(stream) + index);
    counter_ = {0, 0, low(upper), high(upper)};
    key_ = {low(seed), high(seed)};
}

void RandomStream::refill() {
    block_ = philox_block(counter_, key_);
    if (++counter_[0] == 0) ++counter_[1];
    used_ = 0;
}

std::uint32_t RandomStream::bits() {
    if (used_ == block_.size()) refill();
    return block_[used_++];
}

double RandomStream::uniform() {
    const std::uint64_t upper = bits() >> 5U;
    const std::uint64_t lower = bits() >> 6U;
    return static_cast<double>((upper << 26U) | lower) * 0x1p-53;
}

double RandomStream::uniform(double low_end, double high_end) {
    return low_end + (high_end - low_end) * uniform();
}

double RandomStream::normal() {
    if (has_spare_normal_) {
        has_spare_normal_ = false;
        return spare_normal_;
    }
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    const double angle = 2 * std::numbers::pi * uniform();
    spare_normal_ = radius * std::sin(angle);
    has_spare_normal_ = true;
    return radius * std::cos(angle);
}

std::uint64_t RandomStream::poisson(double mean) {
    if (!(mean >= 0) || !std::isfinite(mean)) {
        throw OptionError("the mean of a Poisson distribution must be finite and not negative.");
    }
    if (mean < 30) {
        const double limit = std::exp(-mean);
        std::uint64_t n = 0;
        for (double product = uniform(); product > limit; product *= uniform()) ++n;
        return n;
    }
    // Transformed rejection with squeeze, algorithm PTRS of Hörmann (`hoermann1993`).
    const double b = 0.931 + 2.53 * std::sqrt(mean);
    const double a = -0.059 + 0.02483 * b;
    const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
    const double v_r = 0.9277 - 3.6224 / (b - 2);
    const double log_mean = std::log(mean);
    while (true) {
        const double u = uniform() - 0.5;
        const double v = 1 - uniform();
        const double us = 0.5 - std::abs(u);
        const double k = std::floor((2 * a / us + b) * u + mean + 0.43);
        if (us >= 0.07 && v <= v_r) return static_cast<std::uint64_t>(k);
        if (k < 0 || (us < 0.013 && v > us)) continue;
        if (std::log(v * inverse_alpha / (a / (us * us) + b)) <=
            k * log_mean - mean - std::lgamma(k + 1)) {
            return static_cast<std::uint64_t>(k);
        }
    }
}

std::uint64_t RandomStream::below(std::uint64_t bound) {
    if (bound == 0) throw OptionError("a random integer below 0 does not exist.");
    const std::uint64_t remainder = (0 - bound) % bound;
    while (true) {
        const std::uint64_t upper = bits();
        const std::uint64_t draw = (upper << 32U) | bits();
        if (draw >= remainder) return draw % bound;
    }
}

}  // namespace grainfield
