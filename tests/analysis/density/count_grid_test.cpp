#include "analysis/density/count_grid.h"

#include <gtest/gtest.h>

#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

// Counts every window point by point.
WindowSums brute_force(const CountGrid& grid, const std::vector<Vec2>& points, const Box& box,
                       int m) {
    WindowSums sums;
    const int nx = grid.periodic[0] ? grid.cells[0] : grid.cells[0] - m + 1;
    const int ny = grid.periodic[1] ? grid.cells[1] : grid.cells[1] - m + 1;
    for (int iy = 0; iy < ny; ++iy) {
        for (int ix = 0; ix < nx; ++ix) {
            const Vec2 low{grid.origin.x + ix * grid.cell.x, grid.origin.y + iy * grid.cell.y};
            const Vec2 high{grid.origin.x + (ix + m) * grid.cell.x,
                            grid.origin.y + (iy + m) * grid.cell.y};
            std::int64_t count = 0;
            for (Vec2 p : points) {
                for (int sx = 0; sx <= (grid.periodic[0] ? 1 : 0); ++sx) {
                    for (int sy = 0; sy <= (grid.periodic[1] ? 1 : 0); ++sy) {
                        const Vec2 q = p + Vec2{sx * box.length.x, sy * box.length.y};
                        count += q.x >= low.x && q.x < high.x && q.y >= low.y && q.y < high.y;
                    }
                }
            }
            sums.sum += count;
            sums.squares += count * count;
        }
    }
    return sums;
}

TEST(CountGrid, HasWindowSumsEqualToCountingEveryWindow) {
    RandomStream random(1, "windows");
    for (const Boundary bx : {Boundary::walls, Boundary::periodic}) {
        for (const Boundary by : {Boundary::walls, Boundary::periodic}) {
            const Box box{{2, -3}, {8, 6}, {bx, by}, 0};
            const std::vector<Vec2> points = poisson_points(100, box, random);
            const CountGrid grid(box, 0.25, 0.5);
            const WindowCounter counter(grid, grid.count(points), 20);
            for (int m = 1; m <= 20; ++m) {
                const WindowSums truth = brute_force(grid, points, box, m);
                const WindowSums sums = counter.sums(m);
                EXPECT_TRUE(sums.sum == truth.sum) << m;
                EXPECT_TRUE(sums.squares == truth.squares) << m;
            }
        }
    }
}

TEST(CountGrid, GivesPointsOnGridLinesToTheUpperCell) {
    const CountGrid grid(square_box(4, Boundary::walls), 0.25, 0);
    std::vector<Vec2> points;
    for (int i = 0; i < 16; ++i) points.push_back({0.25 * i, 0.25 * i});
    const auto contents = grid.count(points);
    for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(contents[i * 16 + i], 1);
}

TEST(CountGrid, LeavesTheBorderFreeAndCentresItself) {
    const CountGrid grid(square_box(100, Boundary::walls), 0.25, 10);
    EXPECT_EQ(grid.cells[0], 320);
    EXPECT_DOUBLE_EQ(grid.origin.x, 10);
    EXPECT_TRUE(grid.fits(320));
    EXPECT_FALSE(grid.fits(321));
    EXPECT_EQ(grid.positions(320), 1);
    const auto contents = grid.count(std::vector<Vec2>{{5, 50}, {50, 95}, {50, 50}});
    EXPECT_EQ(std::accumulate(contents.begin(), contents.end(), 0), 1);
}

TEST(CountGrid, OfABoxSmallerThanItsBordersIsEmpty) {
    const CountGrid grid(square_box(10, Boundary::walls), 0.25, 10);
    EXPECT_FALSE(grid.fits(1));
    EXPECT_EQ(grid.size(), 0U);
}

// 32,767 points in all are counted in 16 bits, one more in 32; all of them in one cell is the most
// that a window can hold.
TEST(CountGrid, IsExactOnBothSidesOfTheLimitOfNarrowNumbers) {
    RandomStream random(3, "narrow");
    for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
        const CountGrid grid(Box{{0, 0}, {45, 23}, {boundary, boundary}, 0}, 1, 0);
        for (const std::int32_t points : {32767, 32768}) {
            for (const bool crowded : {false, true}) {
                std::vector<std::int32_t> contents(grid.size(), 0);
                for (std::int32_t p = 0; p < points; ++p) {
                    const double place = static_cast<double>(grid.size()) * random.uniform();
                    ++contents[crowded ? 500 : static_cast<std::size_t>(place)];
                }
                const WindowCounter counter(grid, contents, 23);
                for (const int m : {1, 2, 7, 16, 22, 23}) {
                    Wide sum = 0;
                    Wide squares = 0;
                    const bool wraps = boundary == Boundary::periodic;
                    for (int y = 0; y < (wraps ? 23 : 24 - m); ++y) {
                        for (int x = 0; x < (wraps ? 45 : 46 - m); ++x) {
                            Wide content = 0;
                            for (int cell = 0; cell < m * m; ++cell) {
                                const int row = (y + cell / m) % 23;
                                const int column = (x + cell % m) % 45;
                                content += contents[static_cast<std::size_t>(45 * row + column)];
                            }
                            sum += content;
                            squares += content * content;
                        }
                    }
                    EXPECT_TRUE(counter.sums(m).sum == sum) << m;
                    EXPECT_TRUE(counter.sums(m).squares == squares) << m;
                }
            }
        }
    }
}

TEST(CountGrid, StaysExactForHugeContents) {
    // Content 1e6 in each of 8 × 8 cells: squares of window contents of 6.4e7 need more than the
    // 53 bits of a double.
    const CountGrid grid(square_box(8), 1, 0);
    std::vector<std::int32_t> contents(64, 1000000);
    contents[5] += 1;
    const WindowCounter counter(grid, contents, 8);
    const WindowSums whole = counter.sums(8);
    const Wide all = 64000001;
    EXPECT_TRUE(whole.sum == 64 * all);
    EXPECT_TRUE(whole.squares == 64 * all * all);
    const WindowSums single = counter.sums(1);
    EXPECT_TRUE(single.squares == Wide{63} * 1000000 * 1000000 + Wide{1000001} * 1000001);
}

}  // namespace
}  // namespace grainfield::analysis
