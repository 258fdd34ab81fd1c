#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/results.h"

namespace grainfield::io {

/// The JSON texts that trajectory and results files carry. Doubles are written so that they read
/// back bit for bit; NaN and infinities as the texts "nan", "inf", "-inf". The `*_from_json`
/// functions and parse_json throw InputError("'<file>' …") if the text is not what was written.
nlohmann::json to_json(const RunRecord& record);
nlohmann::json to_json(const TrajectoryInfo& info);
nlohmann::json to_json(const RunIdentity& identity);
nlohmann::json to_json(const Box& box);
nlohmann::json to_json(double number);
nlohmann::json to_json(const std::optional<double>& number);

/// Records and descriptions without identities are of the program up to 0.1: see legacy_identity.h
/// for what completes them.
RunRecord record_from_json(const nlohmann::json& json, const std::string& file);
TrajectoryInfo info_from_json(const nlohmann::json& json, const std::string& file);
RunIdentity identity_from_json(const nlohmann::json& json, const std::string& file);
Box box_from_json(const nlohmann::json& json, const std::string& file);
/// These throw nlohmann::json::exception, for use inside other *_from_json functions.
double number_from_json(const nlohmann::json& json);
std::optional<double> optional_from_json(const nlohmann::json& json);
/// Refuses what nlohmann::json would cut off or round: 1.5, 1e300, −1 as an unsigned number.
template <class Whole>
Whole whole_from_json(const nlohmann::json& json) {
    if (json.is_number_unsigned() && std::in_range<Whole>(json.get<std::uint64_t>())) {
        return json.get<Whole>();
    }
    if (json.is_number_integer() && !json.is_number_unsigned() &&
        std::in_range<Whole>(json.get<std::int64_t>())) {
        return json.get<Whole>();
    }
    throw nlohmann::json::out_of_range::create(
        406, "a whole number is expected, not " + json.dump(), &json);
}

/// Whether the description of a trajectory says what it was driven with, or that this is not
/// known.
bool names_identity(const nlohmann::json& info);

/// Bytes that are not UTF-8 are replaced.
std::string text_of(const nlohmann::json& json);
nlohmann::json parse_json(const std::string& text, const std::string& file);

}  // namespace grainfield::io
