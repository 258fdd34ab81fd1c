#include "app/config_file.h"

#include <fstream>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/errors.h"

namespace grainfield::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ConfigFile : public testing::Test {
 protected:
    int threads_ = 0;
    bool strict_ = false;
    std::string label_;
    std::optional<double> diameter_;
    std::optional<double> fps_;
    std::vector<std::int64_t> lags_;
    std::vector<std::string> observables_;
    std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) /
                                  ("grainfield-config-" + std::to_string(getpid()) + ".toml");

    void TearDown() override { std::filesystem::remove(path_); }

    OptionSet options() {
        OptionTable own("");
        own.integer("threads", threads_, "-", {0, 64}, "threads");
        own.flag("strict", strict_, "strict");
        own.text("label", label_, "label");
        own.integers("lags", lags_, "frames", {.minimum = 1}, "lags");
        own.names("observables", observables_, {"q4", "sk"}, "observables");
        OptionTable detect("detect");
        detect.number("diameter", diameter_, "px", {3, 400}, "diameter");
        detect.number("fps", fps_, "1/s", {1e-9, 1e9}, "frame rate");
        return {"track", {own, detect}};
    }

    void apply(const std::string& text) {
        std::ofstream(path_) << text;
        apply_config_file(path_, options());
    }

    std::string refusal(const std::string& text) {
        try {
            apply(text);
        } catch (const OptionError& error) {
            return error.what();
        }
        return "nothing was thrown";
    }
};

TEST_F(ConfigFile, SetsCommandWideKeysAtTheTopAndSectionKeys) {
    apply("threads = 2\nstrict = true\nlabel = \"A = 4\"\n[detect]\ndiameter = 9\n");
    EXPECT_EQ(threads_, 2);
    EXPECT_TRUE(strict_);
    EXPECT_EQ(label_, "A = 4");
    EXPECT_EQ(diameter_, 9.0);
}

TEST_F(ConfigFile, TakesCommandWideKeysInTheSectionOfTheCommandToo) {
    apply("[track]\nthreads = 3\n[detect]\ndiameter = \"auto\"\n");
    EXPECT_EQ(threads_, 3);
    EXPECT_EQ(diameter_, std::nullopt);
}

TEST_F(ConfigFile, ANumberMayStandWithItsUnitInAText) {
    apply("[detect]\ndiameter = \"10.09 px\"\n");
    EXPECT_EQ(diameter_, 10.09);
    EXPECT_THAT(refusal("[detect]\ndiameter = \"1mm\"\n"), HasSubstr("[px]"));
}

TEST_F(ConfigFile, ARateIsReadWholeBeforeItsUnit) {
    for (const char* text : {"500/s", "500 1/s", "500Hz", "500 Hz", "500fps"}) {
        apply(std::string("[detect]\nfps = \"") + text + "\"\n");
        EXPECT_EQ(fps_, 500.0) << text;
    }
    apply("[detect]\nfps = \"5001/s\"\n");
    EXPECT_EQ(fps_, 5001.0) << "not 500 in 1/s";
    EXPECT_THAT(refusal("[detect]\nfps = \"500px\"\n"), HasSubstr("[1/s]"));
}

TEST_F(ConfigFile, AnUnknownKeyIsRefusedWithFileLineAndNearestKey) {
    EXPECT_THAT(
        refusal("threads = 2\n\n[detect]\ndiamter = 9\n"),
        AllOf(HasSubstr(path_.string()), HasSubstr("line 4"),
              HasSubstr("key 'diamter' in [detect]"), HasSubstr("did you mean 'diameter'?")));
    EXPECT_THAT(refusal("thread = 2\n"),
                AllOf(HasSubstr("line 1"), HasSubstr("did you mean 'threads'?")));
    EXPECT_THAT(refusal("[dtect]\ndiameter = 9\n"),
                AllOf(HasSubstr("line 1"), HasSubstr("[dtect]"), HasSubstr("'detect'")));
}

TEST_F(ConfigFile, ASectionKeyAtTheTopIsUnknown) {
    EXPECT_THAT(refusal("diameter = 9\n"), HasSubstr("unknown key 'diameter'"));
}

TEST_F(ConfigFile, NanWrongKindAndOutOfRangeAreRefusedWithTheirLine) {
    EXPECT_THAT(refusal("[detect]\ndiameter = nan\n"),
                AllOf(HasSubstr("line 2"), HasSubstr("'nan'"), HasSubstr("3 … 400 [px]")));
    EXPECT_THAT(refusal("[detect]\ndiameter = 2.5\n"), HasSubstr("'2.5'"));
    EXPECT_THAT(refusal("[detect]\ndiameter = \"big\"\n"), HasSubstr("'big'"));
    EXPECT_THAT(refusal("strict = 1\n"), HasSubstr("true or false"));
    EXPECT_THAT(refusal("threads = 2.0\n"), HasSubstr("an integer"));
    EXPECT_THAT(refusal("\nthreads = [1, 2]\n"),
                AllOf(HasSubstr("line 2"), HasSubstr("a list, table or date")));
    EXPECT_EQ(diameter_, std::nullopt);
}

