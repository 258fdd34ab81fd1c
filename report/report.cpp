#include "report/report.h"

#include <utility>

#include "core/errors.h"
#include "report/figures/figure_files.h"
#include "report/figures/figures.h"
#include "report/maps/particle_map.h"
#include "report/page/differences.h"
#include "report/page/page.h"
#include "report/page/paper_table.h"
#include "report/possible_numbers.h"
#include "report/run_labels.h"
#include "report/shared_times.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

std::string relative_folder(const std::filesystem::path& folder,
                            const std::filesystem::path& html) {
    const auto base = std::filesystem::absolute(html).parent_path().lexically_normal();
    const auto relative =
        std::filesystem::absolute(folder).lexically_normal().lexically_relative(base);
    return relative.empty() ? folder.string() : relative.generic_string();
}

std::string title_of(const std::vector<std::string>& labels) {
    if (labels.size() == 1) return labels[0];
    if (labels.size() == 2) return labels[0] + " beside " + labels[1];
    return "Report of a vibrated layer";
}

}  // namespace

void write_report(const std::vector<Results>& given, const ReportOptions& options,
                  const std::filesystem::path& html, const std::filesystem::path& figures_dir,
                  RunPlan& plan, const ReportAdditions& additions) {
    if (given.empty()) {
        throw OptionError(ErrorText{"a report needs at least one results file", "none given", "",
                                    "make one with 'grainfield analyze'"});
    }
    std::vector<Results> runs;
    runs.reserve(given.size());
    for (const Results& run : given) runs.push_back(with_possible_numbers(run));
    leave_out_incomparable(runs);
    const std::string times = share_seconds(runs, options.sphere_mm);
    const std::vector<std::string> labels = run_labels(runs);
    const std::vector<RunIdentity> identities = identities_of(runs);
    std::vector<Table> tables;
    if (options.paper) tables.push_back(paper_table(runs, labels));
    for (const Table& table : additions.tables) tables.push_back(table);
    if (additions.tables.empty()) {
        if (auto table = differences(runs, labels, identities, options.titles))
            tables.push_back(*std::move(table));
    }
    for (const std::string& text : mismatches(runs, labels, identities)) plan.warn(text);
    std::vector<Figure> figures = additions.figures;
    if (options.observables) {
        for (Figure& figure : make_figures(runs, labels, options.hints)) {
            const bool has_time = figure.x.unit.power(BaseUnit::time) != 0;
            if (has_time && !times.empty()) {
                if (!figure.note.empty()) figure.note += ' ';
                figure.note += times;
            }
            figures.push_back(std::move(figure));
        }
    }
    const std::vector<ParticleMap> maps = make_maps(runs, {.threads = options.threads});
    std::string title = clean_text(options.title);
    if (title.empty()) title = title_of(labels);

    std::vector<std::string> files;
    if (options.figures) {
        files = write_figure_files(figures, maps, labels, figures_dir, Gnuplot(), plan);
        for (const Table& table : tables) {
            files.push_back(table.name + ".csv");
            write_file(figures_dir / files.back(), table_csv(table));
        }
    }
    write_file(html, page_html({title, runs, labels, figures, maps,
                                options.figures ? relative_folder(figures_dir, html) : "", files,
                                plan, tables, options.observables, options.titles,
                                clean_text(options.date), options.sphere_mm}));
}

}  // namespace grainfield::report
