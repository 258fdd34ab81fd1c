#include "analysis/density/field_statistics.h"

#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/density/field_analysis.h"
#include "core/errors.h"
#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

DensityField random_field(int nx, int ny, std::uint64_t seed, double mean = 0) {
    DensityField field;
    field.nx = nx;
    field.ny = ny;
    field.spacing = 0.65;
    RandomStream random(seed, "field statistics");
    for (int i = 0; i < nx * ny; ++i) field.value.push_back(mean + random.normal());
    return field;
}

FieldFrame frame_of(DensityField density, int dimension) {
    FieldFrame frame;
    frame.dimension = dimension;
    frame.order = density;
    frame.mean_diffusivity = 0.5;
    frame.density = {std::move(density)};
    return frame;
}

TEST(FieldStructureFactor, IsTheSumOverCells) {
    for (const auto& [nx, ny] : {std::pair{8, 6}, {7, 9}, {12, 1}}) {
        const int dimension = ny == 1 ? 1 : 2;
        const DensityField field = random_field(nx, ny, 3);
        const StructureFactor sk = StructureFactor::of_field({.k_max = 100}, field, {});
        const auto sample = sk.measure(field, dimension);
        const double cell = std::pow(0.65, dimension);
        EXPECT_DOUBLE_EQ(sample.particles, cell * nx * ny);
        ASSERT_FALSE(sk.grid().modes().empty());
        for (std::size_t m = 0; m < sample.rho.size(); ++m) {
            const Mode& mode = sk.grid().modes()[m];
            EXPECT_LE(mode.k, std::numbers::pi / 0.65 * (1 + 1e-9));
            std::complex<double> sum = 0;
            for (int y = 0; y < ny; ++y) {
                for (int x = 0; x < nx; ++x) {
                    const double phase = 2 * std::numbers::pi *
                                         (static_cast<double>(mode.nx) * x / nx +
                                          static_cast<double>(mode.ny) * y / ny);
                    sum += cell * field.value[static_cast<std::size_t>(y * nx + x)] *
                           std::polar(1.0, -phase);
                }
            }
            EXPECT_LT(std::abs(sample.rho[m] - sum), 1e-12);
        }
    }
}

// The estimator of particles, on particles at the cell centres with the field as their number.
TEST(FieldStructureFactor, AgreesWithParticlesAtTheCells) {
    DensityField field = random_field(10, 10, 1);
    Pattern pattern;
    pattern.box = field.box();
    RandomStream random(2, "particles");
    for (std::size_t i = 0; i < field.size(); ++i) {
        const auto n = random.below(4);
        const double cell = 0.65 * 0.65;
        field.value[i] = static_cast<double>(n) / cell;
        for (std::uint64_t j = 0; j < n; ++j) {
            pattern.position.push_back({(static_cast<double>(i % 10) + 0.5) * 0.65,
                                        (static_cast<double>(i / 10) + 0.5) * 0.65});
        }
    }
    const StructureFactor sk = StructureFactor::of_field({.k_max = 100}, field, {});
    const auto of_field = sk.measure(field, 2);
    const auto of_particles = sk.measure(pattern);
    for (std::size_t m = 0; m < of_field.rho.size(); ++m) {
        EXPECT_NEAR(std::abs(of_field.rho[m]), std::abs(of_particles.rho[m]), 1e-10);
    }
}

double brute_variance(const DensityField& field, int m, int dimension) {
    double mean = 0;
    for (const double v : field.value) mean += v / static_cast<double>(field.size());
    double squares = 0;
    for (int y = 0; y < field.ny; ++y) {
        for (int x = 0; x < field.nx; ++x) {
            double content = 0;
            for (int dy = 0; dy < (dimension == 1 ? 1 : m); ++dy) {
                for (int dx = 0; dx < m; ++dx) {
                    content += field.value[static_cast<std::size_t>((y + dy) % field.ny * field.nx +
                                                                    (x + dx) % field.nx)] -
                               mean;
                }
            }
            squares += content * content;
        }
    }
    return squares / static_cast<double>(field.size()) * std::pow(field.spacing, 2 * dimension);
}

