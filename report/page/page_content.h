#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/quantity_titles.h"
#include "core/results.h"
#include "core/run_plan.h"
#include "report/figures/figure.h"
#include "report/maps/particle_map.h"
#include "report/page/alternatives.h"
#include "report/page/copy_block.h"
#include "report/page/paper_panels.h"
#include "report/page/table.h"

namespace grainfield::report {

/// What a page is made of.
struct PageContent {
    std::string title;
    const std::vector<Results>& runs;
    const std::vector<std::string>& labels;
    const std::vector<Figure>& figures;
    const std::vector<ParticleMap>& maps;
    std::string files_folder;                ///< of the SVG and CSV files, relative to the page
    std::vector<std::string> files;          ///< names of those that exist
    const RunPlan& plan;                     ///< of the command that writes the report
    const std::vector<Table>& tables;        ///< before the key numbers; may be empty
    bool key_numbers = true;                 ///< a table of what an analysis measures
    std::vector<ObservableTitles> titles{};  ///< what it is called
    std::string date{};                      ///< of the page, in the header; may be empty
    std::optional<double> sphere_mm{};       ///< true diameter of the spheres [mm]
    std::string verdict{};                   ///< in place of that of the runs; may be empty
    std::vector<CopyBlock> blocks{};         ///< below the pictures
    std::string places_title = "Places to look at";
    std::vector<PaperPanel> paper{};  ///< the page begins with them; empty: it is no such page
    Alternatives alternatives{};      ///< below the pictures; may be empty
};

}  // namespace grainfield::report
