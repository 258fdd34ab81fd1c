#include "report/text.h"

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "core/errors.h"
#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

TEST(CleanText, KeepsWellFormedTextAndReplacesTheRest) {
    EXPECT_EQ(clean_text("Γ = 4.5, σ², 🜨"), "Γ = 4.5, σ², 🜨");
    EXPECT_EQ(clean_text("a\xFF"
                         "b"),
              "a\uFFFDb");
    EXPECT_EQ(clean_text("\xC0\xAF"), "\uFFFD\uFFFD") << "overlong slash";
    EXPECT_EQ(clean_text("\xED\xA0\x80"), "\uFFFD\uFFFD\uFFFD") << "surrogate";
    EXPECT_EQ(clean_text("\xE2\x82"), "\uFFFD\uFFFD") << "cut short";
    EXPECT_EQ(clean_text(std::string("a\0b\nc\x7F", 6)), "a b c ");
    EXPECT_EQ(clean_text("\xC2\x85"), " ") << "C1 control";
}

TEST(EscapeHtml, LeavesNothingThatCouldEndATagOrAnAttribute) {
    EXPECT_EQ(escape_html(R"(</script><b a="x" c='y'>&)"),
              "&lt;/script&gt;&lt;b a=&quot;x&quot; c=&#39;y&#39;&gt;&amp;");
}

TEST(JsonString, SurvivesAParserAndCannotEndAScript) {
    for (const std::string text :
         {"</script><!--", "quote \" and \\ back", "a\u2028b\u2029c", "<>&'`", "Γ ≥ 4 😀", ""}) {
        const std::string json = json_string(text);
        EXPECT_EQ(nlohmann::json::parse(json).get<std::string>(), text);
        EXPECT_EQ(json.find_first_of("<>&"), std::string::npos) << json;
        EXPECT_EQ(json.find("\u2028"), std::string::npos);
        EXPECT_EQ(json.find("\u2029"), std::string::npos);
    }
}

TEST(Base64, MatchesTheVectorsOfRfc4648) {
    const auto encode = [](std::string_view text) {
        return base64(std::vector<std::uint8_t>(text.begin(), text.end()));
    };
    EXPECT_EQ(encode(""), "");
    EXPECT_EQ(encode("f"), "Zg==");
    EXPECT_EQ(encode("fo"), "Zm8=");
    EXPECT_EQ(encode("foo"), "Zm9v");
    EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64(bytes_of_hex("00FFfe10")), "AP/+EA==");
}

TEST(CsvCell, QuotesOnlyWhatNeedsIt) {
    EXPECT_EQ(csv_cell("plain"), "plain");
    EXPECT_EQ(csv_cell("a,\"b\""), "\"a,\"\"b\"\"\"");
    EXPECT_EQ(csv_cell("two\nlines"), "two lines");
    EXPECT_EQ(csv_cell(std::nan("")), "");
    EXPECT_EQ(csv_cell(0.125), "0.125");
}

TEST(WithError, ShowsTwoDigitsOfTheErrorAndTheValueToTheSamePlace) {
    const auto text = [](double value, double error) { return with_error(value, &error); };
    EXPECT_EQ(text(0.93123, 0.00214), "0.9312 ± 0.0021");
    EXPECT_EQ(text(12345.6, 120.0), "12350 ± 120");
    EXPECT_EQ(text(56789, 1234), "56800 ± 1200");
    EXPECT_EQ(text(123.4, 9.96), "123 ± 10");
    EXPECT_EQ(text(1.2345e-5, 2.1e-7), "(1.234 ± 0.021) × 10⁻⁵");
    EXPECT_EQ(text(0, 0.5), "0.00 ± 0.50");
    EXPECT_EQ(text(0.5, std::nan("")), "0.5");
    EXPECT_EQ(text(0.5, 0), "0.5");
    EXPECT_EQ(with_error(3.14159, nullptr), "3.142");
    EXPECT_EQ(with_error(2.5e7, nullptr), "2.5 × 10⁷");
    EXPECT_EQ(with_error(std::nan(""), nullptr), "–");
}

TEST(OrderSymbol, FollowsTheSymmetryThatWasMeasured) {
    Results run;
    EXPECT_EQ(order_symbol(run), "|Q₄|");
    ObservableResult q4;
    q4.name = "q4";
    q4.options = {{"symmetry", std::int64_t{6}}};
    run.observables = {q4};
    EXPECT_EQ(order_symbol(run), "|Q₆|");
}

TEST(CountText, GroupsThousands) {
    EXPECT_EQ(count_text(0), "0");
    EXPECT_EQ(count_text(999), "999");
    EXPECT_EQ(count_text(1234567), "1,234,567");
    EXPECT_EQ(count_text(-1000), "-1,000");
    EXPECT_EQ(count_text(10156.4), "10,156");
    EXPECT_EQ(count_text(12.346), "12.35");
}

TEST(WriteFile, ReplacesTheTargetAndLeavesNoPart) {
    const sample::TemporaryFolder folder("write_file");
    write_file(folder / "x.txt", "old");
    write_file(folder / "x.txt", "new");
    std::stringstream content;
    content << std::ifstream(folder / "x.txt").rdbuf();
    EXPECT_EQ(content.str(), "new");
    EXPECT_FALSE(std::filesystem::exists(folder / "x.txt.part"));
}

TEST(WriteFile, SaysWhereItCouldNotWrite) {
    const sample::TemporaryFolder folder("write_file_error");
    try {
        write_file(folder / "absent" / "x.txt", "text");
        FAIL() << "no exception";
    } catch (const OutputError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("absent/x.txt"));
        EXPECT_THAT(error.what(), testing::HasSubstr("there is no folder"));
    }
}

TEST(WriteFile, LeavesNothingBehindWhereTheDiskIsFull) {
    // Files may grow to 1,000 bytes: to the writer the same as a full disk.
    const sample::TemporaryFolder folder("full_disk");
    struct rlimit before = {};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    struct rlimit little = before;
    little.rlim_cur = 1000;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
    EXPECT_THROW(write_file(folder / "x.txt", std::string(1 << 20, 'x')), OutputError);
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_FALSE(std::filesystem::exists(folder / "x.txt"));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 0);
}

}  // namespace
}  // namespace grainfield::report
