#include "core/support/number_archive.h"

#include <bit>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/support/snapshot_numbers.h"

namespace grainfield {
namespace {

Snapshot sample() {
    Snapshot s;
    s.frame = 7;
    s.time = 0.1;
    s.box = {.origin = {-0.5, -0.5}, .length = {640, 480}, .height = 1.94};
    s.box.boundary = {Boundary::periodic, Boundary::walls};
    s.position = {{1.0 / 3, -0.0}, {std::numeric_limits<double>::denorm_min(), 2}};
    s.id = {1, (std::int64_t{1} << 53) - 1};
    s.position_error = {{std::numeric_limits<double>::quiet_NaN(), 0.1}, {0.2, 0.3}};
    s.z_error = {0.03, 0.04};
    s.quality = {0.01, 0.02};
    s.layer = {Layer::unknown, Layer::top};
    return s;
}

TEST(NumberArchive, GivesEveryBitOfASnapshotBack) {
    Snapshot saved = sample();
    NumberArchive in;
    in(saved);
    const std::vector<double> numbers = in.take_numbers();
    NumberArchive out(numbers);
    Snapshot s;
    s.velocity = {{1, 2, 3}};
    out(s);
    out.require_end();
    EXPECT_EQ(s.frame, saved.frame);
    EXPECT_EQ(s.box, saved.box);
    EXPECT_EQ(s.position, saved.position);
    EXPECT_TRUE(std::signbit(s.position[0].y));
    EXPECT_EQ(s.id, saved.id);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(s.position_error[0].x),
              std::bit_cast<std::uint64_t>(saved.position_error[0].x));
    EXPECT_EQ(s.z_error, saved.z_error);
    EXPECT_EQ(s.layer, saved.layer);
    EXPECT_TRUE(s.velocity.empty());
}

TEST(NumberArchive, RefusesTooFewAndTooManyNumbers) {
    Snapshot saved = sample();
    NumberArchive in;
    in(saved);
    std::vector<double> numbers = in.take_numbers();
    numbers.push_back(0);
    NumberArchive long_one(numbers);
    Snapshot s;
    long_one(s);
    EXPECT_THROW(long_one.require_end(), InputError);
    for (std::size_t n = 0; n + 1 < numbers.size(); ++n) {
        const std::vector<double> part(numbers.begin(),
                                       numbers.begin() + static_cast<std::ptrdiff_t>(n));
        NumberArchive short_one(part);
        EXPECT_THROW(short_one(s), InputError) << n;
    }
}

template <class T>
T restored(double number) {
    const std::vector<double> numbers{number};
    NumberArchive archive(numbers);
    T value{};
    archive(value);
    return value;
}

TEST(NumberArchive, RefusesNumbersThatAreNotOfTheType) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    for (const double number : {0.5, 1e300, -1e19, 9007199254740994.0, inf, -inf, std::nan("")}) {
        EXPECT_THROW(restored<std::int64_t>(number), InputError) << number;
        EXPECT_THROW(restored<std::size_t>(number), InputError) << number;
        EXPECT_THROW(restored<Layer>(number), InputError) << number;
        EXPECT_THROW(restored<bool>(number), InputError) << number;
    }
    EXPECT_THROW(restored<std::size_t>(-1), InputError);
    EXPECT_THROW(restored<int>(2147483648.0), InputError);
    EXPECT_THROW(restored<bool>(2), InputError);
    EXPECT_THROW(restored<float>(1e39), InputError);
    EXPECT_EQ(restored<int>(-2147483648.0), std::numeric_limits<int>::lowest());
    EXPECT_EQ(restored<Layer>(-1), Layer::unknown);
    EXPECT_EQ(restored<float>(inf), std::numeric_limits<float>::infinity());
}

}  // namespace
}  // namespace grainfield
