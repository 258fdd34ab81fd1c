#include "io/h5/detail/flat_columns.h"

#include <algorithm>

namespace grainfield::io {

std::vector<double> flat(const std::vector<Vec2>& column) {
    std::vector<double> numbers;
    numbers.reserve(2 * column.size());
    for (const Vec2& v : column) numbers.insert(numbers.end(), {v.x, v.y});
    return numbers;
}

std::vector<double> flat(const std::vector<Vec3>& column) {
    std::vector<double> numbers;
    numbers.reserve(3 * column.size());
    for (const Vec3& v : column) numbers.insert(numbers.end(), {v.x, v.y, v.z});
    return numbers;
}

std::vector<std::int8_t> flat(const std::vector<Layer>& column) {
    std::vector<std::int8_t> numbers(column.size());
    std::ranges::transform(column, numbers.begin(),
                           [](Layer layer) { return static_cast<std::int8_t>(layer); });
    return numbers;
}

std::vector<Vec2> vec2s(const std::vector<double>& numbers, std::size_t width) {
    std::vector<Vec2> column(numbers.size() / width);
    for (std::size_t i = 0; i < column.size(); ++i) {
        column[i] = {numbers[width * i], numbers[width * i + 1]};
    }
    return column;
}

std::vector<Vec3> vec3s(const std::vector<double>& numbers) {
    std::vector<Vec3> column(numbers.size() / 3);
    for (std::size_t i = 0; i < column.size(); ++i) {
        column[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
    }
    return column;
}

std::vector<Layer> layers(const std::vector<std::int8_t>& numbers) {
    std::vector<Layer> column(numbers.size());
    std::ranges::transform(numbers, column.begin(), [](std::int8_t number) {
        return number == 0 || number == 1 ? static_cast<Layer>(number) : Layer::unknown;
    });
    return column;
}

}  // namespace grainfield::io
