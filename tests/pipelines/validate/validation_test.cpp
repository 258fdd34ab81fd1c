#include "pipelines/validate/validation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "pipelines/validate/validation_report.h"
#include "tests/pipelines/validate/validation_samples.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Not;

ValidationOutcome validated(sample::Film& film, RunPlan& plan, int threads = 2) {
    ValidationSettings settings;
    settings.threads = threads;
    settings.verbosity = Verbosity::quiet;
    tracking::TrackSummary summary;
    return validate({*film.frames, film.truth, 12.0, 30.0}, settings, summary, plan);
}

StoredTrajectory rounded(StoredTrajectory& truth) {
    StoredTrajectory whole;
    whole.set_info(truth.info());
    for (std::int64_t i = 0; i < truth.count(); ++i) {
        Snapshot snapshot = truth.read(i);
        for (Vec2& p : snapshot.position) p = {std::round(p.x), std::round(p.y)};
        whole.write(snapshot);
    }
    return whole;
}

TEST(Validation, ScoresEveryClassOfAFilm) {
    sample::Film film = sample::film(6);
    RunPlan plan;
    const ValidationOutcome outcome = validated(film, plan);
    const auto& detection = outcome.scores.detection();
    EXPECT_EQ(detection.frames(), 6);
    const auto& all = detection.find("all");
    EXPECT_GE(all.recall(), 0.995);
    EXPECT_GE(all.precision(), 0.995);
    // 3.6 times the bound of 0.0076 px: rim and blur of this camera are not the tracker's model. A
    // tenth above that is ten times what the number of spheres lets an RMS scatter.
    EXPECT_LT(all.rmse_per_axis(), 1.1 * 3.6 * all.bound());
    EXPECT_NEAR(all.bound(), 0.0076, 0.0002);
    EXPECT_GT(all.bound_ratio(), 0.9);
    const auto& liquid = detection.find("liquid");
    const auto& crystal = detection.find("crystal");
    EXPECT_EQ(liquid.matched + crystal.matched, all.matched);
    EXPECT_EQ(liquid.missed + crystal.missed, all.missed);
    EXPECT_GT(crystal.matched, 300);
    EXPECT_GT(crystal.bound(), liquid.bound()) << "overlap costs information";
    EXPECT_GT(detection.find("border").matched, 100);
    // A checkerboard: as many above as below; the liquid has no layers.
    const auto top = detection.find("top").matched;
    const auto bottom = detection.find("bottom").matched;
    EXPECT_NEAR(static_cast<double>(top) / static_cast<double>(top + bottom), 0.5, 0.1);
    EXPECT_GT(outcome.tracks.alpha, 0.9);
    EXPECT_GT(outcome.tracks.correct_link_fraction(), 0.99);
    EXPECT_LT(outcome.scores.q4_rms(), 0.1);
    // Every true particle at least D inside is in one bin of distance, if nearer than 1.2 a.
    std::int64_t binned = 0;
    for (std::size_t b = 0; b < kDistanceBins; ++b) {
        binned += detection.classes()[kTruthClasses + b].matched;
    }
    EXPECT_GT(binned, 0.95 * static_cast<double>(all.matched));
    EXPECT_LE(binned, all.matched);
}

TEST(Validation, WarnsOfATruthThatIsThatOfOtherFrames) {
    const auto codes = [](sample::Film film) {
        RunPlan plan;
        validated(film, plan);
        std::vector<WarningCode> found;
        for (const Warning& warning : plan.warnings()) found.push_back(warning.code);
        return found;
    };
    EXPECT_THAT(codes(sample::film(1)), Not(Contains(WarningCode::other_truth)));
    for (const Vec2 shift : {Vec2{4, 4}, Vec2{40, 0}}) {
        sample::Film film = sample::film(1);
        StoredTrajectory shifted;
        shifted.set_info(film.truth.info());
        Snapshot truth = film.truth.read(0);
        for (Vec2& p : truth.position) p += shift;
        shifted.write(truth);
        film.truth = std::move(shifted);
        EXPECT_THAT(codes(std::move(film)), Contains(WarningCode::other_truth)) << shift.x;
    }
}

