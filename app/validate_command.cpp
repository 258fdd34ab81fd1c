#include "app/validate_command.h"

#include <utility>

#include <fmt/format.h>

#include "app/optics_summary.h"
#include "app/random_summary.h"
#include "app/validation_summary.h"
#include "core/errors.h"

namespace grainfield::app {

std::string ValidateCommand::purpose() const {
    return "track frames whose truth is known and score what was found";
}

Command::Inputs ValidateCommand::inputs() const {
    return {.placeholder = "VIDEO|IMAGE...",
            .meaning = "frames that exist, with --truth; by default frames are rendered",
            .count = Count::any};
}

std::vector<OptionTable> ValidateCommand::options() {
    OptionTable own("");
    own.text("output", output_, "HTML page to write; figures go into a folder beside it");
    own.text("title", job_.report.title, "title of the page");
    own.flag("figures", job_.report.figures, "write every plot and table as SVG and CSV beside it");
    own.text("trajectory", job_.scene.trajectory, "render this trajectory instead of running MD");
    own.text("truth", job_.scene.truth, "true positions in px of the frames given as input");
    own.text("calibration", job_.calibration,
             "use the calibration that another run kept in this file");
    own.integer("previews", job_.previews, "-", {0, 100},
                "frames shown in the report; of random optics the worst scenes");
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : simulate::describe(job_.scene.md)) tables.push_back(std::move(table));
    for (OptionTable& table : simulate::describe(job_.scene.render))
        tables.push_back(std::move(table));
    for (OptionTable& table : tracking::describe(job_.tracking)) tables.push_back(std::move(table));
    tables.push_back(analysis::describe(job_.fit));
    tables.push_back(describe(job_.thresholds));
    tables.push_back(describe(job_.random_thresholds));
    return tables;
}

std::vector<std::string> ValidateCommand::usual() const {
    return {"output", "trajectory", "truth",   "optics",   "camera",
            "scale",  "scenes",     "periods", "previews", "figures"};
}

std::string ValidateCommand::default_output(
    const std::vector<std::filesystem::path>& /*inputs*/) const {
    return "validation.html";
}

Summary ValidateCommand::run(Session& session) {
    const bool is_random = pipelines::is_random(job_);
    if (is_random && !job_.calibration.empty()) {
        throw OptionError({.problem = "a kept calibration is given for cameras drawn at random",
                           .actual = fmt::format("'{}'", job_.calibration),
                           .expected = "one camera, or no calibration",
                           .suggestion = "leave out option 'calibration' or optics random"});
    }
    if (session.common.explain) {
        if (is_random) {
            pipelines::plan_random_validation(job_, session);
        } else {
            pipelines::plan_validation(job_, session);
        }
        return explanation(session.plan);
    }
    require_output(session, output_);
    require_html_name(output_);
    job_.output = output_;
    return is_random ? run_random(session) : run_one_camera(session);
}

Summary ValidateCommand::run_random(Session& session) {
    const pipelines::RandomValidationResult result =
        pipelines::run_random_validation(job_, session);
    Summary summary{.text = random_text(output_, result),
                    .facts = random_facts(result),
                    .signal = result.signal,
                    .failure = {}};
    if (summary.signal == 0) summary.failure = missed_thresholds(result.checks);
    return summary;
}

Summary ValidateCommand::run_one_camera(Session& session) {
    const pipelines::ValidateJobResult result = pipelines::run_validation(job_, session);
    Summary summary{.text = summary_text(output_, result.outcome, result.checks),
                    .facts = summary_facts(result.outcome, result.tracked, result.checks),
                    .signal = result.signal,
                    .failure = {}};
    if (summary.signal == 0) summary.failure = missed_thresholds(result.checks);
    if (result.optics) add_optics_summary(*result.optics, summary);
    return summary;
}

}  // namespace grainfield::app
