#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/fuzz/mutation.h"
#include "tests/fuzz/readers.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"

namespace grainfield::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kMostSeconds = 20;  // for one input, on a loaded machine

std::vector<fs::path> seed_files(std::string_view reader) {
    std::vector<fs::path> files;
    for (const auto& entry :
         fs::directory_iterator(fs::path(GRAINFIELD_SOURCE_DIR) / "tests/faults/corpus" / reader)) {
        files.push_back(entry.path());
    }
    std::ranges::sort(files);
    return files;
}

/// An input that takes too long ends the test with SIGALRM, one that wants 4 GB with bad_alloc.
class FuzzedInput : public ::testing::TestWithParam<Reader> {
 protected:
    void SetUp() override {
        if (testing::kIsSanitized) return;
        rlimit limit{};
        ::getrlimit(RLIMIT_AS, &limit);
        limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, rlim_t{4} << 30U);
        ASSERT_EQ(::setrlimit(RLIMIT_AS, &limit), 0);
    }
    void TearDown() override { ::alarm(0); }

    static bool is_taken(const std::string& bytes, const std::string& what) {
        ::alarm(kMostSeconds);
        try {
            return GetParam().read(bytes);
        } catch (const std::exception& fault) {
            const std::string kept = ::testing::TempDir() + "grainfield-fault-" +
                                     std::string(GetParam().name) + "-" + std::to_string(getpid());
            std::ofstream(kept, std::ios::binary) << bytes;
            ADD_FAILURE() << what << ": " << fault.what() << "\nkept as " << kept;
            return false;
        }
    }
};

TEST_P(FuzzedInput, SeedsAreTakenUnlessTheyAreNamedBad) {
    for (const fs::path& file : seed_files(GetParam().name)) {
        const bool is_good = !file.filename().string().starts_with("bad-");
        EXPECT_EQ(is_taken(testing::read_all(file), file.string()), is_good)
            << file << "\nIf the format has changed on purpose, run scripts/make-fuzz-seeds.";
    }
}

TEST_P(FuzzedInput, DamagedOnesAreTakenOrRefusedWithTheirName) {
    std::vector<std::string> seeds;
    for (const fs::path& file : seed_files(GetParam().name)) {
        seeds.push_back(testing::read_all(file));
    }
    ASSERT_FALSE(seeds.empty());
    // For a longer search without clang: how many inputs.
    const char* const wanted = std::getenv("GRAINFIELD_FUZZ_INPUTS");
    const int inputs = wanted != nullptr ? std::stoi(wanted) : GetParam().inputs;
    RandomStream random(1, GetParam().name);
    int taken = 0;
    for (int i = 0; i < inputs && !HasFailure(); ++i) {
        taken += is_taken(mutated(seeds, random), "input " + std::to_string(i)) ? 1 : 0;
    }
    RecordProperty("taken", taken);
    // All alike would mean that nothing behind the first check was tried.
    EXPECT_LT(taken, inputs);
}

INSTANTIATE_TEST_SUITE_P(Reader, FuzzedInput,
                         ::testing::ValuesIn(readers().begin(), readers().end()),
                         [](const auto& reader) { return std::string(reader.param.name); });

TEST(Mutation, IsTheSameForTheSameStreamAndOtherwiseNot) {
    const std::vector<std::string> seeds{"one 12 two 34", std::string(100, 'x')};
    RandomStream first(1, "test"), second(1, "test");
    std::vector<std::string> copies;
    for (int i = 0; i < 50; ++i) {
        copies.push_back(mutated(seeds, first));
        EXPECT_EQ(copies.back(), mutated(seeds, second));
    }
    std::ranges::sort(copies);
    EXPECT_GT(std::unique(copies.begin(), copies.end()) - copies.begin(), 40);
}

}  // namespace
}  // namespace grainfield::fuzz