TEST(FieldVariance, IsThatOfEveryWindow) {
    for (const auto& [nx, ny] : {std::pair{16, 12}, {9, 11}, {20, 1}}) {
        const int dimension = ny == 1 ? 1 : 2;
        const DensityField field = random_field(nx, ny, 4, 2.5);
        FieldVariance variance(field, dimension, {});
        variance.add(variance.measure(field));
        const Curve curve = variance.result().curves.front();
        ASSERT_GE(curve.columns[0].values.size(), 3U);
        for (std::size_t s = 0; s < curve.columns[0].values.size(); ++s) {
            const int m = static_cast<int>(std::lround(curve.columns[0].values[s] / 0.65));
            EXPECT_NEAR(curve.columns[1].values[s] / brute_variance(field, m, dimension), 1, 1e-11);
            EXPECT_NEAR(curve.columns[3].values[s], std::pow(m * 0.65, dimension), 1e-12);
        }
    }
}

// Fields one to `fields` of a run that was meant to have 16.
ObservableResult variance_of(int fields) {
    const DensityField first = random_field(16, 12, 1);
    FieldVariance variance(first, 2, BlockPlan::of(16));
    for (int f = 0; f < fields; ++f) {
        variance.add(
            variance.measure(random_field(16, 12, static_cast<std::uint64_t>(f) + 1, 2.5)));
    }
    return variance.result();
}

// Of a mean of T values the jackknife is s/sqrt(T).
TEST(FieldVariance, HasAnErrorWithStudentsFactorFromTheBlocksThatHoldFields) {
    const int fields = 5;
    const Curve curve = variance_of(fields).curves.front();
    double mean = 0;
    double squares = 0;
    for (int f = 0; f < fields; ++f) {
        const double v =
            brute_variance(random_field(16, 12, static_cast<std::uint64_t>(f) + 1, 2.5), 2, 2);
        mean += v / fields;
        squares += v * v;
    }
    const double s = std::sqrt((squares - fields * mean * mean) / (fields - 1));
    EXPECT_NEAR(curve.columns[2].values[1], s / std::sqrt(5.0) * std::sqrt(2.0), 1e-9);
    EXPECT_EQ(variance_of(fields).measurements[0].samples, fields);
}

TEST(FieldVariance, OfThreeFieldsHasAReasonInPlaceOfAnError) {
    const ObservableResult r = variance_of(3);
    EXPECT_FALSE(r.measurements[0].error.has_value());
    EXPECT_NE(r.measurements[0].reason.find("fewer than four blocks"), std::string::npos);
    for (const double error : r.curves.front().columns[2].values) EXPECT_TRUE(std::isnan(error));
}

// White noise of variance v a cell: σ² = v ℓ^d dx^d (1 − m^d/n^d) (fixed sum), S = v dx^d.
TEST(FieldStatistics, WhiteNoiseIsFlat) {
    FieldStatistics statistics({.k_max = 4}, 200);
    for (std::uint64_t i = 0; i < 200; ++i) statistics.write(frame_of(random_field(24, 24, i), 2));
    const auto results = statistics.results();
    const Curve& sk = results[0].curves.front();
    const double s = 0.65 * 0.65;
    double sum = 0;
    double modes = 0;
    for (std::size_t i = 0; i < sk.columns[0].values.size(); ++i) {
        sum += sk.columns[1].values[i] * sk.columns[3].values[i];
        modes += sk.columns[3].values[i];
    }
    // 5.5 sigma of 200 · modes exponential numbers.
    EXPECT_NEAR(sum / modes / s, 1, 5.5 / std::sqrt(200 * modes));
    const Curve& variance = results[1].curves.front();
    for (std::size_t i = 0; i + 3 < variance.columns[0].values.size(); ++i) {
        const double cells = variance.columns[3].values[i] / s;
        EXPECT_NEAR(variance.columns[1].values[i] / (cells * s * s * (1 - cells / 576)), 1,
                    8 * variance.columns[2].values[i] / variance.columns[1].values[i]);
    }
    EXPECT_EQ(results[2].name, "sk_order");
    EXPECT_EQ(results[2].curves.front().columns[1].values, sk.columns[1].values);
}

