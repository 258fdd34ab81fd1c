#include "analysis/density/field_analysis.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/density/field_statistics.h"
#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

using ::testing::HasSubstr;

// White noise of variance 2 a cell of area 1/4: S = 1/2 at every k.
class WhiteFields final : public FieldSource {
 public:
    WhiteFields(int fields, int nx, int ny) : fields_(fields), nx_(nx), ny_(ny) {}
    std::int64_t count() const override { return fields_; }
    FieldFrame read(std::int64_t index) override {
        RandomStream random(2, "white", static_cast<std::uint64_t>(index));
        DensityField field;
        field.nx = nx_;
        field.ny = ny_;
        field.spacing = 0.5;
        field.step = index;
        for (int i = 0; i < nx_ * ny_; ++i) {
            field.value.push_back(3 + std::sqrt(2.0) * random.normal());
        }
        FieldFrame frame;
        frame.dimension = ny_ == 1 ? 1 : 2;
        frame.density = {field};
        return frame;
    }

 private:
    int fields_, nx_, ny_;
};

const ObservableResult& named(const std::vector<ObservableResult>& results, const char* name) {
    const auto at = std::ranges::find(results, name, &ObservableResult::name);
    EXPECT_NE(at, results.end()) << name;
    return *at;
}

TEST(FieldAnalysis, FitsAndExtendsTheStructureFactorOfFieldsLikeThatOfParticles) {
    WhiteFields source(64, 48, 48);
    FieldAnalysisOptions options;
    options.fit.k_max = 2.0;
    Progress progress("fields", source.count(), "fields", Verbosity::quiet);
    const auto results = analyze_fields(source, options, progress);
    const ObservableResult& fit = named(results, "fit");
    ASSERT_EQ(fit.reason, "");
    const Measurement* s0 = fit.find_measurement("s0");
    EXPECT_NEAR(*s0->value, 0.5, 6 * *s0->error);
    const Measurement* s1 = fit.find_measurement("s1");
    EXPECT_NEAR(*s1->value, 0, 6 * *s1->error);
    const ObservableResult& synthetic = named(results, "synthetic");
    ASSERT_EQ(synthetic.reason, "");
    // σ² of the content is S times the volume; beyond k_max = 2 the variance of S = 1 is assumed.
    const Curve* curve = synthetic.find_curve("synthetic");
    ASSERT_NE(curve, nullptr);
    EXPECT_EQ(curve->text_columns.at("side").front(), "24");
}

TEST(FieldAnalysis, FitsWhatARunAccumulatedFromItsCurves) {
    WhiteFields source(64, 48, 48);
    FieldAnalysisOptions options;
    options.fit.k_max = 2.0;
    FieldStatistics statistics(options.sk, source.count());
    for (std::int64_t i = 0; i < source.count(); ++i) statistics.write(source.read(i));
    std::vector<ObservableResult> results = statistics.results();
    const FieldFrame like = source.read(0);
    add_fits(results, &like, options);
    const ObservableResult direct = fit_result(*statistics.density(), options.fit);
    EXPECT_NEAR(*named(results, "fit").find_measurement("s0")->value,
                *direct.find_measurement("s0")->value, 1e-9);
    EXPECT_THAT(named(results, "fit").find_measurement("s0")->reason, HasSubstr("likelihood"));
    EXPECT_EQ(named(results, "synthetic").reason, "");

    std::vector<ObservableResult> unknown = statistics.results();
    add_fits(unknown, nullptr, options);
    EXPECT_THAT(named(unknown, "synthetic").reason, HasSubstr("stores no field"));
}

TEST(FieldAnalysis, OfOneDimensionHasAFitAndNoSquareWindows) {
    WhiteFields source(64, 512, 1);
    FieldAnalysisOptions options;
    options.fit.k_max = 2.0;
    Progress progress("fields", source.count(), "fields", Verbosity::quiet);
    const auto results = analyze_fields(source, options, progress);
    EXPECT_EQ(named(results, "fit").reason, "");
    EXPECT_THAT(named(results, "synthetic").reason, HasSubstr("one dimension"));
}

}  // namespace
}  // namespace grainfield::analysis