TEST(Validation, AnalysesTheTrueAndTheTrackedPositionsAlike) {
    sample::Film film = sample::film(8);
    RunPlan plan;
    const ValidationOutcome outcome = validated(film, plan);
    ASSERT_EQ(outcome.runs.size(), 2U);
    EXPECT_EQ(outcome.runs[0].label, "true");
    EXPECT_EQ(outcome.runs[0].frames, outcome.runs[1].frames);
    EXPECT_EQ(outcome.runs[0].source.diameter, outcome.runs[1].source.diameter);
    EXPECT_EQ(outcome.runs[0].box, outcome.runs[1].box);
    EXPECT_EQ(outcome.runs[1].previews.size(), 1U);
    ASSERT_FALSE(outcome.effects.empty());
    std::map<std::string, DownstreamEffect> effects;
    for (const DownstreamEffect& e : outcome.effects) effects[e.name] = e;
    EXPECT_NEAR(effects.at("q4_mean").tracked, effects.at("q4_mean").truth, 0.02);
    EXPECT_NEAR(effects.at("solid_fraction").tracked, effects.at("solid_fraction").truth, 0.03);
    EXPECT_NEAR(effects.at("s_low_k").tracked / effects.at("s_low_k").truth, 1, 0.2);
    EXPECT_LT(effects.at("sk_deviation").tracked, 0.2);
    // Whoever renames a measurement of the analysis hears of it here.
    for (const DownstreamEffect& e : outcome.effects) {
        EXPECT_THAT(e.reason, ::testing::Not(::testing::HasSubstr("has no measurement"))) << e.name;
        EXPECT_THAT(e.reason, ::testing::Not(::testing::HasSubstr("has no observable"))) << e.name;
    }
    ASSERT_TRUE(effects.contains("s0_over_s1") && effects.contains("alpha"));
    EXPECT_TRUE(std::isfinite(effects.at("s0_over_s1").tracked) ||
                !effects.at("s0_over_s1").reason.empty());
    EXPECT_TRUE(std::isfinite(outcome.msd_offset));
    EXPECT_GT(outcome.predicted_msd_offset, 0);
}

TEST(Validation, FitsTheStructureFactorOfTrueAndTrackedPositionsInTheRangeGiven) {
    sample::Film film = sample::film(7);  // below eight frames count as independent
    RunPlan plan;
    ValidationSettings settings;
    settings.threads = 2;
    settings.verbosity = Verbosity::quiet;
    settings.fit.k_max = 1.9;
    settings.fit.bootstrap = 40;
    tracking::TrackSummary summary;
    const ValidationOutcome outcome =
        validate({*film.frames, film.truth, 12.0, 30.0}, settings, summary, plan);
    std::map<std::string, DownstreamEffect> effects;
    for (const DownstreamEffect& e : outcome.effects) effects[e.name] = e;
    for (const char* name : {"s0_over_s1", "s0", "s1", "alpha", "s0_over_s1_free_alpha"}) {
        EXPECT_TRUE(std::isfinite(effects.at(name).truth)) << effects.at(name).reason;
        EXPECT_TRUE(std::isfinite(effects.at(name).tracked)) << effects.at(name).reason;
    }
    EXPECT_NEAR(effects.at("s0").tracked, effects.at("s0").truth, 0.05);
}

TEST(Validation, ComparesByTheKeysOfTheAnalysis) {
    sample::Film film = sample::film(1);
    RunPlan plan;
    ValidationOutcome outcome = validated(film, plan);
    ObservableResult fit{
        .name = "fit", .measurements = {}, .curves = {}, .options = {}, .reason = {}};
    fit.measurements = {{"s0_over_s1", "-", 0.25, 0.05, 10, ""}, {"s0", "-", {}, {}, 0, "too few"}};
    for (Results& run : outcome.runs) {
        std::erase_if(run.observables, [](const auto& o) { return o.name == "fit"; });
        run.observables.push_back(fit);
        fit.measurements[0].value = 0.20;
    }
    outcome.free_fits = {fit, fit};
    compare_downstream(outcome);
    std::map<std::string, DownstreamEffect> effects;
    for (const DownstreamEffect& e : outcome.effects) effects[e.name] = e;
    EXPECT_EQ(effects.at("s0_over_s1").truth, 0.25);
    EXPECT_EQ(effects.at("s0_over_s1").tracked, 0.20);
    EXPECT_EQ(effects.at("s0_over_s1").error, 0.05);
    EXPECT_EQ(effects.at("s0").reason, "too few");
    EXPECT_TRUE(std::isnan(effects.at("s0").tracked));
    EXPECT_EQ(effects.at("alpha").reason, "'free fit' has no measurement 'alpha'");
    EXPECT_EQ(effects.at("s0_over_s1_free_alpha").tracked, 0.20);
}

