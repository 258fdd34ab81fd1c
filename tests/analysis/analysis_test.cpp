#include "analysis/analysis.h"

#include <bit>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/order/bond_order.h"
#include "analysis/spectra/fit_result.h"
#include "analysis/spectra/structure_factor.h"
#include "core/errors.h"
#include "core/stored_trajectory.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

// A walled box in pixels, 8 px a diameter: half crystal, half gas, all in slow random motion.
MemorySource video(int frames, bool linked = true) {
    MemorySource source;
    source.description.origin = Origin::video;
    source.description.length_unit = LengthUnit::pixel;
    source.description.time_unit = TimeUnit::second;
    source.description.diameter = 8;
    RandomStream random(11, "video");
    const Box box = square_box(320, Boundary::walls);
    std::vector<Vec2> home;
    for (int iy = 0; iy < 40; ++iy) {
        for (int ix = 0; ix < 20; ++ix) home.push_back({4 + 8.0 * ix, 4 + 8.0 * iy});
    }
    for (int i = 0; i < 600; ++i) {
        home.push_back({160 + 160 * random.uniform(), 320 * random.uniform()});
    }
    for (int f = 0; f < frames; ++f) {
        Snapshot s;
        s.frame = f;
        s.time = 0.1 * f;
        s.box = box;
        s.position = home;
        for (std::size_t i = 0; i < home.size(); ++i) {
            if (i >= 800) home[i] += 0.3 * Vec2{random.normal(), random.normal()};
            s.position[i] += 0.2 * Vec2{random.normal(), random.normal()};
        }
        s.z.assign(home.size(), 4 + 0.4 * std::sin(0.7 * f));
        if (linked) s.id = identities(home.size());
        source.snapshots.push_back(std::move(s));
    }
    return source;
}

std::vector<ObservableResult> run(MemorySource& source, const AnalysisOptions& options = {},
                                  int threads = 1, RunPlan* plan_out = nullptr) {
    RunPlan plan;
    Results results = measure(source, options, {.threads = threads, .plan = &plan});
    if (plan_out != nullptr) *plan_out = plan;
    return results.observables;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
    }
    return true;
}

TEST(Analysis, GivesTheSameBitsForOneTwoAndEightThreads) {
    MemorySource source = video(21);
    const auto one = run(source, {}, 1);
    for (int threads : {2, 8}) {
        const auto many = run(source, {}, threads);
        ASSERT_EQ(one.size(), many.size());
        for (std::size_t o = 0; o < one.size(); ++o) {
            ASSERT_EQ(one[o].measurements.size(), many[o].measurements.size());
            for (std::size_t m = 0; m < one[o].measurements.size(); ++m) {
                EXPECT_EQ(one[o].measurements[m].value, many[o].measurements[m].value);
                EXPECT_EQ(one[o].measurements[m].error, many[o].measurements[m].error);
            }
            for (std::size_t c = 0; c < one[o].curves.size(); ++c) {
                for (std::size_t k = 0; k < one[o].curves[c].columns.size(); ++k) {
                    EXPECT_TRUE(same_bits(one[o].curves[c].columns[k].values,
                                          many[o].curves[c].columns[k].values))
                        << one[o].curves[c].name;
                }
            }
        }
    }
}

TEST(Analysis, OfALinkedVideoMeasuresAllObservables) {
    MemorySource source = video(40);
    const auto results = run(source);
    ASSERT_EQ(results.size(), 10U);
    for (const ObservableResult& r : results) {
        // Nothing here has a pre-peak.
        const std::string why = r.name == "fit" ? why_no_fit(r) : r.reason;
        EXPECT_EQ(why.empty(), r.name != "fit") << r.name << ": " << why;
    }
    const Measurement* spacing = results[0].find_measurement("lattice_spacing");
    EXPECT_NEAR(*spacing->value, 1, 0.01);
    // The crystal, and those of the gas that look square by chance (four random directions have
    // |Q4| > 0.7 with probability exp(-4 · 0.49) = 0.14, fewer more often).
    const double solid = *results[1].find_measurement("solid_fraction")->value;
    EXPECT_GT(solid, 780.0 / 1400);
    EXPECT_LT(solid, (800 + 0.35 * 600) / 1400);
    EXPECT_TRUE(results[2].find_measurement("d_solid")->value.has_value());
    EXPECT_NE(results[3].find_curve("sk_neumann"), nullptr);
    EXPECT_NEAR(*results[5].find_measurement("number_density")->value, 1400.0 / 1600, 1e-12);
}

// Four frames are a window of 0.4 s; a fifth one stands alone in the next.
TEST(Analysis, LeavesAShortLastWindowOutOfPhasesAndClusters) {
    MemorySource whole = video(4);
    MemorySource with_rest = video(5);
    const ObservableResult a = run(whole)[1];
    const ObservableResult b = run(with_rest)[1];
    ASSERT_EQ(b.name, "phase");
    for (const char* name : {"solid_fraction", "largest_cluster", "cluster_size"}) {
        ASSERT_TRUE(a.find_measurement(name)->value.has_value()) << name;
        EXPECT_EQ(*a.find_measurement(name)->value, *b.find_measurement(name)->value) << name;
    }
    EXPECT_EQ(b.find_curve("phase")->find("t")->values.size(), 1U);
}

