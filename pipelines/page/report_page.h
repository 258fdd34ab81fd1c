#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/results.h"
#include "core/support/output_file.h"
#include "pipelines/job.h"
#include "report/report.h"

namespace grainfield::pipelines {

/// Where the figures of a page go: NAME_files beside NAME.html.
std::filesystem::path figures_folder(const std::filesystem::path& html);

/// The folder of the figures: refused if it is there already, and removed again, unless it was
/// there before, when the page does not come about.
class FiguresFolder {
 public:
    /// Throws OutputError if the folder exists and may not be overwritten.
    FiguresFolder(std::filesystem::path path, Overwrite overwrite);
    ~FiguresFolder();
    FiguresFolder(const FiguresFolder&) = delete;
    FiguresFolder& operator=(const FiguresFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    void keep() { kept_ = true; }

 private:
    std::filesystem::path path_;
    bool is_new_;
    bool kept_ = false;
};

/// A page that a job makes: page and figures are claimed before the work, drawn after it, and
/// appear when they are complete.
class ReportPage {
 public:
    /// The figures go beside the page if `options` ask for them. Throws OutputError if one of them
    /// exists and may not be overwritten.
    ReportPage(std::filesystem::path html, report::ReportOptions options, const Job& job);

    /// Draws what is compared. `title`: where the options name none.
    void draw(const std::vector<Results>& runs, Job& job, const std::string& title = "",
              const report::ReportAdditions& additions = {});
    /// Gives the page its name and adds it to the outputs of the job.
    void commit(Job& job);

    /// The folder of the figures; empty if there are none.
    std::filesystem::path figures() const;

 private:
    std::filesystem::path html_;
    report::ReportOptions options_;
    OutputFile output_;
    std::optional<FiguresFolder> figures_;
};

/// The part of a page that is one of the runs compared: its record has what the page does not take
/// from the plan.
Results page_run(Results run, const Job& job);

}  // namespace grainfield::pipelines
