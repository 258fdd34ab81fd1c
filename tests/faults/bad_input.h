#pragma once

#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::testing {

/// Files that are not what a command expects.
class BadInput : public ::testing::Test {
 protected:
    ScratchFolder folder_;
    ScratchFolder out_;

    // Every command refuses the file with code 3, names it, and leaves nothing behind.
    void expect_refused_by_all(const std::string& input) {
        const std::vector<std::vector<std::string>> calls{{"track", input, "-o", out_ / "t.h5"},
                                                          {"analyze", input, "-o", out_ / "r.h5"},
                                                          {"compare", input, "-o", out_ / "r.html"},
                                                          {"export", input, "-o", out_ / "x.csv"},
                                                          {"info", input}};
        for (const auto& words : calls) {
            const Outcome outcome = run_grainfield(words);
            EXPECT_EQ(outcome.code, 3) << words[0] << " " << input << ": " << outcome.err;
            EXPECT_THAT(outcome.err, ::testing::HasSubstr(input));
            EXPECT_EQ(outcome.out, "");
            EXPECT_EQ(out_.entries(), 0U) << words[0];
        }
    }

    std::string write(const std::string& name, const std::string& content) {
        const std::string path = folder_ / name;
        std::ofstream(path, std::ios::binary) << content;
        return path;
    }
};

}  // namespace grainfield::testing
