#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/figure_hint.h"
#include "core/quantity_titles.h"
#include "core/results.h"
#include "core/run_plan.h"
#include "report/figures/figure.h"
#include "report/figures/gnuplot_script.h"
#include "report/page/alternatives.h"
#include "report/page/copy_block.h"
#include "report/page/table.h"

namespace grainfield::report {

struct ReportOptions {
    std::string title;    ///< heading of the page; empty: made from the runs
    bool figures = true;  ///< also write every figure as SVG, PDF and CSV into the folder beside
    int threads = 0;      ///< 0: all of the machine
    bool observables = true;          ///< figures and key numbers of what an analysis measures
    bool paper = false;               ///< begin with the table of the paper's values (paper_table)
    std::vector<FigureHint> hints{};  ///< how what was measured wants to be drawn
    std::vector<ObservableTitles> titles{};  ///< and what it is called
    std::string date{};                      ///< in the header of the page; may be empty
    /// For panels of the paper that the runs leave empty, which say so; may be none.
    std::vector<Results> committed{};
    std::optional<double> sphere_mm{};  ///< true diameter of the spheres [mm], for lengths in mm
};

/// A sphere that the page marks in the picture of a frame and leads to.
struct MarkedSphere {
    std::size_t run = 0;
    std::int64_t frame = 0;
    Vec2 position;      ///< [length unit]
    std::string words;  ///< "missed"
};

/// What a command adds to a report of its own: tables before the key numbers, figures before those
/// of the runs.
struct ReportAdditions {
    std::vector<Table> tables;
    std::vector<Figure> figures;
    std::string verdict{};               ///< under the title, in place of that of the runs
    std::vector<CopyBlock> blocks{};     ///< below the picture
    std::vector<MarkedSphere> marked{};  ///< in place of the places to look at
    std::string marked_as{};             ///< "Missed and false"; empty: nothing is marked
    Alternatives alternatives{};         ///< below the picture; may be empty
};

/// Writes the report of one or more runs, side by side: one HTML file that needs no network and no
/// other file, and, in `figures_dir`, every figure as SVG, PDF and CSV and every table as CSV. Two
/// runs, or runs that differ in origin only, also get a table of their differences; what stands in
/// the way of comparing runs becomes a warning of the plan. `html` is
/// written as it is named (the caller renames it when all is well). What could not be drawn is said
/// in the plan: without gnuplot the plots have no SVG.
///
/// Size: 1.6 MB, and per run about 0.1 MB for 10,000 particles plus the previews; previews of all
/// runs share 8 MB (images are reduced, see MapBudget).
/// Throws OptionError without runs, OutputError if a file cannot be written.
void write_report(const std::vector<Results>& runs, const ReportOptions& options,
                  const std::filesystem::path& html, const std::filesystem::path& figures_dir,
                  RunPlan& plan, const ReportAdditions& additions = {});

/// Draws one figure of the runs for print (publication_script) into `file`. `name`: as the files of
/// the figures are called, '-' or '_' between words; "s-over-s1" is "sk_scaled", "s0-over-s1" is
/// "critical", "s0-over-s1-epsilon" is "critical_epsilon"; with `options.paper` also those of the
/// paper, "paper_2a". Warns of every run that it has no curve
/// of, and why. Returns the title of the figure. Throws OptionError if no figure with data is
/// called so (names those that are), OutputError if gnuplot cannot draw it.
std::string write_figure(const std::vector<Results>& runs, const ReportOptions& options,
                         const std::string& name, PlotForm form, const std::filesystem::path& file,
                         RunPlan& plan);

}  // namespace grainfield::report
