#include "python/simulation.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "core/errors.h"
#include "python/errors.h"
#include "python/options.h"
#include "python/released.h"
#include "simulate/simulate.h"

namespace py = pybind11;

namespace grainfield::python {

namespace {

std::shared_ptr<Trajectory> simulate_md(std::uint64_t seed, int threads, const py::dict& keywords) {
    struct Run {
        simulate::MdOptions options;
        RunPlan plan;
        std::shared_ptr<Trajectory> trajectory = std::make_shared<Trajectory>();
    };
    const auto run = std::make_shared<Run>();
    set_options(simulate::describe(run->options), keywords);
    run_released([run, seed, threads] {
        *run->trajectory = simulate::simulate_md(
            run->options, {.seed = seed, .threads = threads, .plan = &run->plan});
    });
    pass_on(run->plan);
    return run->trajectory;
}

/// Density [instant × replica × y × x] in one array that keeps none of the frames.
py::array_t<double> densities_of(const std::vector<FieldFrame>& frames) {
    const DensityField& first = frames.front().density.front();
    const auto replicas = static_cast<py::ssize_t>(frames.front().density.size());
    py::array_t<double> array({static_cast<py::ssize_t>(frames.size()), replicas,
                               static_cast<py::ssize_t>(first.ny),
                               static_cast<py::ssize_t>(first.nx)});
    double* to = array.mutable_data();
    for (const FieldFrame& frame : frames) {
        for (const DensityField& density : frame.density) {
            to = std::ranges::copy(density.value, to).out;
        }
    }
    return array;
}

/// ψ [instant × y × x], empty where there is none.
py::array_t<double> orders_of(const std::vector<FieldFrame>& frames) {
    const DensityField& first = frames.front().order;
    if (first.value.empty()) return py::array_t<double>(0);
    py::array_t<double> array({static_cast<py::ssize_t>(frames.size()),
                               static_cast<py::ssize_t>(first.ny),
                               static_cast<py::ssize_t>(first.nx)});
    double* to = array.mutable_data();
    for (const FieldFrame& frame : frames) to = std::ranges::copy(frame.order.value, to).out;
    return array;
}

py::dict simulate_field(std::uint64_t seed, int threads, const py::dict& keywords) {
    struct Run {
        simulate::FieldOptions options;
        RunPlan plan;
        std::vector<FieldFrame> frames;
    };
    const auto run = std::make_shared<Run>();
    set_options(simulate::describe(run->options), keywords);
    run_released([run, seed, threads] {
        run->frames = simulate::simulate_field(
            run->options, {.seed = seed, .threads = threads, .plan = &run->plan});
    });
    pass_on(run->plan);
    const std::vector<FieldFrame>& frames = run->frames;
    if (frames.empty()) {
        throw OptionError({"the run has no instant to hand out", "none",
                           "record.record of at least one record.sample", ""});
    }
    py::array_t<double> time(static_cast<py::ssize_t>(frames.size()));
    py::array_t<double> diffusivity(static_cast<py::ssize_t>(frames.size()));
    for (std::size_t i = 0; i < frames.size(); ++i) {
        time.mutable_data()[i] = frames[i].density.front().time;
        diffusivity.mutable_data()[i] = frames[i].mean_diffusivity;
    }
    py::dict fields;
    fields["time"] = time;
    fields["density"] = densities_of(frames);
    fields["order"] = orders_of(frames);
    fields["mean_diffusivity"] = diffusivity;
    fields["spacing"] = frames.front().density.front().spacing;
    fields["dimension"] = frames.front().dimension;
    return fields;
}

template <class Count>
py::array_t<Count> pictures_of(const std::vector<Frame>& frames) {
    const auto shown =
        std::ranges::find_if(frames, [](const Frame& f) { return !f.image.empty(); });
    if (shown == frames.end()) return py::array_t<Count>({0, 0, 0});
    const auto height = static_cast<py::ssize_t>(shown->image.height());
    const auto width = static_cast<py::ssize_t>(shown->image.width());
    py::array_t<Count> array({static_cast<py::ssize_t>(frames.size()), height, width});
    Count* to = array.mutable_data();
    for (const Frame& frame : frames) {
        if (frame.image.empty()) {
            to = std::fill_n(to, width * height, Count{0});
        } else {
            to = std::ranges::transform(frame.image.pixels(), to, [](float count) {
                     return static_cast<Count>(count);
                 }).out;
        }
    }
    return array;
}

py::tuple render(const std::shared_ptr<Trajectory>& trajectory, std::uint64_t seed, int threads,
                 const py::dict& keywords) {
    struct Run {
        simulate::RenderOptions options;
        RunPlan plan;
        simulate::RenderedFilm film;
    };
    const auto run = std::make_shared<Run>();
    set_options(simulate::describe(run->options), keywords);
    run_released([run, trajectory, seed, threads] {
        run->film = simulate::render(*trajectory, run->options,
                                     {.seed = seed, .threads = threads, .plan = &run->plan});
    });
    pass_on(run->plan);
    std::vector<bool> is_lost;
    for (const Frame& frame : run->film.frames) is_lost.push_back(frame.image.empty());
    const py::object pictures = run->options.sensor.bits > 8
                                    ? py::object(pictures_of<std::uint16_t>(run->film.frames))
                                    : py::object(pictures_of<std::uint8_t>(run->film.frames));
    return py::make_tuple(pictures, std::make_shared<Trajectory>(std::move(run->film.truth)),
                          is_lost);
}

py::list options_of(const std::string& job) {
    simulate::MdOptions md;
    simulate::FieldOptions field;
    simulate::RenderOptions render;
    if (job == "simulate_md") return listed_options(simulate::describe(md));
    if (job == "simulate_field") return listed_options(simulate::describe(field));
    return listed_options(simulate::describe(render));
}

}  // namespace

void bind_simulation(py::module_& module) {
    module.def("simulate_md", &simulate_md, py::arg("seed"), py::arg("threads"),
               py::arg("options"));
    module.def("simulate_field", &simulate_field, py::arg("seed"), py::arg("threads"),
               py::arg("options"));
    module.def("render", &render, py::arg("trajectory"), py::arg("seed"), py::arg("threads"),
               py::arg("options"));
    module.def("options_of_simulation", &options_of, py::arg("job"));
}

}  // namespace grainfield::python
