#include "io/h5/results_file.h"

#include <bit>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/trajectory_file.h"
#include "tests/io/file_samples.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Results of any shape, with the numbers and texts that files get wrong.
class AnyResults {
 public:
    explicit AnyResults(std::uint64_t trial) : random_(5, "any results", trial) {}

    Results make() {
        Results r;
        r.source = sample_info();
        r.source.vibration_frequency = optional();
        r.identity = {.origin = Origin::field,
                      .role = RunRole::critical_point,
                      .control = sample_info().control,
                      .dimension = 1,
                      .gradient_order = optional()};
        r.label = text();
        r.box = {{number(), number()}, {100, 50}, {Boundary::walls, Boundary::periodic}, 1.5};
        r.frames = static_cast<std::int64_t>(random_.below(1U << 30U)) << 20;
        r.particles_mean = number();
        for (int i = count(4); i > 0; --i) r.observables.push_back(observable());
        for (int i = count(2); i > 0; --i) r.previews.push_back(sample_preview());
        r.record = sample_record();
        r.record.warnings.push_back({WarningCode::incomplete, text()});
        r.sources = {sample_record(), r.record};
        return r;
    }

 private:
    int count(unsigned most) { return static_cast<int>(random_.below(most + 1)); }

    double number() {
        const std::vector<double> special{0.0, -0.0, nan, infinity, -infinity, 5e-324, 1e308};
        if (random_.below(3) == 0) return special[random_.below(special.size())];
        for (;;) {
            const auto bits = std::uint64_t{random_.bits()} << 32U | random_.bits();
            if (const auto value = std::bit_cast<double>(bits); value == value) return value;
        }
    }
    std::optional<double> optional() {
        if (random_.below(2) == 0) return std::nullopt;
        return number();
    }
    std::string text() {
        const std::vector<std::string> texts{"",
                                             "sk",
                                             "a/b",
                                             "..",
                                             "</script>",
                                             "σ² \"ℓ\"\n",
                                             std::string("null\0byte", 9),
                                             std::string(70'000, 'x')};
        return texts[random_.below(texts.size())];
    }
    OptionValue option() {
        switch (random_.below(4)) {
            case 0:
                return random_.below(2) == 1;
            case 1:
                return -static_cast<std::int64_t>(random_.bits()) << 30;
            case 2:
                return number();
            default:
                return text();
        }
    }
    Curve curve() {
        Curve c{.name = text(), .title = text(), .columns = {}, .text_columns = {}};
        const auto rows = static_cast<std::size_t>(count(5));
        for (int i = count(4); i > 0; --i) {
            Column column{.name = text(), .unit = text(), .meaning = text(), .values = {}};
            for (std::size_t row = 0; row < rows; ++row) column.values.push_back(number());
            c.columns.push_back(std::move(column));
        }
        for (int i = count(2); i > 0; --i) {
            std::vector<std::string>& column = c.text_columns[text()];
            column.clear();
            for (std::size_t row = 0; row < rows; ++row) column.push_back(text());
        }
        return c;
    }
    ObservableResult observable() {
        ObservableResult o{.name = text(),
                           .measurements = {},
                           .curves = {},
                           .options = {},
                           .reason = text(),
                           .seconds = number()};
        for (int i = count(3); i > 0; --i) {
            o.measurements.push_back({.name = text(),
                                      .unit = text(),
                                      .value = optional(),
                                      .error = optional(),
                                      .samples = number(),
                                      .reason = text()});
        }
        for (int i = count(3); i > 0; --i) o.curves.push_back(curve());
        for (int i = count(3); i > 0; --i) o.options.emplace_back(text(), option());
        return o;
    }

    RandomStream random_;
};

bool same(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (a != a && b != b);
}

bool same(const std::optional<double>& a, const std::optional<double>& b) {
    return a.has_value() == b.has_value() && (!a || same(*a, *b));
}

bool same(const OptionValue& a, const OptionValue& b) {
    if (a.index() != b.index()) return false;
    if (const double* x = std::get_if<double>(&a)) return same(*x, std::get<double>(b));
    return a == b;
}

void expect_same(const Curve& a, const Curve& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.title, b.title);
    EXPECT_EQ(a.text_columns, b.text_columns);
    ASSERT_EQ(a.columns.size(), b.columns.size());
    for (std::size_t i = 0; i < a.columns.size(); ++i) {
        EXPECT_EQ(a.columns[i].name, b.columns[i].name);
        EXPECT_EQ(a.columns[i].unit, b.columns[i].unit);
        EXPECT_EQ(a.columns[i].meaning, b.columns[i].meaning);
        ASSERT_EQ(a.columns[i].values.size(), b.columns[i].values.size());
        for (std::size_t row = 0; row < a.columns[i].values.size(); ++row) {
            EXPECT_TRUE(same(a.columns[i].values[row], b.columns[i].values[row]));
        }
    }
}

void expect_same(const ObservableResult& a, const ObservableResult& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.reason, b.reason);
    EXPECT_TRUE(same(a.seconds, b.seconds));
    ASSERT_EQ(a.measurements.size(), b.measurements.size());
    for (std::size_t i = 0; i < a.measurements.size(); ++i) {
        EXPECT_EQ(a.measurements[i].name, b.measurements[i].name);
        EXPECT_EQ(a.measurements[i].unit, b.measurements[i].unit);
        EXPECT_TRUE(same(a.measurements[i].value, b.measurements[i].value));
        EXPECT_TRUE(same(a.measurements[i].error, b.measurements[i].error));
        EXPECT_TRUE(same(a.measurements[i].samples, b.measurements[i].samples));
        EXPECT_EQ(a.measurements[i].reason, b.measurements[i].reason);
    }
    ASSERT_EQ(a.options.size(), b.options.size());
    for (std::size_t i = 0; i < a.options.size(); ++i) {
        EXPECT_EQ(a.options[i].first, b.options[i].first);
        EXPECT_TRUE(same(a.options[i].second, b.options[i].second));
    }
    ASSERT_EQ(a.curves.size(), b.curves.size());
    for (std::size_t i = 0; i < a.curves.size(); ++i) expect_same(a.curves[i], b.curves[i]);
}

