#include "simulate/noise.h"

#include <array>
#include <cstddef>
#include <cstring>

#include "core/support/random.h"

// The order of these matters.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulate/noise.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace grainfield::simulate::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t blocks_per_group = 8;
constexpr std::size_t words_per_group = 4 * blocks_per_group;
constexpr std::size_t rounds = 10;

struct RoundKeys {
    explicit RoundKeys(const std::uint32_t* key) {
        for (std::uint32_t r = 0; r < rounds; ++r) {
            value[2 * r] = key[0] + r * 0x9E3779B9U;
            value[2 * r + 1] = key[1] + r * 0xBB67AE85U;
        }
    }
    std::array<std::uint64_t, 2 * rounds> value;
};

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE void philox_group(const std::uint64_t* keys, std::uint64_t step, std::uint32_t line,
                             std::uint32_t group, std::uint32_t* HWY_RESTRICT out) {
    for (std::uint32_t j = 0; j < blocks_per_group; ++j) {
        const auto block = philox_block(
            {group * std::uint32_t{blocks_per_group} + j, line,
             static_cast<std::uint32_t>(step & 0xFFFFFFFFU),
             static_cast<std::uint32_t>(step >> 32U)},
            {static_cast<std::uint32_t>(keys[0]), static_cast<std::uint32_t>(keys[1])});
        for (std::size_t i = 0; i < 2; ++i) {
            out[2 * j + i] = block[i];
            out[2 * blocks_per_group + 2 * j + i] = block[2 + i];
        }
    }
}
#else
// Eight blocks of Philox4x32-10 (`salmon2011`). Counters live in the low halves of 64-bit lanes;
// what gathers in the high halves never enters a product. Words 0, 1 of block j go to
// out[2 j], out[2 j + 1], words 2, 3 to out[16 + 2 j], out[17 + 2 j].
HWY_INLINE void philox_group(const std::uint64_t* keys, std::uint64_t step, std::uint32_t line,
                             std::uint32_t group, std::uint32_t* HWY_RESTRICT out) {
    const hn::CappedTag<std::uint64_t, blocks_per_group> d;
    const hn::Repartition<std::uint32_t, decltype(d)> d32;
    const auto m0 = hn::BitCast(d32, hn::Set(d, 0xD2511F53U));
    const auto m1 = hn::BitCast(d32, hn::Set(d, 0xCD9E8D57U));
    const auto low = hn::Set(d, 0xFFFFFFFFU);
    auto* wide = reinterpret_cast<std::uint64_t*>(out);
    constexpr std::size_t lanes = hn::MaxLanes(d);
    constexpr std::size_t at_once = blocks_per_group / lanes < 2 ? 1 : 2;  // hides the latency
    for (std::size_t j = 0; j < blocks_per_group; j += at_once * lanes) {
        hn::Vec<decltype(d)> c0[at_once], c1[at_once], c2[at_once], c3[at_once];
        for (std::size_t i = 0; i < at_once; ++i) {
            c0[i] = hn::Iota(d, std::uint64_t{group} * blocks_per_group + j + i * lanes);
            c1[i] = hn::Set(d, line);
            c2[i] = hn::Set(d, step & 0xFFFFFFFFU);
            c3[i] = hn::Set(d, step >> 32U);
        }
        for (std::size_t round = 0; round < rounds; ++round) {
            const auto k0 = hn::Set(d, keys[2 * round]);
            const auto k1 = hn::Set(d, keys[2 * round + 1]);
            for (std::size_t i = 0; i < at_once; ++i) {
                const auto p0 = hn::MulEven(hn::BitCast(d32, c0[i]), m0);
                const auto p1 = hn::MulEven(hn::BitCast(d32, c2[i]), m1);
                c0[i] = hn::Xor(hn::ShiftRight<32>(p1), hn::Xor(c1[i], k0));
                c2[i] = hn::Xor(hn::ShiftRight<32>(p0), hn::Xor(c3[i], k1));
                c1[i] = p1;
                c3[i] = p0;
            }
        }
        for (std::size_t i = 0; i < at_once; ++i) {
            auto* to = wide + j + i * lanes;
            hn::StoreU(hn::Or(hn::And(c0[i], low), hn::ShiftLeft<32>(c1[i])), d, to);
            hn::StoreU(hn::Or(hn::And(c2[i], low), hn::ShiftLeft<32>(c3[i])), d,
                       to + blocks_per_group);
        }
    }
}
#endif

// 64 numbers from 32 words: the low halves, then the high halves.
HWY_INLINE void uniform_group(const std::uint32_t* HWY_RESTRICT words, float* HWY_RESTRICT out) {
    const hn::CappedTag<float, 16> d;
    const hn::RebindToSigned<decltype(d)> di;
    const hn::RebindToUnsigned<decltype(d)> du;
    const auto low = hn::Set(du, 0xFFFFU);
    const auto scale = hn::Set(d, 5.2857997e-05F);  // sqrt(12/(2^32 − 1))
    const auto shift = hn::Set(d, -1.7320244F);     // −32767.5 · scale
    for (std::size_t i = 0; i < words_per_group; i += hn::Lanes(d)) {
        const auto w = hn::LoadU(du, words + i);
        const auto a = hn::ConvertTo(d, hn::BitCast(di, hn::And(w, low)));
        const auto b = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<16>(w)));
        hn::StoreU(hn::MulAdd(a, scale, shift), d, out + i);
        hn::StoreU(hn::MulAdd(b, scale, shift), d, out + words_per_group + i);
    }
}

