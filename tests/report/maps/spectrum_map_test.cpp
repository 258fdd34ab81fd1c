#include "report/maps/spectrum_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using ::testing::HasSubstr;

Results run_with_map() {
    Results run;
    run.label = "run";
    ObservableResult sk;
    sk.name = "sk";
    Curve map{"sk_map", "", {{"kx", "1/a", "", {}}, {"ky", "1/a", "", {}}, {"s", "-", "", {}}}, {}};
    for (int nx = 0; nx <= 3; ++nx) {
        for (int ny = nx == 0 ? 1 : -3; ny <= 3; ++ny) {
            map.columns[0].values.push_back(0.1 * nx);
            map.columns[1].values.push_back(0.1 * ny);
            map.columns[2].values.push_back(0.01 * (1 + nx * nx + ny * ny));
        }
    }
    sk.curves = {map};
    run.observables = {sk};
    return run;
}

TEST(SpectrumMap, DrawsBothHalfPlanes) {
    const std::string svg = spectrum_map_svg(run_with_map(), "<run>");
    EXPECT_THAT(svg, HasSubstr("<svg"));
    EXPECT_THAT(svg, HasSubstr("&lt;run&gt;"));
    std::size_t squares = 0;
    for (auto at = svg.find('M'); at != std::string::npos; at = svg.find('M', at + 1)) ++squares;
    EXPECT_EQ(squares, 2U * (3 + 3 * 7));
}

TEST(SpectrumMap, IsEmptyWithoutPositiveValues) {
    EXPECT_EQ(spectrum_map_svg(Results{}, "run"), "");
    Results zero = run_with_map();
    for (double& s : zero.observables[0].curves[0].columns[2].values) s = 0;
    EXPECT_EQ(spectrum_map_svg(zero, "run"), "");
}

}  // namespace
}  // namespace grainfield::report