// Above the largest k of the order its S is what rounding leaves, and no spectrum.
TEST(FieldStatistics, OfTheOrderEndWhereItHasNoModes) {
    FieldStatistics statistics({.k_max = 3}, 4, 1.5);
    for (std::uint64_t i = 0; i < 4; ++i) statistics.write(frame_of(random_field(32, 32, i), 2));
    const auto results = statistics.results();
    const auto last_k = [&](const char* observable) {
        for (const ObservableResult& result : results) {
            if (result.name == observable)
                return result.find_curve(observable)->find("k")->values.back();
        }
        return 0.0;
    };
    EXPECT_GT(last_k("sk"), 2.9);
    EXPECT_GT(last_k("sk_order"), 1.3);
    EXPECT_LE(last_k("sk_order"), 1.5);
}

TEST(FieldStatistics, GoesOnBitByBitAfterACheckpoint) {
    FieldStatistics whole({}, 20), first({}, 20), second({}, 20);
    for (std::uint64_t i = 0; i < 20; ++i) {
        const FieldFrame frame = frame_of(random_field(16, 10, i), 2);
        whole.write(frame);
        if (i < 8) first.write(frame);
    }
    Checkpoint checkpoint;
    first.save(checkpoint);
    second.restore(checkpoint, frame_of(random_field(16, 10, 0), 2));
    for (std::uint64_t i = 8; i < 20; ++i) second.write(frame_of(random_field(16, 10, i), 2));
    const auto a = whole.results();
    const auto b = second.results();
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t r = 0; r < a.size(); ++r) {
        for (std::size_t m = 0; m < a[r].measurements.size(); ++m) {
            EXPECT_EQ(a[r].measurements[m].value, b[r].measurements[m].value);
            EXPECT_EQ(a[r].measurements[m].error, b[r].measurements[m].error);
        }
        for (std::size_t c = 0; c < a[r].curves.size(); ++c) {
            for (std::size_t k = 0; k < a[r].curves[c].columns.size(); ++k) {
                EXPECT_EQ(a[r].curves[c].columns[k].values, b[r].curves[c].columns[k].values);
            }
        }
    }
    Checkpoint other = checkpoint;
    other.reals["statistics sk sums"].pop_back();
    EXPECT_THROW(FieldStatistics({}, 20).restore(other, frame_of(random_field(16, 10, 0), 2)),
                 InputError);
    other = checkpoint;
    other.reals.erase("statistics diffusivity");
    EXPECT_THROW(FieldStatistics({}, 20).restore(other, frame_of(random_field(16, 10, 0), 2)),
                 InputError);
}

// A field that goes on from its predecessor, so that it matters which instants share a block.
class Relaxing {
 public:
    FieldFrame next() {
        const DensityField noise = random_field(12, 12, ++steps_);
        if (last_.value.empty()) last_ = noise;
        for (std::size_t i = 0; i < noise.size(); ++i) {
            last_.value[i] = 0.4 * last_.value[i] + 0.9 * noise.value[i];
        }
        return frame_of(last_, 2);
    }

 private:
    std::uint64_t steps_ = 0;
    DensityField last_;
};

