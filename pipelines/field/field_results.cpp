#include "pipelines/field/field_results.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/support/progress.h"
#include "io/h5/field_file.h"

namespace grainfield::pipelines {

namespace {

// The last stored fields as pictures: ρ, and ψ where there is one.
std::vector<Preview> pictures(io::FieldFile& file) {
    if (file.count() == 0) return {};
    const FieldFrame last = file.read(file.count() - 1);
    if (last.dimension != 2) return {};
    std::vector<Preview> previews;
    const auto add = [&](const DensityField& field) {
        if (field.value.empty()) return;
        Preview preview;
        preview.frame.index = preview.snapshot.frame = static_cast<std::int64_t>(previews.size());
        preview.frame.image = Image(field.nx, field.ny);
        std::ranges::transform(field.value, preview.frame.image.pixels().begin(),
                               [](double v) { return static_cast<float>(v); });
        preview.snapshot.box = field.box();
        previews.push_back(std::move(preview));
    };
    add(last.density.front());
    add(last.order);
    return previews;
}

// Estimators speak of the particle diameter a; the lengths of a field are in its own unit l.
void name_lengths(std::vector<ObservableResult>& observables) {
    for (ObservableResult& observable : observables) {
        for (Measurement& m : observable.measurements) m.unit = m.unit.on_lattice();
        for (Curve& curve : observable.curves) {
            for (Column& column : curve.columns) {
                column.unit = column.unit.on_lattice();
                if (column.name == "k") column.meaning = "Wavevector k";
            }
        }
    }
}

bool takes_accumulated(const io::FieldFile& file, FieldSamples samples) {
    return samples == FieldSamples::accumulated && !file.statistics().empty();
}

void say_samples(io::FieldFile& file, bool accumulated, RunPlan& plan) {
    if (accumulated) {
        plan.run("statistics", "as accumulated by the run over all of its samples");
        plan.skip("stored fields", fmt::format("{} of them are among the samples", file.count()),
                  "one Fourier transform a field");
    } else {
        plan.run("stored fields", fmt::format("{} of them", file.count()));
    }
}

}  // namespace

void plan_field_results(const std::filesystem::path& path, FieldSamples samples, RunPlan& plan) {
    io::FieldFile file(path);
    say_samples(file, takes_accumulated(file, samples), plan);
}

Results field_results(const std::filesystem::path& path, FieldSamples samples,
                      const analysis::FieldAnalysisOptions& options, Job& job) {
    io::FieldFile file(path);
    Results results;
    results.frames = file.count();
    results.source.source = path.string();
    if (file.count() > 0) results.box = file.read(0).density.front().box();
    if (file.count() == 0) results.box = Box{.origin = {}, .length = {1, 1}};
    const bool accumulated = takes_accumulated(file, samples);
    say_samples(file, accumulated, job.plan);
    if (!file.record().command.empty()) results.sources = {file.record()};
    results.identity = file.identity();
    results.previews = pictures(file);
    if (accumulated) {
        results.observables = file.statistics();
        std::optional<FieldFrame> like;
        if (file.count() > 0) like = file.read(0);
        analysis::add_fits(results.observables, like ? &*like : nullptr, options);
    } else {
        Progress progress("analysing", file.count(), "fields", job.verbosity);
        results.observables = analysis::analyze_fields(file, options, progress);
    }
    name_lengths(results.observables);
    return results;
}

}  // namespace grainfield::pipelines