void expect_same(const Results& a, const Results& b) {
    grainfield::expect_same(a.source, b.source);
    EXPECT_EQ(a.label, b.label);
    EXPECT_TRUE(same(a.box.origin.x, b.box.origin.x) && same(a.box.origin.y, b.box.origin.y));
    EXPECT_EQ(a.box.length, b.box.length);
    EXPECT_EQ(a.box.boundary, b.box.boundary);
    EXPECT_EQ(a.box.height, b.box.height);
    EXPECT_EQ(a.frames, b.frames);
    EXPECT_TRUE(same(a.particles_mean, b.particles_mean));
    ASSERT_EQ(a.observables.size(), b.observables.size());
    for (std::size_t i = 0; i < a.observables.size(); ++i) {
        expect_same(a.observables[i], b.observables[i]);
    }
    ASSERT_EQ(a.previews.size(), b.previews.size());
    for (std::size_t i = 0; i < a.previews.size(); ++i) {
        grainfield::expect_same(a.previews[i], b.previews[i]);
    }
    grainfield::expect_same(a.record, b.record);
    ASSERT_EQ(a.sources.size(), b.sources.size());
    for (std::size_t i = 0; i < a.sources.size(); ++i) {
        grainfield::expect_same(a.sources[i], b.sources[i]);
    }
}

// 60 random results, with names that are equal, empty or no names of HDF5, and numbers of any bits.
TEST(ResultsFile, GivesBackEveryBit) {
    const testing::ScratchFolder folder;
    for (std::uint64_t trial = 0; trial < 60; ++trial) {
        Results results = AnyResults(trial).make();
        if (results.source.vibration_frequency) {
            // expect_same of infos compares with ==.
            const double f = *results.source.vibration_frequency;
            results.source.vibration_frequency = f == f ? f : 1;
        }
        write_results(folder / "r.h5", results, Overwrite::force);
        expect_same(read_results(folder / "r.h5"), results);
        if (HasFailure()) FAIL() << "in trial " << trial;
    }
}

