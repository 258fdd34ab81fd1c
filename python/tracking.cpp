#include "python/tracking.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/errors.h"
#include "core/memory_frames.h"
#include "core/support/interrupt.h"
#include "core/support/parallel.h"
#include "io/read_ahead.h"
#include "pipelines/configuration.h"
#include "pipelines/film/film.h"
#include "pipelines/track/track_job.h"
#include "python/errors.h"
#include "python/frames.h"
#include "python/options.h"
#include "python/released.h"
#include "tracking/tracking.h"

namespace py = pybind11;

namespace grainfield::python {

namespace {

using tracking::Tracker;
using tracking::TrackOptions;
using tracking::TrackSummary;
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Integers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

std::vector<OptionTable> tables_of_image(TrackOptions& options) {
    std::vector<OptionTable> tables = tracking::describe(options);
    std::erase_if(tables, [](const OptionTable& table) { return table.section() == "link"; });
    return tables;
}

std::vector<OptionTable> tables_of_film(TrackOptions& options, pipelines::FilmOptions& film) {
    std::vector<OptionTable> tables{OptionTable("")};
    pipelines::describe(film, tables.front());
    for (OptionTable& table : tracking::describe(options)) tables.push_back(std::move(table));
    return tables;
}

tracking::VisiblePixels visible_of(const py::object& mask) {
    if (mask.is_none()) return {};
    return tracking::VisiblePixels(image_of(mask, "the mask"));
}

void require_fitting(const tracking::VisiblePixels& visible, int width, int height) {
    const Image& mask = visible.mask();
    if (mask.empty() || (mask.width() == width && mask.height() == height)) return;
    throw InputError({"the mask does not fit",
                      fmt::format("{} x {} px", mask.width(), mask.height()),
                      fmt::format("{} x {} px, as the image", width, height), ""});
}

py::dict dict_of(const TrackSummary& summary,
                 const std::optional<pipelines::SphereImage>& spheres) {
    py::dict dict;
    dict["frames"] = summary.frames;
    dict["frames_corrupt"] = summary.frames_corrupt;
    dict["frames_missing"] = summary.frames_missing;
    dict["particles_mean"] = summary.particles_mean;
    dict["residual_rms"] = summary.residual_rms;
    dict["step_rms"] = summary.step_rms;
    dict["ms_per_frame"] = summary.ms_per_frame.wall;
    dict["disc_diameter"] = py::none();
    dict["edge_width"] = py::none();
    dict["binning"] = py::none();
    dict["binning_reason"] = py::none();
    dict["polarity"] = py::none();
    if (spheres) {
        dict["disc_diameter"] = spheres->diameter;
        dict["edge_width"] = spheres->edge_width;
        dict["binning"] = spheres->binning;
        dict["binning_reason"] = spheres->binning_reason;
        dict["polarity"] = spheres->polarity == tracking::Polarity::dark ? "dark" : "bright";
    }
    return dict;
}

std::optional<pipelines::SphereImage> spheres_of(const Tracker& tracker) {
    if (!tracker.is_calibrated()) return std::nullopt;
    const tracking::ImageModel& model = tracker.model();
    return pipelines::SphereImage{model.polarity, model.disc.diameter, model.disc.edge_width,
                                  tracker.binning().factor, tracker.binning_reason()};
}

/// What a run of the tracker uses and makes.
struct Run {
    TrackOptions options;
    pipelines::FilmOptions film;
    std::unique_ptr<FrameSource> frames;
    RunPlan plan;
    std::shared_ptr<Trajectory> trajectory = std::make_shared<Trajectory>();
    TrackSummary summary;
    std::optional<pipelines::SphereImage> spheres;
};

class Kept : public SnapshotSink {
 public:
    explicit Kept(std::vector<Snapshot>& snapshots) : snapshots_(snapshots) {}
    void write(const Snapshot& snapshot) override { snapshots_.push_back(snapshot); }

