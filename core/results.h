#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/frame.h"
#include "core/option_table.h"
#include "core/run_identity.h"
#include "core/snapshot.h"
#include "core/trajectory.h"
#include "core/unit.h"
#include "core/warning.h"

namespace grainfield {

/// A measured number with its standard error and the number of independent samples behind it, or
/// the reason why there is none. Never NaN without a reason.
struct Measurement {
    std::string name;  ///< "s0", "d_liquid"
    Unit unit;         ///< "-", "a^2/time unit"
    std::optional<double> value;
    std::optional<double> error;
    double samples = 0;
    std::string reason;  ///< why there is no value, or no error
};

/// One column of numbers; NaN means "missing".
struct Column {
    std::string name;  ///< "k", "s", "s_err", "n": stable, scripts rely on it
    Unit unit;
    std::string meaning;  ///< axis label for people
    std::vector<double> values;
};

/// A curve or table of an observable; all columns have the same length.
struct Curve {
    std::string name;  ///< "sk", "variance", "msd", "q4_histogram": also the CSV's file name
    std::string title;
    std::vector<Column> columns;
    std::map<std::string, std::vector<std::string>> text_columns;  ///< e.g. "phase" in msd

    const Column* find(const std::string& column) const;
};

/// Everything an analysis says about one observable.
struct ObservableResult {
    std::string name;  ///< "q4", "phase", "msd", "sk", "variance"
    std::vector<Measurement> measurements;
    std::vector<Curve> curves;
    std::vector<std::pair<std::string, OptionValue>> options;
    std::string reason;  ///< set when nothing at all could be measured
    double seconds = 0;

    const Curve* find_curve(const std::string& curve) const;
    const Measurement* find_measurement(const std::string& measurement) const;
    /// The recorded value of an option; null if it is not recorded.
    const OptionValue* find_option(const std::string& option) const;
};

/// A frame kept for people to look at, with what was found in it.
struct Preview {
    Frame frame;  ///< image empty if the source has none (simulations)
    Snapshot snapshot;
    std::vector<double> abs_q4;  ///< |Q4| per particle; empty before the analysis, NaN: undefined
};

/// How an output came to be; stored with every file.
struct RunRecord {
    std::string command;  ///< "track"
    std::string version;
    std::uint64_t seed = 0;
    int threads = 1;
    double seconds = 0;
    std::vector<std::pair<std::string, std::string>> configuration;  ///< "section.name" → text

    struct Input {
        std::string name;
        std::uint64_t bytes = 0;
        std::string checksum;  ///< "crc32:9ae0daaf" of the content
    };
    std::vector<Input> inputs;
    std::vector<std::string> skipped;  ///< "stage: reason"
    std::vector<Warning> warnings;
};

/// The content of a results file.
struct Results {
    TrajectoryInfo source;
    RunIdentity identity;  ///< what puts runs side by side
    std::string label;     ///< legend entry, for people
    Box box;
    std::int64_t frames = 0;
    double particles_mean = 0;
    std::vector<ObservableResult> observables;
    std::vector<Preview> previews;
    RunRecord record;
    std::vector<RunRecord> sources;  ///< of the runs that made the input, oldest first

    const ObservableResult* find(const std::string& observable) const;
};

}  // namespace grainfield