Results small_results() {
    Results results;
    results.source = sample_info();
    results.box = {{0, 0}, {10, 10}};
    ObservableResult sk{.name = "sk",
                        .measurements = {{.name = "s0",
                                          .unit = "-",
                                          .value = 0.1,
                                          .error = {},
                                          .samples = 3,
                                          .reason = "one frame"}},
                        .curves = {},
                        .options = {},
                        .reason = {},
                        .seconds = 0};
    Column k{.name = "k", .unit = "1/a", .meaning = "wavenumber", .values = {}};
    for (int i = 0; i < 100; ++i) k.values.push_back(i + 1.0 / 3);
    sk.curves.push_back({.name = "sk", .title = "S(k)", .columns = {k}, .text_columns = {}});
    results.observables.push_back(sk);
    results.previews.push_back(sample_preview());
    results.record = sample_record();
    return results;
}

TEST(ResultsFile, CutAnywhereIsAnInputError) {
    const testing::ScratchFolder folder;
    write_results(folder / "r.h5", small_results(), Overwrite::refuse);
    const std::string bytes = read_bytes(folder / "r.h5");
    for (std::size_t part = 0; part < 50; ++part) {
        write_bytes(folder / "cut.h5", bytes.substr(0, bytes.size() * part / 50));
        EXPECT_THROW(read_results(folder / "cut.h5"), InputError) << part;
    }
}

TEST(ResultsFile, WithAFlippedBitInACurveIsAnInputError) {
    const testing::ScratchFolder folder;
    write_results(folder / "r.h5", small_results(), Overwrite::refuse);
    std::string bytes = read_bytes(folder / "r.h5");
    const double value = 17 + 1.0 / 3;
    const auto at = bytes.find(std::string(reinterpret_cast<const char*>(&value), sizeof(value)));
    ASSERT_NE(at, std::string::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    write_bytes(folder / "r.h5", bytes);
    EXPECT_THAT([&] { read_results(folder / "r.h5"); },
                ThrowsMessage<InputError>(HasSubstr("damaged")));
}

// 400 files with one byte changed: each is read as some results or refused, but never crashes.
TEST(ResultsFile, WithAnyByteChangedNeverCrashes) {
    const testing::ScratchFolder folder;
    write_results(folder / "r.h5", small_results(), Overwrite::refuse);
    const std::string bytes = read_bytes(folder / "r.h5");
    RandomStream random(12, "byte changes");
    for (int trial = 0; trial < 400; ++trial) {
        std::string changed = bytes;
        changed[random.below(changed.size())] = static_cast<char>(random.below(256));
        write_bytes(folder / "changed.h5", changed);
        try {
            read_results(folder / "changed.h5");
        } catch (const InputError&) {
        }
    }
}

TEST(ResultsFile, RefusesWhatIsNotResults) {
    const testing::ScratchFolder folder;
    EXPECT_THROW(read_results(folder / "none.h5"), InputError);
    EXPECT_THROW(read_results(folder.path()), InputError);
    TrajectoryWriter(folder / "t.h5", sample_info(), Overwrite::refuse).finish({});
    EXPECT_THAT([&] { read_results(folder / "t.h5"); },
                ThrowsMessage<InputError>(HasSubstr("no results")));
}

TEST(ResultsFile, RefusesColumnsOfDifferentLengthsAndLeavesNothingBehind) {
    const testing::ScratchFolder folder;
    Results results = small_results();
    results.observables[0].curves[0].columns.push_back({"s", "-", "", {1, 2}});
    EXPECT_THROW(write_results(folder / "r.h5", results, Overwrite::refuse), OutputError);
    EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace grainfield::io
