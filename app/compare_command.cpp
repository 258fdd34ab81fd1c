#include "app/compare_command.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/interrupt.h"
#include "io/output_file.h"
#include "io/results_file.h"

namespace grainfield::app {

namespace {

namespace fs = std::filesystem;

// Legends need names that differ: files with one label get their file's name in addition.
void tell_apart(std::vector<Results>& results, const std::vector<fs::path>& inputs) {
    std::vector<std::string> labels;
    for (const Results& r : results) labels.push_back(r.label);
    for (std::size_t i = 0; i < results.size(); ++i) {
        if (std::ranges::count(labels, labels[i]) > 1) {
            results[i].label += " (" + inputs[i].string() + ")";
        }
    }
}

fs::path figures_folder(const fs::path& html) {
    return html.parent_path() / (html.stem().string() + "_files");
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
    own.text("title", report_.title, "title of the page; by default made from the labels");
    own.flag("figures", report_.figures, "write every plot as SVG and CSV beside the page");
    return {own};
}

Summary CompareCommand::run(Session& session) {
    require_output(session, output_);
    if (session.common.explain) {
        session.plan.run("report",
                         fmt::format("{} results to '{}'", session.inputs.size(), output_));
        if (!report_.figures) session.plan.skip("figures", "--no-figures", "their files");
        return explanation(session.plan);
    }
    std::vector<Results> results;
    for (const fs::path& input : session.inputs) {
        throw_if_interrupted("comparison");
        results.push_back(io::read_results(input));
    }
    tell_apart(results, session.inputs);
    io::OutputFile html(output_,
                        session.common.force ? io::Overwrite::force : io::Overwrite::refuse);
    const fs::path figures = figures_folder(output_);
    report::write_report(results, report_, html.temporary(), figures, session.plan);
    html.commit();
    session.outputs.push_back(output_);
    if (report_.figures) session.outputs.push_back(figures);

    Summary summary;
    summary.text = fmt::format("{}: report of {} results\n", output_, results.size());
    if (report_.figures) {
        summary.text += fmt::format("  figures    {}\n", figures.string());
    }
    summary.facts["labels"] = nlohmann::ordered_json::array();
    for (const Results& r : results) summary.facts["labels"].push_back(r.label);
    return summary;
}

}  // namespace grainfield::app