 private:
    std::vector<Snapshot>& snapshots_;
};

void track(Run& run, FrameSource& frames) {
    Tracker tracker(frames, run.options, run.plan);
    run.trajectory->info = tracker.info();
    run.spheres = spheres_of(tracker);
    Kept sink(run.trajectory->snapshots);
    Progress unseen("tracking", 0, "frames", Verbosity::quiet);
    run.summary = tracker.run(sink, unseen);
    throw_if_interrupted("tracking");
}

py::tuple outcome(const Run& run) {
    pass_on(run.plan);
    return py::make_tuple(run.trajectory, dict_of(run.summary, run.spheres));
}

py::tuple locate(const py::object& image, const py::object& mask, int threads,
                 const py::dict& keywords) {
    const auto run = std::make_shared<Run>();
    set_options(tables_of_image(run->options), keywords);
    run->options.threads = threads;
    Image counts = image_of(image, "the image");
    const auto [least, most] = std::ranges::minmax(counts.pixels());
    if (most > least && most - least < 2) {
        throw InputError({"the image has too few counts",
                          fmt::format("a span of {:g}", most - least), "counts that span 2 or more",
                          "multiply an image of 0 to 1 by 255 or 65535"});
    }
    run->options.visible = visible_of(mask);
    require_fitting(run->options.visible, counts.width(), counts.height());
    std::vector<Image> images;
    images.push_back(std::move(counts));
    run->frames = std::make_unique<MemoryFrames>(std::move(images), std::nullopt, "image");
    run_released([run] { track(*run, *run->frames); });
    return outcome(*run);
}

py::tuple track_frames(const py::object& frames, std::optional<double> fps, const py::object& mask,
                       int threads, const py::dict& keywords) {
    const auto run = std::make_shared<Run>();
    set_options(tracking::describe(run->options), keywords);
    run->options.threads = threads;
    auto source = frames_of(frames, fps);
    run->options.visible = visible_of(mask);
    require_fitting(run->options.visible, source->width(), source->height());
    run->frames = io::read_ahead(std::move(source));
    run_released([run] {
        // The frame that is read ahead may wait for the interpreter lock, and frames wait for it
        // when they go. So they go here, where the lock is not held.
        const std::unique_ptr<FrameSource> ahead = std::move(run->frames);
        track(*run, *ahead);
    });
    return outcome(*run);
}

py::tuple track_files(const std::vector<std::filesystem::path>& files, int threads,
                      const py::dict& keywords) {
    const auto run = std::make_shared<Run>();
    set_options(tables_of_film(run->options, run->film), keywords);
    run->options.threads = threads;
    run_released([run, files] {
        pipelines::Job job;
        job.command = "track";
        job.inputs = files;
        job.threads = thread_count(run->options.threads);
        const pipelines::Film film = pipelines::open_film(job, run->film, run->options);
        run->options.visible = film.visible;
        track(*run, *film.frames);
        for (Snapshot& snapshot : run->trajectory->snapshots) {
            // Positions are in pixels of the whole frame.
            for (Vec2& p : snapshot.position) p += film.origin;
            snapshot.box.origin += film.origin;
        }
        for (const Warning& warning : job.plan.warnings()) run->plan.warn(warning);
    });
    return outcome(*run);
}

/// The job of the command line, with its output.
py::dict track_to_file(const std::vector<std::filesystem::path>& files,
                       const std::filesystem::path& output, bool overwrite, bool resume,
                       int threads, const py::dict& keywords) {
    struct FileRun {
        pipelines::TrackJobOptions options;
        pipelines::Job job;
        pipelines::TrackJobResult result;
    };
    const auto run = std::make_shared<FileRun>();
    const std::vector<OptionTable> tables =
        tables_of_film(run->options.tracking, run->options.film);
    set_options(tables, keywords);
    run->options.output = output;
    run->options.resume.resume = resume;
    run->job.command = "track";
    run->job.inputs = files;
    run->job.configuration = pipelines::physics_of(tables);
    run->job.threads = thread_count(threads);
    run->job.overwrite = overwrite ? Overwrite::force : Overwrite::refuse;
    run_released([run] {
        run->result = pipelines::track_film(run->options, run->job);
        throw_if_interrupted("tracking");
    });
    pass_on(run->job.plan);
    return dict_of(run->result.summary, run->result.spheres);
}

/// Points to link, in order of their frames.
struct Points {
    std::vector<std::int64_t> frames;
    std::vector<std::vector<Vec2>> position;
    std::vector<std::vector<Vec2>> error;
};

std::shared_ptr<Points> points_of(const Integers& frame, const Numbers& position,
                                  const std::optional<Numbers>& error) {
    const py::ssize_t rows = position.ndim() == 2 ? position.shape(0) : 0;
    const bool has_errors = error.has_value();
    if (position.ndim() != 2 || position.shape(1) != 2 || frame.ndim() != 1 ||
        frame.shape(0) != rows ||
        (has_errors && (error->ndim() != 2 || error->shape(0) != rows || error->shape(1) != 2))) {
        throw InputError({"these points cannot be linked",
                          fmt::format("{} frames, {} positions", frame.size(), rows),
                          "as many frames as positions (and errors), in two dimensions", ""});
    }
    auto points = std::make_shared<Points>();
    for (py::ssize_t i = 0; i < rows; ++i) {
        if (points->frames.empty() || points->frames.back() != frame.at(i)) {
            points->frames.push_back(frame.at(i));
            points->position.emplace_back();
            points->error.emplace_back();
        }
        points->position.back().push_back({position.at(i, 0), position.at(i, 1)});
        if (has_errors) points->error.back().push_back({error->at(i, 0), error->at(i, 1)});
    }
    return points;
}

py::array_t<std::int64_t> link(const Integers& frame, const Numbers& position,
                               const std::optional<Numbers>& error, double diameter,
                               const py::dict& keywords) {
    struct Linking {
        tracking::LinkOptions options;
        std::shared_ptr<Points> points;
        std::vector<std::int64_t> ids;
        RunPlan plan;
    };
    const auto linking = std::make_shared<Linking>();
    set_options({tracking::describe(linking->options)}, keywords);
    linking->points = points_of(frame, position, error);
    run_released([linking, diameter] {
        const Points& points = *linking->points;
        tracking::Linker linker(linking->options, diameter);
        std::map<std::int64_t, int> seen;
        for (std::size_t i = 0; i < points.frames.size(); ++i) {
            throw_if_interrupted("linking");
            for (const std::int64_t id :
                 linker.link(points.frames[i], points.position[i], points.error[i])) {
                linking->ids.push_back(id);
                ++seen[id];
            }
        }
        for (std::int64_t& id : linking->ids) {
            if (seen[id] < linking->options.minimum_length) id = -1;
        }
        // Without a diameter no step is too long for it.
        const double least = diameter > 0 ? diameter : std::numeric_limits<double>::infinity();
        for (const std::string& warning : linker.warnings(least)) linking->plan.warn(warning);
    });
    pass_on(linking->plan);
    return py::array_t<std::int64_t>(static_cast<py::ssize_t>(linking->ids.size()),
                                     linking->ids.data());
}

py::list options_of(const std::string& job) {
    TrackOptions track;
    pipelines::FilmOptions film;
    tracking::LinkOptions link;
    if (job == "locate") return listed_options(tables_of_image(track));
    if (job == "link") return listed_options({tracking::describe(link)});
    return listed_options(tables_of_film(track, film));
}

}  // namespace

void bind_tracking(py::module_& module) {
    module.def("locate", &locate, py::arg("image"), py::arg("mask"), py::arg("threads"),
               py::arg("options"));
    module.def("track_frames", &track_frames, py::arg("frames"), py::arg("fps"), py::arg("mask"),
               py::arg("threads"), py::arg("options"));
    module.def("track_files", &track_files, py::arg("files"), py::arg("threads"),
               py::arg("options"));
    module.def("track_to_file", &track_to_file, py::arg("files"), py::arg("output"),
               py::arg("overwrite"), py::arg("resume"), py::arg("threads"), py::arg("options"));
    module.def("link", &link, py::arg("frame"), py::arg("position"), py::arg("error"),
               py::arg("diameter"), py::arg("options"),
               "Identity of each point, -1 for those of tracks that are too short.");
    module.def("options_of_tracking", &options_of, py::arg("job"));
}

}  // namespace grainfield::python