TEST(Analysis, TakesATrajectoryInMemoryWithNothingElseGiven) {
    MemorySource source = video(6);
    const Trajectory trajectory{source.description, source.snapshots};
    StoredTrajectory stored(trajectory);
    const Results of_trajectory = measure(trajectory);
    const Results of_stored = measure(stored);
    EXPECT_EQ(of_trajectory.frames, 6);
    EXPECT_EQ(of_trajectory.particles_mean, 1400);
    EXPECT_EQ(of_trajectory.box, source.snapshots[0].box);
    EXPECT_EQ(of_trajectory.source.diameter, 8);
    ASSERT_EQ(of_trajectory.observables.size(), 10U);
    const auto q4_mean = [](const Results& results) {
        return *results.find("q4")->find_measurement("q4_mean")->value;
    };
    EXPECT_EQ(q4_mean(of_trajectory), q4_mean(of_stored));
}

TEST(Analysis, NeverHasAValueThatIsNotANumberNorAMissingOneWithoutReason) {
    for (int frames : {0, 1, 2, 5}) {
        for (bool linked : {true, false}) {
            MemorySource source = video(frames, linked);
            for (const ObservableResult& r : run(source)) {
                if (r.measurements.empty()) {
                    EXPECT_NE(r.reason, "") << r.name;
                }
                for (const Measurement& m : r.measurements) {
                    if (m.value) {
                        EXPECT_TRUE(std::isfinite(*m.value)) << m.name;
                    }
                    if (m.error) {
                        EXPECT_TRUE(std::isfinite(*m.error)) << m.name;
                    }
                    if (!m.value || !m.error) {
                        EXPECT_NE(m.reason, "") << m.name << frames;
                    }
                }
                for (const Curve& c : r.curves) {
                    for (const Column& column : c.columns) {
                        EXPECT_EQ(column.values.size(), c.columns[0].values.size());
                    }
                }
            }
        }
    }
}

// Coordinates 1e6 diameters from the origin, in steps that both places can hold: every number is
// the same but for rounding.
TEST(Analysis, IsTheSameAMillionDiametersFromTheOrigin) {
    for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
        MemorySource near_source = video(12);
        MemorySource far_source = near_source;
        for (std::size_t f = 0; f < near_source.snapshots.size(); ++f) {
            Snapshot& here = near_source.snapshots[f];
            Snapshot& far = far_source.snapshots[f];
            here.box.boundary = far.box.boundary = {boundary, boundary};
            far.box.origin = {8e6, -8e6};
            for (std::size_t i = 0; i < here.size(); ++i) {
                Vec2& p = here.position[i];
                p = {std::ldexp(std::round(std::ldexp(p.x, 20)), -20),
                     std::ldexp(std::round(std::ldexp(p.y, 20)), -20)};
                far.position[i] = p + far.box.origin;
            }
        }
        AnalysisOptions options;
        options.of<FitOptions>().k_max = 1.5;
        const auto a = run(near_source, options);
        const auto b = run(far_source, options);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t o = 0; o < a.size(); ++o) {
            EXPECT_EQ(a[o].reason, b[o].reason);
            ASSERT_EQ(a[o].measurements.size(), b[o].measurements.size()) << a[o].name;
            for (std::size_t i = 0; i < a[o].measurements.size(); ++i) {
                const Measurement& x = a[o].measurements[i];
                const Measurement& y = b[o].measurements[i];
                EXPECT_NEAR(x.value.value_or(0), y.value.value_or(0),
                            1e-7 * std::abs(x.value.value_or(0)) + 1e-12)
                    << x.name;
            }
        }
    }
}

TEST(Analysis, SurvivesDegeneratePatterns) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::vector<Vec2>> patterns{{},
                                                  {{5, 5}},
                                                  {{5, 5}, {6, 6}},
                                                  std::vector<Vec2>(100, Vec2{7, 7}),
                                                  {{nan, 1}, {2, nan}, {nan, nan}},
                                                  {{1e9, 1e9}, {-1e9, 3}}};
    for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
        for (NeighbourRule rule : {NeighbourRule::near_four, NeighbourRule::near_delaunay}) {
            for (const auto& points : patterns) {
                MemorySource source;
                for (int f = 0; f < 3; ++f) {
                    Snapshot s;
                    s.frame = f;
                    s.time = f;
                    s.box = square_box(20, boundary);
                    s.position = points;
                    s.id = identities(points.size());
                    source.snapshots.push_back(s);
                }
                AnalysisOptions options;
                options.of<BondOrderOptions>().rule = rule;
                for (const ObservableResult& r : run(source, options)) {
                    for (const Measurement& m : r.measurements) {
                        if (m.value) {
                            EXPECT_TRUE(std::isfinite(*m.value)) << r.name << m.name;
                        }
                        if (!m.value) {
                            EXPECT_NE(m.reason, "") << r.name << m.name;
                        }
                    }
                    if (points.empty()) {
                        EXPECT_NE(r.reason, "") << r.name;
                    }
                }
            }
        }
    }
}