// sin(2π x) for |x| ≤ 1/4 by the Taylor series to x^11: error < 6e-8.
template <class D, class V>
HWY_INLINE V sine_of_turns(D d, V x) {
    const V y = hn::Mul(x, hn::Set(d, 6.2831853071795865F));
    const V y2 = hn::Mul(y, y);
    V p = hn::Set(d, -2.5052108e-8F);
    p = hn::MulAdd(p, y2, hn::Set(d, 2.7557319e-6F));
    p = hn::MulAdd(p, y2, hn::Set(d, -1.9841270e-4F));
    p = hn::MulAdd(p, y2, hn::Set(d, 8.3333333e-3F));
    p = hn::MulAdd(p, y2, hn::Set(d, -1.6666667e-1F));
    return hn::MulAdd(hn::Mul(p, y2), y, y);
}

// Box–Muller: radii from words 0–15, angles from words 16–31.
HWY_INLINE void normal_group(const std::uint32_t* HWY_RESTRICT words, float* HWY_RESTRICT out) {
    const hn::CappedTag<float, 16> d;
    const hn::RebindToSigned<decltype(d)> di;
    const hn::RebindToUnsigned<decltype(d)> du;
    constexpr std::size_t half = words_per_group / 2;
    for (std::size_t i = 0; i < half; i += hn::Lanes(d)) {
        const auto w = hn::LoadU(du, words + i);
        const auto n = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<1>(w)));
        const auto u = hn::MulAdd(n, hn::Set(d, 0x1p-31F), hn::Set(d, 0x1p-32F));
        // u may round up to 1, for which Log might return a tiny positive number.
        const auto square = hn::Max(hn::Mul(hn::Set(d, -2.0F), hn::Log(d, u)), hn::Zero(d));
        const auto r = hn::Sqrt(square);
        const auto t = hn::Mul(hn::ConvertTo(d, hn::BitCast(di, hn::LoadU(du, words + half + i))),
                               hn::Set(d, 0x1p-32F));
        const auto at = hn::Abs(t);
        const auto quarter = hn::Set(d, 0.25F);
        const auto folded = hn::Min(at, hn::Sub(hn::Set(d, 0.5F), at));
        hn::StoreU(hn::Mul(r, sine_of_turns(d, hn::Sub(quarter, at))), d, out + i);
        hn::StoreU(hn::Mul(r, sine_of_turns(d, hn::CopySign(folded, t))), d, out + half + i);
    }
}

template <std::size_t per_group, class Convert>
HWY_INLINE void fill(const std::uint32_t* key, std::uint64_t step, std::uint32_t line, float* out,
                     std::size_t count, Convert convert) {
    const RoundKeys keys(key);
    alignas(64) std::array<std::uint32_t, words_per_group> words;
    std::uint32_t group = 0;
    std::size_t done = 0;
    for (; done + per_group <= count; done += per_group) {
        philox_group(keys.value.data(), step, line, group++, words.data());
        convert(words.data(), out + done);
    }
    if (done == count) return;
    alignas(64) std::array<float, per_group> last;
    philox_group(keys.value.data(), step, line, group, words.data());
    convert(words.data(), last.data());
    std::memcpy(out + done, last.data(), (count - done) * sizeof(float));
}

void fill_uniform(const std::uint32_t* key, std::uint64_t step, std::uint32_t line, float* out,
                  std::size_t count) {
    fill<64>(key, step, line, out, count, uniform_group);
}

void fill_normal(const std::uint32_t* key, std::uint64_t step, std::uint32_t line, float* out,
                 std::size_t count) {
    fill<32>(key, step, line, out, count, normal_group);
}

void fill_words(const std::uint32_t* key, std::uint64_t step, std::uint32_t line,
                std::uint32_t group, std::uint32_t* out) {
    philox_group(RoundKeys(key).value.data(), step, line, group, out);
}

}  // namespace grainfield::simulate::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::simulate {

HWY_EXPORT(fill_uniform);
HWY_EXPORT(fill_normal);
HWY_EXPORT(fill_words);

NoiseStream::NoiseStream(std::uint64_t seed, std::string_view name, std::uint64_t index) {
    RandomStream stream(seed, name, index);
    key_[0] = stream.bits();
    key_[1] = stream.bits();
}

void NoiseStream::uniform(std::uint64_t step, std::uint32_t line, std::span<float> out) const {
    HWY_DYNAMIC_DISPATCH(fill_uniform)(key_, step, line, out.data(), out.size());
}

void NoiseStream::normal(std::uint64_t step, std::uint32_t line, std::span<float> out) const {
    HWY_DYNAMIC_DISPATCH(fill_normal)(key_, step, line, out.data(), out.size());
}

void NoiseStream::words(std::uint64_t step, std::uint32_t line, std::uint32_t group,
                        std::span<std::uint32_t, 32> out) const {
    HWY_DYNAMIC_DISPATCH(fill_words)(key_, step, line, group, out.data());
}

}  // namespace grainfield::simulate
#endif