TEST(Validation, RefusesWhatDoesNotFitIntoMemory) {
    EXPECT_NO_THROW(require_memory(1e6, 1e9));
    EXPECT_NO_THROW(require_memory(1e12, std::numeric_limits<double>::infinity())) << "unknown";
    EXPECT_THROW(require_memory(1e6, 0), OptionError) << "all of it is taken";
    try {
        require_memory(1e8, 1e9);
        ADD_FAILURE();
    } catch (const OptionError& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("20 GB"));
        EXPECT_THAT(error.what(), ::testing::HasSubstr("fewer frames"));
    }
}

TEST(Validation, AMissingFrameCostsItsParticles) {
    sample::Film whole = sample::film(5);
    sample::Film gap = sample::film(5, 300, 12, 2);
    RunPlan plan;
    const auto a = validated(whole, plan);
    const auto b = validated(gap, plan);
    const auto& all = b.scores.detection().find("all");
    EXPECT_EQ(b.scores.detection().frames(), 5);
    EXPECT_NEAR(all.recall(), 0.8 * a.scores.detection().find("all").recall(), 0.01);
    EXPECT_GT(b.tracks.fragments, 500) << "found again after the gap";
    EXPECT_LT(b.tracks.switches, 0.02 * static_cast<double>(b.tracks.fragments));
}

TEST(Validation, DoesNotDependOnTheNumberOfThreads) {
    sample::Film film = sample::film(2);
    RunPlan plan;
    const auto one = validated(film, plan, 1);
    const auto three = validated(film, plan, 3);
    for (std::size_t c = 0; c < one.scores.detection().classes().size(); ++c) {
        const auto& a = one.scores.detection().classes()[c];
        const auto& b = three.scores.detection().classes()[c];
        EXPECT_EQ(a.matched, b.matched);
        EXPECT_EQ(a.square_sum, b.square_sum);
        EXPECT_EQ(a.bound_squares, b.bound_squares);
    }
    EXPECT_EQ(one.tracks.alpha, three.tracks.alpha);
}

TEST(Validation, WithoutAnythingToCalibrateOnIsAFailedCheck) {
    std::vector<Frame> blank(2);
    for (Frame& f : blank) f.image = Image(64, 64, 100);
    sample::FilmFrames frames(blank);
    sample::Film film = sample::film(1);
    RunPlan plan;
    tracking::TrackSummary summary;
    EXPECT_THROW(validate({frames, film.truth, {}, {}}, {}, summary, plan), PhysicsError);
}

TEST(Validation, ThresholdsAreCheckedInBothDirections) {
    sample::Film film = sample::film(2);
    RunPlan plan;
    const ValidationOutcome outcome = validated(film, plan);
    ValidationThresholds thresholds;
    EXPECT_TRUE(check(thresholds, outcome).empty());
    thresholds.recall = 0.5;
    thresholds.rmse = 1e-6;
    const auto checks = check(thresholds, outcome);
    ASSERT_EQ(checks.size(), 2U);
    EXPECT_TRUE(checks[0].met());
    EXPECT_FALSE(checks[1].met());
    EXPECT_THAT(checks[1].text(), ::testing::HasSubstr("at most 1e-06 asked for"));
    const ThresholdCheck unmeasured{"bound-ratio", "-", 2, std::nan(""), false};
    EXPECT_FALSE(unmeasured.met()) << "what could not be measured is not met";
}

