#include "report/figures/figure_files.h"

#include <array>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.h"
#include "report/figures/gnuplot_script.h"
#include "report/maps/map_pdf.h"
#include "report/maps/map_svg.h"
#include "report/text.h"

namespace grainfield::report {

namespace fs = std::filesystem;

namespace {

void make_folder(const fs::path& folder) {
    std::error_code problem;
    fs::create_directories(folder, problem);
    if (!problem && fs::is_directory(folder)) return;
    throw OutputError(ErrorText{"cannot make the folder '" + folder.string() + "' for the figures",
                                problem ? problem.message() : "it is not a folder", "",
                                "choose another place for the report"});
}

constexpr const char* list_name = "files.txt";

// Removes what an earlier report wrote into the folder: the figures its list names, nothing else.
void remove_earlier(const fs::path& folder) {
    std::ifstream list(folder / list_name);
    for (std::string name; std::getline(list, name);) {
        const fs::path file(name);
        const bool is_figure =
            file.extension() == ".svg" || file.extension() == ".csv" || file.extension() == ".pdf";
        if (!is_figure || file != file.filename()) continue;
        std::error_code ignored;
        if (fs::is_regular_file(fs::symlink_status(folder / file, ignored))) {
            fs::remove(folder / file, ignored);
        }
    }
}

constexpr std::array<const char*, 2> drawn_forms{".svg", ".pdf"};

// One gnuplot for all figures; each SVG and PDF appears under its name when it is complete.
std::vector<std::string> write_plots(const std::vector<const Figure*>& figures,
                                     const fs::path& folder, const Gnuplot& gnuplot,
                                     RunPlan& plan) {
    std::string script;
    std::vector<std::string> wanted;
    for (const Figure* figure : figures) {
        for (const char* form : drawn_forms) {
            wanted.push_back(figure->name + form);
            std::error_code ignored;
            fs::remove(folder / (wanted.back() + ".part"), ignored);
        }
        script += gnuplot_script(*figure, figure->name + ".svg.part", figure->name + ".pdf.part");
    }
    const Gnuplot::Outcome outcome = gnuplot.run(script, folder);
    if (!outcome.started) {
        plan.skip("SVG and PDF of the plots",
                  "gnuplot cannot be started (" + outcome.message +
                      "); install it (Debian: gnuplot-nox) and write the report again",
                  "");
        return {};
    }
    std::vector<std::string> written;
    for (const std::string& name : wanted) {
        std::error_code problem;
        if (outcome.succeeded) {
            fs::rename(folder / (name + ".part"), folder / name, problem);
            if (!problem) written.push_back(name);
        } else {
            fs::remove(folder / (name + ".part"), problem);
        }
    }
    if (written.size() != wanted.size()) {
        plan.skip("SVG and PDF of the plots", "gnuplot failed: " + clean_text(outcome.message), "");
    }
    return written;
}

}  // namespace

std::string figure_csv(const Figure& figure) {
    std::string out = fmt::format("run,series,{0},{1},{1}_err\n", figure.x.name, figure.y.name);
    for (const Series& series : figure.series) {
        const Kind& kind = figure.kinds[series.kind];
        if (kind.mark == Mark::guide) continue;
        const std::string who = csv_cell(figure.runs[series.run]) + "," + csv_cell(kind.label);
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            const std::string error = series.error.empty() ? "" : csv_cell(series.error[i]);
            fmt::format_to(std::back_inserter(out), "{},{},{},{}\n", who, csv_cell(series.x[i]),
                           csv_cell(series.y[i]), error);
        }
    }
    return out;
}

std::vector<std::string> write_figure_files(const std::vector<Figure>& figures,
                                            const std::vector<ParticleMap>& maps,
                                            const std::vector<std::string>& labels,
                                            const fs::path& folder, const Gnuplot& gnuplot,
                                            RunPlan& plan) {
    make_folder(folder);
    remove_earlier(folder);
    std::vector<std::string> written;
    const auto write = [&](const std::string& name, const std::string& content) {
        write_file(folder / name, content);
        written.push_back(name);
    };
    std::vector<const Figure*> with_data;
    for (const Figure& figure : figures) {
        if (!figure.has_data()) continue;
        with_data.push_back(&figure);
        write(figure.name + ".csv", figure_csv(figure));
    }
    for (const ParticleMap& map : maps) {
        write(map.name + ".svg", map_svg(map, labels[map.run]));
        if (map.position.empty()) continue;  // the picture of a field
        write(map.name + ".csv", map_csv(map));
        write(map.name + ".pdf", map_pdf(map, labels[map.run]));
    }
    if (!with_data.empty()) {
        const auto plots = write_plots(with_data, folder, gnuplot, plan);
        written.insert(written.end(), plots.begin(), plots.end());
    }
    std::string list;
    for (const std::string& name : written) list += name + "\n";
    write(list_name, list);
    return written;
}

}  // namespace grainfield::report
