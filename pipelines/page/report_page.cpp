#include "pipelines/page/report_page.h"

#include <array>
#include <charconv>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "analysis/observables.h"
#include "core/errors.h"
#include "pipelines/analyze/lengths.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
    std::error_code unreachable;
    return fs::exists(path, unreachable);
}

/// "23 November 2026", of the machine's clock or of SOURCE_DATE_EPOCH, in universal time.
std::string date_of_page() {
    std::time_t now = std::time(nullptr);
    if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH"); epoch != nullptr) {
        const std::string_view text(epoch);
        std::from_chars(text.data(), text.data() + text.size(), now);
    }
    std::tm day{};
    if (gmtime_r(&now, &day) == nullptr) return "";
    constexpr std::array months{"January",   "February", "March",    "April",
                                "May",       "June",     "July",     "August",
                                "September", "October",  "November", "December"};
    return fmt::format("{} {} {}", day.tm_mday, months.at(static_cast<std::size_t>(day.tm_mon)),
                       1900 + day.tm_year);
}

}  // namespace

fs::path figures_folder(const fs::path& html) {
    return html.parent_path() / (html.stem().string() + "_files");
}

FiguresFolder::FiguresFolder(fs::path path, Overwrite overwrite)
    : path_(std::move(path)), is_new_(!is_there(path_)) {
    if (is_new_ || overwrite == Overwrite::force) return;
    throw OutputError({.problem = fmt::format("output folder '{}' exists", path_.string()),
                       .actual = {},
                       .expected = {},
                       .suggestion = "option 'force' writes into it; or leave out the figures"});
}

FiguresFolder::~FiguresFolder() {
    std::error_code ignored;
    if (is_new_ && !kept_) fs::remove_all(path_, ignored);
}

ReportPage::ReportPage(fs::path html, report::ReportOptions options, const Job& job)
    : html_(std::move(html)), options_(std::move(options)), output_(html_, job.overwrite) {
    options_.threads = job.threads;
    if (options_.observables) options_.date = date_of_page();
    if (options_.observables) {
        options_.hints = analysis::figure_hints();
        options_.titles = analysis::titles();
        options_.titles.push_back(lengths_titles());
    }
    if (options_.figures) figures_.emplace(figures_folder(html_), job.overwrite);
}

void ReportPage::draw(const std::vector<Results>& runs, Job& job, const std::string& title,
                      const report::ReportAdditions& additions) {
    if (options_.title.empty()) options_.title = title;
    report::write_report(runs, options_, output_.temporary(), figures_folder(html_), job.plan,
                         additions);
}

void ReportPage::commit(Job& job) {
    output_.commit();
    job.outputs.push_back(html_);
    if (!figures_) return;
    figures_->keep();
    job.outputs.push_back(figures_->path());
}

fs::path ReportPage::figures() const {
    return figures_ ? figures_->path() : fs::path();
}

Results page_run(Results run, const Job& job) {
    run.record = job.record();
    run.record.skipped.clear();
    run.record.warnings.clear();
    return run;
}

}  // namespace grainfield::pipelines