TEST(Validation, TheReportHoldsAllScores) {
    sample::Film film = sample::film(6);
    RunPlan plan;
    const ValidationOutcome outcome = validated(film, plan);
    ValidationThresholds thresholds;
    thresholds.recall = 1;
    const auto additions = validation_report(outcome, check(thresholds, outcome));
    ASSERT_EQ(additions.tables.size(), 4U);
    for (const report::Table& table : additions.tables) {
        for (const auto& row : table.rows) EXPECT_EQ(row.cells.size(), table.columns.size());
    }
    EXPECT_EQ(additions.tables[1].rows.size(), kTruthClasses);
    for (const report::Figure& figure : additions.figures) {
        EXPECT_TRUE(figure.has_data()) << figure.name;
    }
    const testing::ScratchFolder folder;
    report::write_report(outcome.runs, {"Validation", true}, folder / "r.html", folder / "figures",
                         plan, additions);
    EXPECT_TRUE(std::filesystem::exists(folder / "figures/scores.csv"));
    EXPECT_TRUE(std::filesystem::exists(folder / "figures/pixel_locking.csv"));
}

TEST(Validation, FiguresOfBothRunsHaveTheUnitOfTheirTimesAndTheCurveOfTheirNotes) {
    sample::Film film = sample::film(4);
    RunPlan plan;
    ValidationOutcome outcome = validated(film, plan);
    // As of spheres of which chance has left nine in ten.
    constexpr double p = 0.9;
    std::vector<double> truth;
    for (ObservableResult& observable : outcome.runs[1].observables) {
        if (observable.name != "sk") continue;
        for (Curve& curve : observable.curves) {
            if (curve.name != "sk") continue;
            for (Column& column : curve.columns) {
                if (column.name != "s") continue;
                column.values = outcome.runs[0].find("sk")->find_curve("sk")->find("s")->values;
                truth = column.values;
                for (double& s : column.values) s = p * s + 1 - p;
            }
        }
    }
    const auto figures = validation_report(outcome, {}).figures;
    const auto figure = [&](const char* name) {
        return *std::ranges::find(figures, name, &report::Figure::name);
    };
    EXPECT_EQ(figure("msd_offset").x.title(), "Lag time t [s]");
    const std::vector<double> ratio = figure("sk_ratio").series.at(0).y;
    ASSERT_EQ(ratio.size(), truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const double expected = p + (1 - p) / truth[i];
        EXPECT_NEAR(ratio[i] / expected, 1, 1e-12);
    }
    outcome.runs[0].source.time_unit = TimeUnit::frame;
    EXPECT_EQ(validation_report(outcome, {}).figures[4].x.title(), "Lag time t [frame]");
}

TEST(Validation, WordsStandForWhatCouldNotBeMeasured) {
    // Three spheres: nearly every bin of the sub-pixel phase is empty.
    ScoredView view;
    view.width = view.height = 200;
    view.sphere_diameter = view.disc.diameter = 12;
    ValidationScores scores(view);
    Snapshot few;
    few.position = {{60, 60}, {100.3, 100.2}, {140.4, 60.1}};
    few.id = {0, 1, 2};
    few.box = {{-0.5, -0.5}, {200, 200}, {}, 0};
    scores.add(few, few);
    ValidationOutcome outcome{.scores = scores,
                              .tracks = scores.tracks(),
                              .runs = {},
                              .free_fits = {},
                              .effects = {},
                              .msd_offset = std::nan(""),
                              .predicted_msd_offset = std::nan("")};
    ASSERT_TRUE(std::isnan(scores.detection().pixel_locking(0).amplitude));
    const ThresholdCheck unmeasured{"bound-ratio", "-", 2, std::nan(""), false};
    for (const report::Table& table : validation_report(outcome, {unmeasured}).tables) {
        for (const auto& row : table.rows) {
            for (const report::TableCell& cell : row.cells) {
                EXPECT_EQ(cell.text.find("nan"), std::string::npos) << row.name << cell.text;
            }
        }
    }
    EXPECT_EQ(unmeasured.text(), "bound-ratio not measured, at most 2 asked for");
}

