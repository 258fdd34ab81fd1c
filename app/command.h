#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/exit_code.h"
#include "app/session.h"
#include "core/option_table.h"
#include "core/results.h"
#include "core/run_plan.h"

namespace grainfield::app {

/// What a command reports when it is done. Commands print nothing themselves.
struct Summary {
    std::string text;                ///< for people
    nlohmann::ordered_json facts;    ///< the command's own keys of the `--json` object
    int signal = 0;                  ///< set if the work was cut short by a signal
    std::string failure{};           ///< a check that was missed: said last, exit code 5
    bool is_table = false;           ///< the text is the output itself, for standard output
    ExitCode code = ExitCode::done;  ///< of work that was kept though its source failed
};

/// A subcommand of `grainfield`.
class Command {
 public:
    enum class Count { none, any, one, many };
    struct Inputs {
        std::string placeholder;  ///< "VIDEO|IMAGES"
        std::string meaning;
        Count count = Count::one;
    };

    virtual ~Command() = default;
    /// "track"; of a group: "simulate md".
    virtual std::string name() const = 0;
    virtual std::string purpose() const = 0;  ///< one line
    virtual Inputs inputs() const = 0;

    /// Tables bound to the command's own fields; called once.
    virtual std::vector<OptionTable> options() = 0;

    /// The options that `--help` shows, by their names on the command line, at most ten; the rest
    /// is in `--help-all`. Empty: the first ten of the tables.
    virtual std::vector<std::string> usual() const { return {}; }

    /// The text of an option on the command line; empty if it is not there.
    using GivenText = std::function<std::string(std::string_view section, std::string_view name)>;
    /// Called when the options file is read, before the command line is: empties what the file
    /// says and the command line contradicts in other words.
    virtual void make_room_for(const GivenText& /*given*/) {}
    /// What to give in place of an option that other programs have, without its dashes, and this
    /// command has in another form; empty: nothing is known of it.
    virtual std::string advice_on(std::string_view /*unknown_option*/) const { return {}; }
    virtual Summary run(Session& session) = 0;
    /// What --output is where nobody says it, in the present folder; empty: it has to be said.
    virtual std::string default_output(const std::vector<std::filesystem::path>& /*inputs*/) const {
        return {};
    }
};

/// Every command, in the order of the help text.
std::vector<std::unique_ptr<Command>> make_commands();

/// The whole `--json` object.
nlohmann::ordered_json json_summary(const Session& session, const Summary& summary);

/// What `--explain` reports: the plan, in words and as `plan` in JSON.
Summary explanation(const RunPlan& plan);

/// Throws OptionError if `output` is empty or is one of the inputs.
void require_output(const Session& session, const std::string& output);

/// "layer-report.html" for layer-results.h5 and "-report.html": the first input's name, without
/// what a command before has put behind it.
std::string named_after(const std::vector<std::filesystem::path>& inputs,
                        const std::string& ending);

/// "320", or "319.6" of a mean that is not whole.
std::string mean_text(double mean);

/// Whether the output is standard output, "-".
bool is_standard_output(const std::string& output);

/// Throws OptionError unless the name ends in .html or .htm.
void require_html_name(const std::string& output);

/// Throws OptionError if the name of a folder that is not there ends as that of a file.
void require_folder_name(const std::string& output, const std::string& expected);

/// Throws OptionError unless the name ends in .h5 or .hdf5.
void require_hdf5_name(const std::string& output);

}  // namespace grainfield::app
