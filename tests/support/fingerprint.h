#pragma once

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace grainfield::testing {

/// The digest of all data in a file, without the record of the run, as `info` prints it.
inline std::string fingerprint(const std::string& file) {
    const Outcome outcome = run_grainfield({"info", file, "--fingerprint", "--json"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    if (outcome.code != 0) return "";
    return nlohmann::json::parse(outcome.out).value("fingerprint", "");
}

}  // namespace grainfield::testing
