#include "io/h5/field_log.h"

#include <utility>

namespace grainfield::io {

namespace {

constexpr std::size_t head_numbers = 8;

std::vector<double> flattened(const FieldFrame& frame) {
    const DensityField& first = frame.density.front();
    const bool has_order = !frame.order.value.empty();
    std::vector<double> numbers{static_cast<double>(frame.dimension),
                                static_cast<double>(first.nx),
                                static_cast<double>(first.ny),
                                first.spacing,
                                static_cast<double>(first.step),
                                first.time,
                                static_cast<double>(frame.density.size()),
                                frame.mean_diffusivity};
    numbers.push_back(has_order ? 1 : 0);
    for (const DensityField& field : frame.density) {
        numbers.insert(numbers.end(), field.value.begin(), field.value.end());
    }
    numbers.insert(numbers.end(), frame.order.value.begin(), frame.order.value.end());
    return numbers;
}

}  // namespace

void FieldLog::write(const FieldFrame& frame) {
    log_.append(flattened(frame));
}

FieldFrame FieldLog::read(std::int64_t index) {
    const std::vector<double> numbers = log_.read(index);
    if (numbers.size() < head_numbers + 1) log_.fail_reading("a field in it is damaged");
    FieldFrame frame;
    DensityField like;
    frame.dimension = static_cast<int>(numbers[0]);
    like.nx = static_cast<int>(numbers[1]);
    like.ny = static_cast<int>(numbers[2]);
    like.spacing = numbers[3];
    like.step = static_cast<std::int64_t>(numbers[4]);
    like.time = numbers[5];
    const auto replicas = static_cast<std::size_t>(numbers[6]);
    frame.mean_diffusivity = numbers[7];
    const bool has_order = numbers[8] != 0;
    const std::size_t cells = static_cast<std::size_t>(like.nx) * static_cast<std::size_t>(like.ny);
    if (numbers.size() != head_numbers + 1 + cells * (replicas + (has_order ? 1 : 0))) {
        log_.fail_reading("a field in it is damaged");
    }
    auto next = numbers.begin() + head_numbers + 1;
    const auto take = [&] {
        DensityField field = like;
        field.value.assign(next, next + static_cast<std::ptrdiff_t>(cells));
        next += static_cast<std::ptrdiff_t>(cells);
        return field;
    };
    for (std::size_t r = 0; r < replicas; ++r) frame.density.push_back(take());
    if (has_order) frame.order = take();
    return frame;
}

}  // namespace grainfield::io