TEST_F(ConfigFile, AListIsATomlArrayATextOrOneValue) {
    apply("lags = [1, 10]\nobservables = [\"sk\", \"q4\"]\n");
    EXPECT_EQ(lags_, (std::vector<std::int64_t>{1, 10}));
    EXPECT_EQ(observables_, (std::vector<std::string>{"sk", "q4"}));
    apply("lags = \"2,20\"\nobservables = \"q4\"\n");
    EXPECT_EQ(lags_, (std::vector<std::int64_t>{2, 20}));
    EXPECT_EQ(observables_, std::vector<std::string>{"q4"});
    apply("lags = 3\n");
    EXPECT_EQ(lags_, std::vector<std::int64_t>{3});
    EXPECT_THAT(refusal("lags = [1, 0]\n"), AllOf(HasSubstr("line 1"), HasSubstr("'0' in '1,0'")));
    EXPECT_THAT(refusal("lags = [1, [2]]\n"), HasSubstr("expected a list such as"));
    EXPECT_THAT(refusal("observables = [\"q4,sk\"]\n"), HasSubstr("expected a list such as"));
}

TEST_F(ConfigFile, TextThatIsNotTomlIsRefusedWithItsLine) {
    EXPECT_THAT(refusal("threads = 2\nthis is no toml\n"),
                AllOf(HasSubstr("line 2"), HasSubstr("not valid TOML")));
}

// toml++ 3.3 ends the process at these by an assertion.
TEST_F(ConfigFile, TextAtWhichTheParserStumblesIsRefusedWithItsLine) {
    EXPECT_THAT(refusal("[+]"), AllOf(HasSubstr("line 1:"), HasSubstr("not valid TOML")));
    EXPECT_THAT(refusal("threads = 2\n\n[detect]\ndiameter = 9\n[%]\nthreads = 3\n"),
                AllOf(HasSubstr("line 5:"), HasSubstr("not valid TOML")));
}

TEST_F(ConfigFile, AFileThatCannotBeReadIsABadInput) {
    EXPECT_THROW(apply_config_file("/nonexistent/a.toml", options()), InputError);
    EXPECT_THROW(apply_config_file(testing::TempDir(), options()), InputError);
}

TEST_F(ConfigFile, WrittenByTheProgramGivesTheSameOptionsBack) {
    apply(
        "threads = 2\nlabel = \"a \\\"b\\\" \\\\ c\"\nlags = [1, 10]\n[detect]\ndiameter = 9.5\n");
    OptionTable own("");
    own.integer("threads", threads_, "-", {0, 64}, "threads");
    own.text("label", label_, "label");
    own.integers("lags", lags_, "frames", {.minimum = 1}, "lags");
    own.flag("strict", strict_, "strict");
    OptionTable detect("detect");
    detect.number("diameter", diameter_, "px", {3, 400}, "diameter of a disc");
    threads_ = 3;
    label_ += "\n";
    diameter_ = 12.25;
    const std::string text = config_text({own, detect}, "two\nlines");
    EXPECT_THAT(text, testing::StartsWith("# two\n# lines\n"));
    EXPECT_THAT(text, HasSubstr("\nthreads = 3  # [-] threads\n"));
    EXPECT_THAT(text, HasSubstr("\n# strict = false")) << "at its default";
    EXPECT_THAT(text, HasSubstr("\ndiameter = 12.25  # [px] diameter of a disc\n"));
    const std::string label = label_;
    threads_ = 0;
    label_ = "";
    diameter_.reset();
    apply(text);
    EXPECT_EQ(threads_, 3);
    EXPECT_EQ(label_, label);
    EXPECT_EQ(diameter_, 12.25);
}

TEST_F(ConfigFile, KeepsCommandWideOptionsOutOfTheSectionsBeforeThem) {
    OptionTable detect("detect");
    detect.number("diameter", diameter_, "px", {3, 400}, "diameter");
    OptionTable own("");
    own.integer("threads", threads_, "-", {0, 64}, "threads");
    OptionTable more("detect");
    more.flag("strict", strict_, "strict");
    diameter_ = 9;
    threads_ = 5;
    strict_ = true;
    const std::string text = config_text({detect, own, more}, "");
    diameter_.reset();
    threads_ = 0;
    strict_ = false;
    std::ofstream(path_) << text;
    apply_config_file(path_, {"track", {own, detect, more}});
    EXPECT_EQ(diameter_, 9);
    EXPECT_EQ(threads_, 5);
    EXPECT_TRUE(strict_);
}

}  // namespace
}  // namespace grainfield::app
