// A layer whose S(k) is put in, filmed, tracked and analysed by the program: what the film and the
// tracker add to S(k) and to S0/S1 is small beside the errors that are quoted.

#include "tests/support/known_spectrum.h"

#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/h5/trajectory_file.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using testing::run_grainfield;

void write_layer(const std::string& path, int frames) {
    testing::KnownSpectrumOptions options;
    options.side = 24;
    options.liquids = 2;
    options.melt = 20;
    options.wanted = {.s0 = 0.05, .s1 = 1, .alpha = 1, .peak = 0.6, .cut = 0.8};
    testing::KnownSpectrumLayer layer(options);
    TrajectoryInfo info;
    info.origin = Origin::md;
    info.diameter_origin = DiameterOrigin::simulated;
    io::TrajectoryWriter writer(path, info, Overwrite::force);
    for (int f = 0; f < frames; ++f) {
        const testing::SlitScene scene = layer.next();
        Snapshot s;
        s.frame = f;
        s.time = f;
        s.box = {
            {0, 0}, {options.side, options.side}, {Boundary::walls, Boundary::walls}, scene.height};
        s.position = scene.position;
        for (const double z : scene.z) s.z.push_back(z + 0.5);
        writer.write(s);
    }
    writer.finish({});
}

struct Numbers {
    double particles = 0, ratio = 0, error = 0, lowest = 0;
};

Numbers analysed(const std::string& positions, const std::string& output) {
    const testing::Outcome outcome =
        run_grainfield({"analyze", positions, "--observables", "sk,fit", "--alpha", "1",
                        "--fit-k-max", "0.6", "--sk-k-max", "0.8", "-o", output, "--json"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const json summary = json::parse(outcome.out);
    Numbers numbers;
    numbers.particles = summary["particles_mean"];
    std::map<std::string, json> measured;
    for (const char* observable : {"sk", "fit"}) {
        for (const json& m : summary[observable]["measurements"]) measured[m["name"]] = m;
    }
    numbers.ratio = measured["s0_over_s1"]["value"];
    numbers.error = measured["s0_over_s1"]["error"];
    numbers.lowest = measured["s_neumann_lowest_k"]["value"];
    return numbers;
}

TEST(KnownSpectrum, ComesBackFromAFilmOfIt) {
    const testing::ScratchFolder folder;
    write_layer(folder / "layer.h5", 24);
    ASSERT_EQ(run_grainfield({"render", folder / "layer.h5", "--width", "240", "--height", "240",
                              "--frame-rate", "10", "--sub-frames", "1", "-o", folder / "film",
                              "--truth", folder / "truth.h5"})
                  .code,
              0);
    ASSERT_EQ(run_grainfield(
                  {"track", folder / "film", "--sphere-diameter", "10", "-o", folder / "tracks.h5"})
                  .code,
              0);
    const Numbers truth = analysed(folder / "truth.h5", folder / "truth-results.h5");
    const Numbers tracked = analysed(folder / "tracks.h5", folder / "tracked-results.h5");
    EXPECT_NEAR(tracked.particles, truth.particles, 0.005 * truth.particles);
    // A share p of spheres missed at random adds p to S; of .5 % that is a tenth of S(k_min) here.
    EXPECT_NEAR(tracked.lowest, truth.lowest, 0.1 * truth.lowest + 0.01);
    EXPECT_NEAR(tracked.ratio, truth.ratio, 0.5 * truth.error);
    EXPECT_NEAR(truth.ratio, 0.05, 4 * truth.error);
}

}  // namespace
}  // namespace grainfield
