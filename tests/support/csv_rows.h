#pragma once

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace grainfield::testing {

/// The lines of a table without quotes, column name → value; lines that begin with # are left out.
inline std::vector<std::map<std::string, std::string>> csv_rows(const std::string& path) {
    std::istringstream csv(read_all(path));
    std::vector<std::string> names;
    std::vector<std::map<std::string, std::string>> rows;
    for (std::string line; std::getline(csv, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::vector<std::string> fields;
        std::istringstream text(line);
        for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
        if (names.empty()) {
            names = fields;
            continue;
        }
        fields.resize(names.size());
        auto& row = rows.emplace_back();
        for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = fields[i];
    }
    return rows;
}

}  // namespace grainfield::testing