TEST(Validation, TruthsInWholePixelsAreRecognisedAndSaid) {
    sample::Film film = sample::film(2);
    {
        RunPlan plan;
        EXPECT_FALSE(validated(film, plan).truth_is_whole);
    }
    film.truth = rounded(film.truth);
    RunPlan plan;
    const ValidationOutcome outcome = validated(film, plan);
    EXPECT_TRUE(outcome.truth_is_whole);
    const auto additions = validation_report(outcome, {});
    EXPECT_THAT(additions.verdict, ::testing::HasSubstr("whole-pixel truths may make 0.29 px"));
    EXPECT_TRUE(std::ranges::any_of(plan.warnings(), [](const Warning& warning) {
        return warning.text.starts_with("all true positions are whole pixels");
    }));
    // Uniform rounding has the variance 1/12 per axis; 600 positions know it to 3 %.
    EXPECT_GT(outcome.scores.detection().find("all").rmse_per_axis(), 0.26);
}

const report::Table& table_of(const report::ReportAdditions& additions, const std::string& name) {
    return *std::ranges::find(additions.tables, name, &report::Table::name);
}

std::vector<std::string> rows_of(const report::Table& table) {
    std::vector<std::string> names;
    for (const auto& row : table.rows) names.push_back(row.name);
    return names;
}

TEST(Validation, OfOneFrameSaysInOneLineWhatOneFrameCannotGive) {
    sample::Film film = sample::film(1);
    RunPlan plan;
    const auto additions = validation_report(validated(film, plan), {});
    const report::Table& tracks = table_of(additions, "track_scores");
    EXPECT_THAT(tracks.note, ::testing::HasSubstr("Not possible with one frame: α, β, JSC"));
    EXPECT_THAT(rows_of(tracks), Not(Contains("α")));
    EXPECT_THAT(rows_of(tracks), Contains("pixel locking x [px]"));
    const report::Table& effects = table_of(additions, "downstream");
    EXPECT_THAT(effects.note,
                AllOf(::testing::HasSubstr("Not possible with one frame: Diffusion coefficient"),
                      ::testing::HasSubstr("S₀/S₁"), ::testing::HasSubstr("S at the lowest k")));
    EXPECT_THAT(rows_of(effects), Not(Contains(::testing::HasSubstr("S₀"))));
    EXPECT_THAT(rows_of(effects), Not(Contains(::testing::HasSubstr("Diffusion"))));
    EXPECT_THAT(rows_of(effects), Contains("Mean |Q₄|"));
    sample::Film longer = sample::film(6);
    const auto whole = validation_report(validated(longer, plan), {});
    EXPECT_THAT(rows_of(table_of(whole, "track_scores")), Contains("α"));
    EXPECT_THAT(rows_of(table_of(whole, "downstream")),
                Contains(::testing::HasSubstr("Diffusion")));
}

TEST(Validation, ABoundThatIsNoMeasureIsExplained) {
    sample::Film film = sample::film(2);
    RunPlan plan;
    const ValidationOutcome foreign = validated(film, plan);
    ASSERT_GT(foreign.scores.detection().find("all").bound_ratio(), 3) << "of another camera";
    EXPECT_THAT(bound_caveat(foreign), ::testing::HasSubstr("other optics"));
    EXPECT_THAT(table_of(validation_report(foreign, {}), "scores").note,
                ::testing::HasSubstr("The Cramér–Rao bound of 0.00"));
    film.truth = rounded(film.truth);
    EXPECT_THAT(bound_caveat(validated(film, plan)),
                ::testing::EndsWith("as truths rounded to whole pixels make 0.29 px"));
}

TEST(Validation, ABoundThatIsAMeasureNeedsNoWords) {
    sample::Film film = sample::film(1);
    RunPlan plan;
    ValidationOutcome outcome = validated(film, plan);
    ScoredView view = outcome.scores.view();
    view.noise *= 10;
    outcome.scores = ValidationScores(view);
    Snapshot truth = film.truth.read(0);
    outcome.scores.add(truth, truth);
    EXPECT_EQ(bound_caveat(outcome), "") << "no error at all";
    view.noise = 0;
    outcome.scores = ValidationScores(view);
    outcome.scores.add(truth, truth);
    EXPECT_EQ(bound_caveat(outcome), "") << "no bound";
}