TEST(Analysis, HandlesUnequalNumbersAndAnEmptyFrameInBetween) {
    MemorySource source = video(6);
    source.snapshots[2].position.clear();
    source.snapshots[2].id.clear();
    source.snapshots[2].z.clear();
    source.snapshots[4].position.resize(700);
    source.snapshots[4].id.resize(700);
    source.snapshots[4].z.resize(700);
    for (const ObservableResult& r : run(source))
        if (r.name != "fit") {  // nothing here has a pre-peak
            EXPECT_EQ(r.reason, "") << r.name;
        }
}

TEST(Analysis, SaysInThePlanWhatItLeavesOut) {
    MemorySource source = video(1);
    source.snapshots[0].position[3] = {std::numeric_limits<double>::infinity(), 0};
    RunPlan plan;
    run(source, {}, 1, &plan);
    EXPECT_THAT(plan.text(), testing::HasSubstr("msd"));
    EXPECT_THAT(plan.text(), testing::HasSubstr("one frame"));
    ASSERT_EQ(plan.warnings().size(), 1U);
    EXPECT_THAT(plan.warnings()[0].text, testing::HasSubstr("not finite"));
}

TEST(Analysis, WarnsOfABoxThatIsNotFilled) {
    MemorySource source = video(1);
    for (Snapshot& s : source.snapshots) s.box.length = {640, 320};
    RunPlan plan;
    run(source, {}, 1, &plan);
    ASSERT_FALSE(plan.warnings().empty());
    EXPECT_THAT(plan.warnings()[0].text, testing::HasSubstr("49 % x 100 %"));
}

TEST(Analysis, MeasuresOnlyWhatIsAskedFor) {
    MemorySource source = video(2);
    AnalysisOptions options;
    options.observables = {"sk", "q4"};
    const auto results = run(source, options);
    ASSERT_EQ(results.size(), 2U);
    EXPECT_EQ(results[0].name, "q4");
    EXPECT_EQ(results[1].name, "sk");
    options.observables = {"everything"};
    EXPECT_THROW(run(source, options), OptionError);
}

TEST(Analysis, DescribesEveryOptionOnce) {
    AnalysisOptions options;
    const auto tables = describe(options);
    std::vector<std::string> sections;
    for (const OptionTable& table : tables) sections.push_back(table.section());
    EXPECT_EQ(sections, (std::vector<std::string>{"analysis", "q4", "phase", "msd", "sk", "s4",
                                                  "variance", "fit", "synthetic", "gr"}));
    tables[4].find("k-max")->set_from_text("3.5");
    EXPECT_EQ(options.of<StructureFactorOptions>().k_max, 3.5);
    tables[1].find("neighbours")->set_from_text("near-delaunay");
    EXPECT_EQ(options.of<BondOrderOptions>().rule, NeighbourRule::near_delaunay);
}

TEST(AbsQ4, KeepsOneEntryAParticleEvenForPositionsThatAreNotNumbers) {
    MemorySource source = video(1);
    Snapshot& s = source.snapshots[0];
    const std::vector<double> before = abs_q4(s, 8, {});
    s.position.insert(s.position.begin(), {std::numeric_limits<double>::quiet_NaN(), 0});
    s.z.insert(s.z.begin(), 0);
    s.id.clear();
    const std::vector<double> after = abs_q4(s, 8, {});
    ASSERT_EQ(after.size(), before.size() + 1);
    EXPECT_TRUE(std::isnan(after[0]));
    EXPECT_NEAR(after[1], before[0], 1e-12);
    EXPECT_NEAR(before[410], 1, 0.05);
}

TEST(Analysis, PlansFromTheFirstFrameThatHasParticles) {
    MemorySource source = video(6);
    for (int f : {0, 1}) {
        source.snapshots[static_cast<std::size_t>(f)].position.clear();
        source.snapshots[static_cast<std::size_t>(f)].id.clear();
        source.snapshots[static_cast<std::size_t>(f)].z.clear();
    }
    RunPlan plan;
    plan_measurement(source, {}, plan);
    for (const PlannedStage& stage : plan.skipped()) EXPECT_NE(stage.stage, "msd") << stage.reason;
    EXPECT_EQ(run(source)[2].reason, "");
}

TEST(Analysis, DoesNotReportTheTriangulationAsSkippedWhereNobodyAskedForIt) {
    MemorySource source = video(3);
    RunPlan plan;
    plan_measurement(source, {}, plan);
    for (const PlannedStage& stage : plan.skipped()) EXPECT_NE(stage.stage, "triangulation");
}

}  // namespace
}  // namespace grainfield::analysis
