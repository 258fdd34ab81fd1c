#include "app/compare_command.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/observables.h"
#include "app/standard_output.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/output_file.h"
#include "io/h5/results_file.h"
#include "io/input_file.h"
#include "pipelines/interrupt_deadline.h"
#include "pipelines/page/committed_runs.h"
#include "pipelines/page/report_page.h"

namespace grainfield::app {

namespace fs = std::filesystem;

namespace {

using Form = report::PlotForm;
constexpr std::array<std::pair<const char*, Form>, 3> forms{
    {{".pdf", Form::pdf}, {".svg", Form::svg}, {".png", Form::png}}};

// A file that is not there is an error, as its name is most likely mistyped. What is there and
// cannot be read is left out with a warning that names it; nothing at all is an error.
std::vector<Results> read_inputs(Session& session) {
    for (const fs::path& input : session.inputs) io::require_file_exists(input);
    std::vector<Results> results;
    std::vector<InputError> unread;
    for (const fs::path& input : session.inputs) {
        throw_if_interrupted("comparison");
        try {
            results.push_back(io::read_results(input));
        } catch (const InputError& error) {
            unread.push_back(error);
        }
    }
    // Where nothing is left the first one is the error.
    for (std::size_t i = results.empty() ? 1 : 0; i < unread.size(); ++i) {
        session.plan.warn(fmt::format("left out: {}", unread[i].what()));
    }
    if (results.empty() && !unread.empty()) throw InputError(unread.front());
    return results;
}

}  // namespace

std::string CompareCommand::purpose() const {
    return "make one report of one or more results";
}

Command::Inputs CompareCommand::inputs() const {
    return {.placeholder = "RESULTS.h5...",
            .meaning = "results files, in the order of the legend",
            .count = Count::many};
}

std::vector<OptionTable> CompareCommand::options() {
    OptionTable own("");
    own.text("output", output_, "HTML page to write; figures go into a folder beside it");
    own.text(
        "figure", figure_,
        "draw only this one, for print, into OUTPUT (.pdf, .svg, .png; - prints SVG): s-over-s1, "
        "s0-over-s1, s0-over-s1-epsilon, variance, msd, synthetic, sk, …; with --paper paper-2a, "
        "…");
    own.text("title", report_.title, "title of the page; by default made from the labels");
    own.number("sphere-mm", report_.sphere_mm, "mm", {1e-6, 1e6},
               "true diameter of the spheres, for lengths in mm besides");
    own.also_called("diameter-mm");
    own.flag("figures", report_.figures, "write every plot as SVG, PDF and CSV beside the page");
    own.text(
        "committed", committed_,
        "of --paper: folder of kept results (bench/results/paper) for panels without any of ours");
    own.flag("paper", report_.paper, "begin with the values of the paper and how ours compare");
    return {own};
}

std::string CompareCommand::default_output(const std::vector<std::filesystem::path>& inputs) const {
    return named_after(inputs, figure_.empty() ? "-report.html" : "-" + figure_ + ".pdf");
}

Summary CompareCommand::run(Session& session) {
    return pipelines::run_or_discard("comparison", output_, [&] { return work(session); });
}

report::ReportOptions CompareCommand::drawn_options() const {
    report::ReportOptions drawn = report_;
    if (!committed_.empty() && !drawn.paper) {
        throw OptionError({.problem = "option 'committed' is given without 'paper'",
                           .actual = {},
                           .expected = "both, or none",
                           .suggestion = "add option 'paper' for the panels of the paper"});
    }
    if (!committed_.empty()) drawn.committed = pipelines::committed_runs(committed_);
    return drawn;
}

Summary CompareCommand::draw_figure(Session& session) const {
    const bool is_printed = is_standard_output(output_);
    const std::string extension = is_printed ? ".svg" : fs::path(output_).extension().string();
    const auto form = std::ranges::find(forms, extension, &std::pair<const char*, Form>::first);
    if (form == forms.end()) {
        throw OptionError(
            {.problem = fmt::format("cannot tell what picture '{}' is to be", output_),
             .actual = {},
             .expected = "a name that ends in .pdf, .svg or .png",
             .suggestion = {}});
    }
    if (session.common.explain) {
        session.plan.run("figure", fmt::format("'{}' of {} results to '{}'", figure_,
                                               session.inputs.size(), output_));
        return explanation(session.plan);
    }
    report::ReportOptions options = drawn_options();
    options.hints = analysis::figure_hints();
    if (is_printed) {
        require_no_json_beside(session);
        const StandardOutputFile picture("figure.svg");
        report::write_figure(read_inputs(session), options, figure_, form->second, picture.path(),
                             session.plan);
        return {.text = picture.text(), .facts = {}, .is_table = true};
    }
    OutputFile output(output_, session.overwrite);
    const std::vector<Results> results = read_inputs(session);
    const std::string title = report::write_figure(results, options, figure_, form->second,
                                                   output.temporary(), session.plan);
    output.commit();
    session.outputs.push_back(output_);
    Summary summary;
    summary.text = fmt::format("{}: {}\n", output_, title);
    summary.facts["figure"] = figure_;
    return summary;
}

Summary CompareCommand::work(Session& session) const {
    require_output(session, output_);
    if (!figure_.empty()) return draw_figure(session);
    require_html_name(output_);
    if (session.common.explain) {
        session.plan.run(
            "report",
            fmt::format("{} to '{}'",
                        counted(static_cast<std::int64_t>(session.inputs.size()), "result"),
                        output_));
        if (!report_.figures) session.plan.skip("figures", "--no-figures", "their files");
        return explanation(session.plan);
    }
    const std::vector<Results> results = read_inputs(session);
    pipelines::ReportPage page(output_, drawn_options(), session);
    page.draw(results, session);
    page.commit(session);

    Summary summary;
    summary.text = fmt::format("{}: report of {}\n", output_,
                               counted(static_cast<std::int64_t>(results.size()), "result"));
    const std::size_t left_out = session.inputs.size() - results.size();
    if (left_out > 0) summary.text += fmt::format("  left out   {}, see the warnings\n", left_out);
    summary.facts["left_out"] = left_out;
    if (!page.figures().empty()) {
        summary.text += fmt::format("  figures    {}\n", page.figures().string());
    }
    summary.facts["labels"] = nlohmann::ordered_json::array();
    for (const Results& r : results) summary.facts["labels"].push_back(r.label);
    return summary;
}

}  // namespace grainfield::app