TEST(Validation, WritesNoNanOntoThePage) {
    for (const int frames : {1, 2}) {
        sample::Film film = sample::film(frames);
        film.truth = rounded(film.truth);
        RunPlan plan;
        const ValidationOutcome outcome = validated(film, plan);
        const auto additions = validation_report(outcome, {});
        for (const report::Table& table : additions.tables) {
            EXPECT_THAT(table.note, Not(::testing::HasSubstr("nan"))) << table.name;
            for (const auto& row : table.rows) {
                for (const report::TableCell& cell : row.cells) {
                    EXPECT_THAT(cell.text, Not(::testing::HasSubstr("nan"))) << row.name;
                }
            }
        }
        for (const report::Figure& figure : additions.figures) {
            if (figure.name != "pixel_locking") continue;
            EXPECT_FALSE(figure.has_data()) << "one phase";
        }
    }
}

TEST(Validation, ThePageBeginsWithWhatIsMissedAndFalseAndMarksIt) {
    sample::Film film = sample::film(6);
    RunPlan plan;
    ValidationOutcome outcome = validated(film, plan);
    ASSERT_FALSE(outcome.runs[1].previews.empty());
    Snapshot& truth = outcome.runs[0].previews[0].snapshot;
    Snapshot& found = outcome.runs[1].previews[0].snapshot;
    // One that was found is not there, and another was not found.
    found.position = truth.position;
    found.quality.clear();
    const Vec2 missed = truth.position[3];
    const Vec2 wrong = truth.position[5];
    found.position.erase(found.position.begin() + 3);
    truth.position.erase(truth.position.begin() + 5);
    outcome.runs[0].previews.resize(1);
    outcome.runs[1].previews.resize(1);
    ValidationThresholds thresholds;
    thresholds.recall = 2;  // no scene can
    const auto additions = validation_report(outcome, check(thresholds, outcome));
    EXPECT_THAT(additions.verdict, ::testing::HasSubstr(" missed, "));
    EXPECT_THAT(additions.verdict, ::testing::EndsWith("; 1 of 1 thresholds not met"));
    ASSERT_EQ(additions.marked.size(), 2U);
    EXPECT_EQ(additions.marked[0].words, "missed");
    EXPECT_EQ(additions.marked[0].position, missed);
    EXPECT_EQ(additions.marked[1].words, "false");
    EXPECT_EQ(additions.marked[1].position, wrong);
    EXPECT_EQ(additions.marked[1].run, 1U);
    EXPECT_EQ(additions.marked[1].frame, found.frame);
}

TEST(ClassifyTruth, SortsByPlaceOrderAndLayer) {
    ScoredView view;
    view.width = view.height = 100;
    view.sphere_diameter = 10;
    view.disc = {8, 1};
    Snapshot truth;
    truth.box = {{-0.5, -0.5}, {100, 100}, {}, 0};
    truth.position = {{50, 50}, {50, 58}, {80, 20}, {1, 50}, {5, 70}, {-3, 20}};
    truth.layer = {Layer::top, Layer::bottom, Layer::unknown, Layer::top, Layer::top, Layer::top};
    const auto frame = classify_truth(truth, view, {0.9, 0.2, NAN, 1, 1, 1});
    const auto has = [&](std::size_t i, TruthClass c) {
        return ((frame.classes[i] >> static_cast<unsigned>(c)) & 1U) == 1;
    };
    EXPECT_TRUE(has(0, TruthClass::all) && has(0, TruthClass::crystal) && has(0, TruthClass::top));
    EXPECT_TRUE(has(1, TruthClass::liquid) && has(1, TruthClass::bottom));
    EXPECT_FALSE(has(0, TruthClass::isolated)) << "8 px from the next";
    EXPECT_TRUE(has(2, TruthClass::isolated) && has(2, TruthClass::liquid));
    EXPECT_FALSE(has(2, TruthClass::top) || has(2, TruthClass::bottom));
    EXPECT_EQ(frame.classes[3], 0U) << "1 px inside: the tracker reports nothing there";
    EXPECT_EQ(frame.classes[4], std::uint64_t{1} << static_cast<unsigned>(TruthClass::border));
    EXPECT_EQ(frame.classes[5], 0U);
    // 8 px = 0.80 a: the bin from 0.80.
    EXPECT_TRUE((frame.classes[0] >> (kTruthClasses + 10)) & 1U);
    EXPECT_TRUE(frame.bound.empty()) << "the noise is unknown";
}

}  // namespace
}  // namespace grainfield::pipelines
