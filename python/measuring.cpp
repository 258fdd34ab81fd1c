#include "python/measuring.h"

#include <complex>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "analysis/analysis.h"
#include "analysis/order/bond_order.h"
#include "core/support/interrupt.h"
#include "core/support/parallel.h"
#include "core/vec2.h"
#include "core/version.h"
#include "io/h5/results_file.h"
#include "pipelines/page/report_page.h"
#include "python/errors.h"
#include "python/options.h"
#include "python/released.h"

namespace py = pybind11;

namespace grainfield::python {

namespace {

using SharedResults = std::shared_ptr<Results>;

py::dict dict_of(const Measurement& measurement, TimeUnit time_unit) {
    py::dict dict;
    dict["name"] = measurement.name;
    dict["unit"] = plain_text(measurement.unit, time_unit);
    dict["value"] = measurement.value;
    dict["error"] = measurement.error;
    dict["samples"] = measurement.samples;
    dict["reason"] = measurement.reason;
    return dict;
}

/// Columns by name, text columns after the first.
py::dict columns_of(const Curve& curve) {
    py::dict columns;
    for (std::size_t i = 0; i < curve.columns.size(); ++i) {
        const Column& column = curve.columns[i];
        columns[column.name.c_str()] = py::array_t<double>(
            static_cast<py::ssize_t>(column.values.size()), column.values.data());
        if (i > 0) continue;
        for (const auto& [name, texts] : curve.text_columns) columns[name.c_str()] = texts;
    }
    return columns;
}

py::dict dict_of(const ObservableResult& result, TimeUnit time_unit) {
    py::dict dict;
    dict["name"] = result.name;
    dict["reason"] = result.reason;
    dict["seconds"] = result.seconds;
    py::list measurements;
    for (const Measurement& m : result.measurements) measurements.append(dict_of(m, time_unit));
    dict["measurements"] = measurements;
    py::dict curves;
    for (const Curve& curve : result.curves) curves[curve.name.c_str()] = columns_of(curve);
    dict["curves"] = curves;
    return dict;
}

py::list observables_of(const Results& results) {
    py::list list;
    for (const ObservableResult& result : results.observables) {
        list.append(dict_of(result, results.source.time_unit));
    }
    return list;
}

/// The last snapshot, for the map of the report.
Preview last_of(const Trajectory& trajectory, const analysis::BondOrderOptions& bonds) {
    Preview preview;
    preview.snapshot = trajectory.snapshots.back();
    preview.frame.index = preview.snapshot.frame;
    preview.frame.time = preview.snapshot.time;
    preview.abs_q4 = analysis::abs_q4(preview.snapshot, trajectory.info.diameter, bonds);
    return preview;
}

SharedResults measure(const std::shared_ptr<Trajectory>& trajectory, const std::string& label,
                      int threads, const py::dict& keywords) {
    struct Measuring {
        analysis::AnalysisOptions options;
        pipelines::Job job;
        SharedResults results = std::make_shared<Results>();
    };
    const auto measuring = std::make_shared<Measuring>();
    set_options(analysis::describe(measuring->options), keywords);
    measuring->job.command = "analyze";
    measuring->job.threads = thread_count(threads);
    run_released([measuring, trajectory, label] {
        pipelines::Job& job = measuring->job;
        const auto bonds = measuring->options.of<analysis::BondOrderOptions>();
        Results& results = *measuring->results;
        results = analysis::measure(*trajectory, measuring->options,
                                    {.threads = job.threads, .plan = &job.plan});
        results.identity = identity_of(results.source);
        results.label = label.empty() ? legend_of(results.identity) : label;
        if (!trajectory->snapshots.empty()) results.previews = {last_of(*trajectory, bonds)};
        results.record = job.record();
    });
    pass_on(measuring->job.plan);
    return measuring->results;
}

std::vector<std::filesystem::path> compare(const std::vector<SharedResults>& runs,
                                           const std::filesystem::path& output,
                                           const std::string& title, bool figures, bool paper,
                                           bool overwrite) {
    const auto job = std::make_shared<pipelines::Job>();
    job->command = "compare";
    job->threads = thread_count(0);
    job->overwrite = overwrite ? Overwrite::force : Overwrite::refuse;
    run_released([=] {
        std::vector<Results> compared;
        for (const SharedResults& run : runs) compared.push_back(*run);
        pipelines::ReportPage page(output, {.title = title, .figures = figures, .paper = paper},
                                   *job);
        page.draw(compared, *job);
        throw_if_interrupted("comparison");
        page.commit(*job);
    });
    pass_on(job->plan);
    return job->outputs;
}

/// Q_k and the number of neighbours of each particle of one snapshot, in its order; NaN and 0 where
/// the position is not finite.
py::tuple bond_order(const std::shared_ptr<Trajectory>& trajectory, std::int64_t index,
                     const py::dict& keywords) {
    constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
    struct Order {
        analysis::BondOrderOptions options;
        std::vector<std::complex<double>> q;
        std::vector<int> neighbours;
    };
    const auto order = std::make_shared<Order>();
    set_options({analysis::describe(order->options)}, keywords);
    run_released([order, trajectory, index] {
        const Snapshot& snapshot = trajectory->snapshots.at(static_cast<std::size_t>(index));
        const double diameter = analysis::diameter_of(trajectory->info);
        const analysis::BondOrderField field =
            analysis::bond_order(analysis::pattern_of(snapshot, diameter), order->options);
        order->q.assign(snapshot.size(), {undefined, undefined});
        order->neighbours.assign(snapshot.size(), 0);
        std::size_t next = 0;  // of the pattern, which has the finite positions alone
        for (std::size_t i = 0; i < snapshot.size(); ++i) {
            const Vec2 p = snapshot.position[i];
            if (!is_finite({p.x / diameter, p.y / diameter})) continue;
            order->q[i] = field.q[next];
            order->neighbours[i] = field.neighbours[next++];
        }
    });
    return py::make_tuple(py::array_t<std::complex<double>>(
                              static_cast<py::ssize_t>(order->q.size()), order->q.data()),
                          py::array_t<int>(static_cast<py::ssize_t>(order->neighbours.size()),
                                           order->neighbours.data()));
}

py::list options_of(const std::string& job) {
    analysis::AnalysisOptions options;
    std::vector<OptionTable> tables = analysis::describe(options);
    if (job != "analyze") {
        std::erase_if(tables, [&](const OptionTable& table) { return table.section() != job; });
    }
    return listed_options(tables);
}

}  // namespace

void bind_measuring(py::module_& module) {
    py::class_<Results, SharedResults>(module, "Results")
        .def_readwrite("label", &Results::label)
        .def_readonly("frames", &Results::frames)
        .def_readonly("particles_mean", &Results::particles_mean)
        .def_property_readonly("diameter", [](const Results& r) { return r.source.diameter; })
        .def("observables", &observables_of)
        .def(
            "save",
            [](const SharedResults& results, const std::filesystem::path& path, bool overwrite) {
                run_released([=] {
                    io::write_results(path, *results,
                                      overwrite ? Overwrite::force : Overwrite::refuse);
                });
            },
            py::arg("path"), py::arg("overwrite"));
    module.def("measure", &measure, py::arg("trajectory"), py::arg("label"), py::arg("threads"),
               py::arg("options"));
    module.def("compare", &compare, py::arg("runs"), py::arg("output"), py::arg("title"),
               py::arg("figures"), py::arg("paper"), py::arg("overwrite"));
    module.def("bond_order", &bond_order, py::arg("trajectory"), py::arg("index"),
               py::arg("options"));
    module.def(
        "read_results",
        [](const std::filesystem::path& path) {
            auto results = std::make_shared<Results>();
            run_released([=] { *results = io::read_results(path); });
            return results;
        },
        py::arg("path"));
    module.def("options_of_analysis", &options_of, py::arg("job"));
    module.def("observable_names", [] {
        std::vector<std::string> names;
        for (const analysis::Observable& o : analysis::observables()) names.push_back(o.name);
        return names;
    });
}

}  // namespace grainfield::python
