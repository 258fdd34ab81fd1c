#include "app/compare_command.h"

#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "app/interrupt_deadline.h"
#include "core/errors.h"
#include "core/interrupt.h"
#include "io/output_file.h"
#include "io/results_file.h"

namespace grainfield::app {

namespace {

namespace fs = std::filesystem;

fs::path figures_folder(const fs::path& html) {
    return html.parent_path() / (html.stem().string() + "_files");
}

bool is_there(const fs::path& path) {
    std::error_code unreachable;
    return fs::exists(path, unreachable);
}

/// The folder of the figures: refused if it is there already, and removed again, unless it was
/// there before, when the report does not come about.
class FiguresFolder {
 public:
    FiguresFolder(fs::path path, io::Overwrite overwrite)
        : path_(std::move(path)), is_new_(!is_there(path_)) {
        if (is_new_ || overwrite == io::Overwrite::force) return;
        throw OutputError({.problem = fmt::format("output folder '{}' exists", path_.string()),
                           .actual = {},
                           .expected = {},
                           .suggestion = "give --force to write into it, or --no-figures"});
    }
    ~FiguresFolder() {
        std::error_code ignored;
        if (is_new_ && !kept_) fs::remove_all(path_, ignored);
    }
    FiguresFolder(const FiguresFolder&) = delete;
    FiguresFolder& operator=(const FiguresFolder&) = delete;

    const fs::path& path() const { return path_; }
    void keep() { kept_ = true; }

 private:
    fs::path path_;
    bool is_new_;
    bool kept_ = false;
};

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
    return run_or_discard("comparison", output_, [&] { return work(session); });
}

Summary CompareCommand::work(Session& session) const {
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
    const auto overwrite = session.common.force ? io::Overwrite::force : io::Overwrite::refuse;
    io::OutputFile html(output_, overwrite);
    std::optional<FiguresFolder> figures;
    if (report_.figures) figures.emplace(figures_folder(output_), overwrite);
    report::write_report(results, report_, html.temporary(), figures_folder(output_), session.plan);
    html.commit();
    session.outputs.push_back(output_);
    if (figures) {
        figures->keep();
        session.outputs.push_back(figures->path());
    }

    Summary summary;
    summary.text = fmt::format("{}: report of {} results\n", output_, results.size());
    if (figures) summary.text += fmt::format("  figures    {}\n", figures->path().string());
    summary.facts["labels"] = nlohmann::ordered_json::array();
    for (const Results& r : results) summary.facts["labels"].push_back(r.label);
    return summary;
}

}  // namespace grainfield::app
