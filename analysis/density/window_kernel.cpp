#include "analysis/density/window_kernel.h"

#include <algorithm>

// The order of these matters.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/density/window_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace grainfield::analysis::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

NarrowSums sums_of_windows(const NarrowTable& table, std::size_t m, std::size_t columns,
                           std::size_t rows, std::size_t /*steps_between*/) {
    NarrowSums sums;
    for (std::size_t y = 0; y < rows; ++y) {
        const std::uint16_t* low = table.value + y * table.stride;
        const std::uint16_t* high = low + m * table.stride;
        for (std::size_t x = 0; x < columns; ++x) {
            const std::uint64_t content =
                static_cast<std::uint16_t>((high[x + m] - high[x]) - (low[x + m] - low[x]));
            sums.sum += content;
            sums.squares += content * content;
        }
    }
    return sums;
}

#else

using Narrow = hn::ScalableTag<std::int16_t>;
using Middle = hn::RepartitionToWide<Narrow>;
using Words = hn::RebindToUnsigned<hn::RepartitionToWide<Middle> >;
constexpr std::size_t lanes = hn::MaxLanes(Narrow());
static_assert(lanes <= NarrowTable::padding);

// Numbers of 32 bits without sign, two a lane, added to sums of 64 bits.
HWY_INLINE hn::Vec<Words> widened(hn::Vec<Words> sums, hn::Vec<Middle> part) {
    const Words d;
    const auto pairs = hn::BitCast(d, part);
    return hn::Add(sums, hn::Add(hn::ShiftRight<32>(pairs),
                                 hn::And(pairs, hn::Set(d, std::uint64_t{0xffffffff}))));
}

HWY_INLINE hn::Vec<Narrow> load(const std::uint16_t* from) {
    return hn::BitCast(Narrow(), hn::LoadU(hn::RebindToUnsigned<Narrow>(), from));
}

NarrowSums sums_of_windows(const NarrowTable& table, std::size_t m, std::size_t columns,
                           std::size_t rows, std::size_t steps_between) {
    const Narrow d;
    const auto ones = hn::Set(d, std::int16_t{1});
    auto sum = hn::Zero(Words());
    auto squares = hn::Zero(Words());
    const std::size_t steps = (columns + lanes - 1) / lanes;
    const auto tail = hn::FirstN(d, columns - (steps - 1) * lanes);
    for (std::size_t y = 0; y < rows; ++y) {
        const std::uint16_t* low = table.value + y * table.stride;
        const std::uint16_t* high = low + m * table.stride;
        for (std::size_t step = 0; step < steps;) {
            const std::size_t end = std::min(steps, step + steps_between);
            // Which half of the products comes where depends on the instruction set.
            auto part = hn::Zero(Middle());
            auto part_rest = hn::Zero(Middle());
            auto part_squares = hn::Zero(Middle());
            auto rest_squares = hn::Zero(Middle());
            for (; step < end; ++step) {
                const std::size_t x = step * lanes;
                auto content = hn::Sub(hn::Sub(load(high + x + m), load(high + x)),
                                       hn::Sub(load(low + x + m), load(low + x)));
                if (step + 1 == steps) content = hn::IfThenElseZero(tail, content);
                part = hn::ReorderWidenMulAccumulate(Middle(), content, ones, part, part_rest);
                part_squares = hn::ReorderWidenMulAccumulate(Middle(), content, content,
                                                             part_squares, rest_squares);
            }
            sum = widened(widened(sum, part), part_rest);
            squares = widened(widened(squares, part_squares), rest_squares);
        }
    }
    return {hn::GetLane(hn::SumOfLanes(Words(), sum)),
            hn::GetLane(hn::SumOfLanes(Words(), squares))};
}

#endif

}  // namespace grainfield::analysis::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace grainfield::analysis {

HWY_EXPORT(sums_of_windows);

NarrowSums window_sums(const NarrowTable& table, std::size_t m, std::size_t columns,
                       std::size_t rows, std::uint32_t largest) {
    if (columns == 0 || rows == 0) return {};
    // Each step adds two squares to numbers of 32 bits.
    const std::uint64_t square = std::max<std::uint64_t>(1, std::uint64_t{largest} * largest);
    const std::uint64_t steps = std::clamp<std::uint64_t>(0xffffffffU / (2 * square), 1, 1 << 14);
    return HWY_DYNAMIC_DISPATCH(sums_of_windows)(table, m, columns, rows,
                                                 static_cast<std::size_t>(steps));
}

}  // namespace grainfield::analysis

#endif  // HWY_ONCE