void expect_same_errors(const FieldStatistics& a, const FieldStatistics& b) {
    int errors = 0;
    for (std::size_t observable = 0; observable < 3; ++observable) {
        const Curve one = a.results()[observable].curves.front();
        const Curve other = b.results()[observable].curves.front();
        for (std::size_t i = 0; i < one.columns[2].values.size(); ++i) {
            const double error = other.columns[2].values[i];
            EXPECT_NEAR(one.columns[1].values[i], other.columns[1].values[i], 1e-12);
            ASSERT_EQ(std::isfinite(one.columns[2].values[i]), std::isfinite(error)) << one.name;
            if (!std::isfinite(error)) continue;
            EXPECT_NEAR(one.columns[2].values[i] / error, 1, 1e-9) << one.name << " " << i;
            ++errors;
        }
    }
    EXPECT_GT(errors, 10);
}

TEST(FieldStatistics, OfARunThatBecameLongerHaveTheErrorsOfOneOfThatLength) {
    struct Case {
        std::int64_t planned, done, longer, equal_to;
    };
    for (const Case& c : {Case{32, 20, 64, 64}, Case{32, 32, 96, 96}, Case{40, 40, 41, 80},
                          Case{12, 9, 50, 50}, Case{64, 10, 40, 64}}) {
        Relaxing run, same;
        FieldStatistics begun({.k_max = 3}, c.planned);
        for (std::int64_t i = 0; i < c.done; ++i) begun.write(run.next());
        Checkpoint checkpoint;
        begun.save(checkpoint);
        FieldStatistics longer({.k_max = 3}, c.longer), whole({.k_max = 3}, c.equal_to);
        longer.restore(checkpoint, Relaxing().next());
        for (std::int64_t i = c.done; i < c.longer; ++i) longer.write(run.next());
        for (std::int64_t i = 0; i < c.longer; ++i) whole.write(same.next());
        SCOPED_TRACE(c.longer);
        expect_same_errors(longer, whole);
    }
}

TEST(FieldStatistics, TakeNoCheckpointWithAnImpossiblePlan) {
    FieldStatistics begun({}, 20);
    begun.write(frame_of(random_field(8, 8, 1), 2));
    Checkpoint checkpoint;
    begun.save(checkpoint);
    for (const std::vector<std::int64_t>& plan :
         {std::vector<std::int64_t>{20}, {20, 0}, {20, 17}, {0, 1}, {-5, 1}}) {
        checkpoint.integers["statistics plan"] = plan;
        EXPECT_THROW(
            FieldStatistics({}, 20).restore(checkpoint, frame_of(random_field(8, 8, 1), 2)),
            InputError);
    }
}

// Three equal densities say what one says.
TEST(FieldStatistics, HaveAllReplicasOfAnInstantInOneBlock) {
    for (const std::int64_t instants : {4, 10, 21}) {
        Relaxing run;
        FieldStatistics one({.k_max = 3}, instants), three({.k_max = 3}, instants);
        for (std::int64_t i = 0; i < instants; ++i) {
            FieldFrame frame = run.next();
            one.write(frame);
            frame.density.insert(frame.density.end(), 2, frame.density.front());
            three.write(frame);
        }
        SCOPED_TRACE(instants);
        expect_same_errors(three, one);
    }
}

TEST(FieldStatistics, NothingOrOneFieldGivesReasons) {
    FieldStatistics none({}, 0);
    EXPECT_EQ(none.results().front().reason, "no fields");
    FieldStatistics one({}, 1);
    one.write(frame_of(random_field(8, 8, 1), 2));
    for (const auto& result : one.results()) {
        for (const Measurement& m : result.measurements) {
            EXPECT_TRUE(m.error || !m.reason.empty()) << m.name;
        }
    }
}

TEST(FieldStatistics, AnotherLatticeIsRefused) {
    FieldStatistics statistics({}, 2);
    statistics.write(frame_of(random_field(8, 8, 1), 2));
    EXPECT_THROW(statistics.write(frame_of(random_field(9, 8, 1), 2)), InputError);
}

}  // namespace
}  // namespace grainfield::analysis
