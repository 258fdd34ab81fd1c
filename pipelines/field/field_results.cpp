#include "pipelines/field/field_results.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/progress.h"
#include "io/h5/field_file.h"
#include "io/selected_snapshots.h"

namespace grainfield::pipelines {

namespace {

// The last stored fields as pictures: ρ, and ψ where there is one.
std::vector<Preview> pictures(FieldSource& fields) {
    if (fields.count() == 0) return {};
    const FieldFrame last = fields.read(fields.count() - 1);
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

[[noreturn]] void refuse_frames(const FieldChoice& choice) {
    throw OptionError({.problem = "what a run of the field accumulated is of all of its samples",
                       .actual = fmt::format("frames '{}'", choice.frames),
                       .expected = "all frames, or option 'from-fields'",
                       .suggestion = "that measures the stored fields, and some of them if asked"});
}

void say_samples(const io::FieldFile& file, std::int64_t chosen, bool accumulated, RunPlan& plan) {
    if (accumulated) {
        plan.run("statistics", "as accumulated by the run over all of its samples");
        plan.skip("stored fields", fmt::format("{} of them are among the samples", file.count()),
                  "one Fourier transform a field");
    } else if (chosen == file.count()) {
        plan.run("stored fields", fmt::format("{} of them", file.count()));
    } else {
        plan.run("stored fields", fmt::format("{} of {}", chosen, file.count()));
    }
}

/// The fields that were asked for.
class ChosenFields {
 public:
    ChosenFields(const std::filesystem::path& path, const FieldChoice& choice, RunPlan& plan)
        : file_(path),
          selected_(file_, io::selection_or_none(choice.frames, file_.count())),
          accumulated_(takes_accumulated(file_, choice.samples)) {
        if (accumulated_ && selected_.count() < file_.count()) refuse_frames(choice);
        say_samples(file_, selected_.count(), accumulated_, plan);
    }
    const io::FieldFile& file() const { return file_; }
    io::SelectedFields& fields() { return selected_; }
    bool are_accumulated() const { return accumulated_; }

 private:
    io::FieldFile file_;
    io::SelectedFields selected_;
    bool accumulated_;
};

}  // namespace

void plan_field_results(const std::filesystem::path& path, const FieldChoice& choice,
                        RunPlan& plan) {
    const ChosenFields chosen(path, choice, plan);
}

Results field_results(const std::filesystem::path& path, const FieldChoice& choice,
                      const analysis::FieldAnalysisOptions& options, Job& job) {
    ChosenFields chosen(path, choice, job.plan);
    const io::FieldFile& file = chosen.file();
    FieldSource& fields = chosen.fields();
    Results results;
    results.frames = fields.count();
    results.source.source = path.string();
    std::optional<FieldFrame> first;
    if (fields.count() > 0) first = fields.read(0);
    results.box = first ? first->density.front().box() : Box{.origin = {}, .length = {1, 1}};
    if (!file.record().command.empty()) results.sources = {file.record()};
    results.identity = file.identity();
    results.previews = pictures(fields);
    if (chosen.are_accumulated()) {
        results.observables = file.statistics();
        analysis::add_fits(results.observables, first ? &*first : nullptr, options);
    } else {
        Progress progress("analysing", fields.count(), "fields", job.verbosity);
        results.observables = analysis::analyze_fields(fields, options, progress);
    }
    name_lengths(results.observables);
    return results;
}

}  // namespace grainfield::pipelines
