#include "report/report.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "report/figures/critical_figures.h"
#include "report/figures/figure_files.h"
#include "report/figures/figures.h"
#include "report/figures/gnuplot.h"
#include "report/maps/particle_map.h"
#include "report/page/differences.h"
#include "report/page/page.h"
#include "report/page/paper_panels.h"
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

// Results of `critical` give a page its subject.
std::string title_of(const std::vector<Results>& runs, const std::vector<std::string>& labels) {
    const auto critical = std::ranges::find(runs, RunRole::critical_point,
                                            [](const Results& run) { return run.identity.role; });
    if (critical != runs.end()) {
        const std::string parameter = critical_parameter(*critical);
        if (!parameter.empty()) return "Critical point: S₀/S₁ against " + parameter;
    }
    if (labels.size() == 1) return labels[0];
    if (labels.size() == 2) return labels[0] + " beside " + labels[1];
    return "Report of a vibrated layer";
}

// What the page and its figures are made from.
struct Prepared {
    std::vector<Results> runs;
    std::vector<std::string> labels;
    std::string times;  ///< what was done to times
};

Prepared prepared(const std::vector<Results>& given, const ReportOptions& options) {
    if (given.empty()) {
        throw OptionError(ErrorText{"a report needs at least one results file", "none given", "",
                                    "make one with 'grainfield analyze'"});
    }
    Prepared all;
    all.runs.reserve(given.size());
    for (const Results& run : given) all.runs.push_back(with_possible_numbers(run));
    leave_out_incomparable(all.runs);
    all.times = share_seconds(all.runs, options.sphere_mm);
    all.labels = run_labels(all.runs);
    return all;
}

void mark(std::vector<ParticleMap>& maps, const std::vector<MarkedSphere>& marked) {
    for (ParticleMap& map : maps) {
        map.places.clear();
        for (const MarkedSphere& sphere : marked) {
            if (sphere.run != map.run || sphere.frame != map.frame) continue;
            map.places.push_back({sphere.position, 0, 1, sphere.words});
        }
    }
}

void warn_of_absent(const Figure& figure, const Prepared& all, RunPlan& plan) {
    for (const Figure::Absence& absence : figure.absent) {
        plan.warn(fmt::format("the figure '{}' shows nothing of '{}': {}", figure.name,
                              figure.runs[absence.run], absence.reason));
    }
    if (figure.absent.empty() || figure.x.unit.power(BaseUnit::time) == 0) return;
    const std::string times = time_mismatch(all.runs, all.labels);
    if (!times.empty()) plan.warn(times);
}

std::string figure_name(std::string name) {
    if (name == "s-over-s1") return "sk_scaled";
    if (name == "s0-over-s1") return "critical";
    if (name == "s0-over-s1-epsilon") return "critical_epsilon";
    std::ranges::replace(name, '-', '_');
    return name;
}

}  // namespace

void write_report(const std::vector<Results>& given, const ReportOptions& options,
                  const std::filesystem::path& html, const std::filesystem::path& figures_dir,
                  RunPlan& plan, const ReportAdditions& additions) {
    const Prepared all = prepared(given, options);
    const std::vector<Results>& runs = all.runs;
    const std::vector<std::string>& labels = all.labels;
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
            if (has_time && !all.times.empty()) {
                if (!figure.note.empty()) figure.note += ' ';
                figure.note += all.times;
            }
            figures.push_back(std::move(figure));
        }
    }
    std::vector<PaperPanel> paper;
    if (options.paper) paper = paper_panels(runs, labels, options.hints, options.committed);
    for (const PaperPanel& panel : paper) {
        if (panel.figure) figures.push_back(*panel.figure);
    }
    std::vector<ParticleMap> maps = make_maps(runs, {.threads = options.threads});
    if (!additions.marked_as.empty()) mark(maps, additions.marked);
    std::string title = clean_text(options.title);
    if (title.empty()) title = title_of(runs, labels);

    std::vector<std::string> files;
    if (options.figures) {
        files = write_figure_files(figures, maps, labels, figures_dir, Gnuplot(), plan);
        for (const Table& table : tables) {
            files.push_back(table.name + ".csv");
            write_file(figures_dir / files.back(), table_csv(table));
        }
    }
    write_file(html,
               page_html({title, runs, labels, figures, maps,
                          options.figures ? relative_folder(figures_dir, html) : "", files, plan,
                          tables, options.observables, options.titles, clean_text(options.date),
                          options.sphere_mm, additions.verdict, additions.blocks,
                          additions.marked_as.empty() ? std::string("Places to look at")
                                                      : additions.marked_as,
                          paper, additions.alternatives}));
}

std::string write_figure(const std::vector<Results>& given, const ReportOptions& options,
                         const std::string& name, PlotForm form, const std::filesystem::path& file,
                         RunPlan& plan) {
    const Prepared all = prepared(given, options);
    std::string known;
    std::vector<Figure> figures = make_figures(all.runs, all.labels, options.hints);
    if (options.paper) {
        for (PaperPanel& panel :
             paper_panels(all.runs, all.labels, options.hints, options.committed)) {
            if (panel.figure) figures.push_back(*std::move(panel.figure));
        }
    }
    for (const Figure& figure : figures) {
        if (!figure.has_data()) continue;
        known += (known.empty() ? "" : ", ") + figure.name;
        if (figure.name != figure_name(name)) continue;
        // Gnuplot works in the folder of the file.
        const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
        const std::string script = publication_script(figure, file.filename().string(), form);
        const Gnuplot::Outcome outcome = Gnuplot().run(script, folder);
        if (!outcome.started || !outcome.succeeded) {
            throw OutputError({.problem = fmt::format("cannot draw '{}'", file.string()),
                               .actual = clean_text(outcome.message),
                               .expected = "a gnuplot that can be started",
                               .suggestion = "install it (Debian: gnuplot-nox)"});
        }
        warn_of_absent(figure, all, plan);
        return figure.title;
    }
    throw OptionError({.problem = fmt::format("these results have no figure '{}'", name),
                       .actual = {},
                       .expected = "one of " + known,
                       .suggestion = !options.paper && name.starts_with("paper")
                                         ? "add option 'paper' for the panels of the paper"
                                         : ""});
}

}  // namespace grainfield::report
