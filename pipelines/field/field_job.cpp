#include "pipelines/field/field_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "analysis/density/field_statistics.h"
#include "analysis/spectra/adjoint_spectrum.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/progress.h"
#include "io/h5/field_file.h"
#include "io/h5/field_log.h"
#include "pipelines/interrupt_deadline.h"
#include "simulate/field/field_run.h"
#include "simulate/field/field_size.h"
#include "simulate/field/integrators/adjoint.h"
#include "simulate/field/integrators/integrator_choice.h"

namespace grainfield::pipelines {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double longest_chunk = 0.2;  // seconds without a look at signals and progress

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Something that advances in steps and can be saved: a density or an adjoint estimator.
class Work {
 public:
    virtual ~Work() = default;
    virtual std::int64_t step() const = 0;
    virtual std::int64_t advance(std::int64_t at_most) = 0;
    virtual void save(Checkpoint& checkpoint) = 0;
    virtual double mass_drift() const { return 0; }
    virtual void finish(io::FieldWriter& writer) { static_cast<void>(writer); }
    virtual std::size_t memory() const { return 0; }  ///< of fields and tables [B]
    virtual std::vector<ObservableResult> results() const = 0;
};

class DensityWork : public Work {
 public:
    DensityWork(const FieldJobOptions& options, const simulate::FieldPlan& plan, io::RecordLog& log,
                const Checkpoint* from)
        : fields_(simulate::make_integrator(plan.setup, plan.threads)),
          statistics_(options.sk, plan.schedule.samples, plan.setup.k_cut),
          log_(log),
          run_(*fields_, plan.schedule, statistics_, log_),
          mass_at_start_(fields_->mass(0)) {
        if (from == nullptr) return;
        mass_at_start_ = recorded_mass(*from);
        fields_->restore(*from);
        statistics_.restore(*from, simulate::frame_of(*fields_));
    }
    std::int64_t step() const override { return fields_->step(); }
    std::int64_t advance(std::int64_t at_most) override { return run_.advance(at_most); }
    void save(Checkpoint& checkpoint) override {
        simulate::require_finite(*fields_);
        fields_->save(checkpoint);
        statistics_.save(checkpoint);
        checkpoint.reals["mass at start"] = {mass_at_start_};
    }
    double mass_drift() const override {
        const simulate::FieldSetup& setup = fields_->setup();
        const double cell = setup.lattice.cell_volume();
        const double deviation = std::sqrt(setup.model.c1 / (2 * setup.model.d0 * cell));
        const double drift = std::abs(fields_->mass(0) - mass_at_start_) / setup.lattice.volume();
        return std::isfinite(deviation) && deviation > 0 ? drift / deviation : drift;
    }
    void finish(io::FieldWriter& writer) override {
        for (std::int64_t i = 0; i < log_.count(); ++i) writer.write(log_.read(i));
    }
    std::size_t memory() const override { return fields_->memory(); }
    std::vector<ObservableResult> results() const override { return statistics_.results(); }

 private:
    static double recorded_mass(const Checkpoint& from) {
        const auto mass = from.reals.find("mass at start");
        if (mass == from.reals.end() || mass->second.size() != 1) {
            throw InputError("the checkpoint does not fit: it is not one of a density run.");
        }
        return mass->second[0];
    }

    std::unique_ptr<simulate::FieldIntegrator> fields_;
    analysis::FieldStatistics statistics_;
    io::FieldLog log_;
    simulate::FieldRun run_;
    double mass_at_start_;
};

class AdjointWork : public Work {
 public:
    AdjointWork(const simulate::FieldPlan& plan, const Checkpoint* from)
        : total_(plan.schedule.total()),
          nu_(plan.setup.has_order ? plan.setup.model.nu : 1),
          adjoint_(plan.setup, plan.waves, plan.threads) {
        if (from != nullptr) adjoint_.restore(*from);
    }
    std::int64_t step() const override { return adjoint_.step(); }
    std::int64_t advance(std::int64_t at_most) override {
        const std::int64_t steps = std::min(std::max<std::int64_t>(at_most, 1), total_ - step());
        adjoint_.advance(steps);
        return steps;
    }
    void save(Checkpoint& checkpoint) override { adjoint_.save(checkpoint); }
    std::vector<ObservableResult> results() const override;

 private:
    std::int64_t total_;
    double nu_;
    simulate::AdjointEstimator adjoint_;
};

std::vector<ObservableResult> AdjointWork::results() const {
    std::vector<analysis::WaveSamples> waves;
    for (std::size_t w = 0; w < adjoint_.waves(); ++w) {
        waves.push_back({adjoint_.wavenumber(w), adjoint_.samples(w)});
    }
    return {analysis::adjoint_spectrum(waves, adjoint_.time() * nu_)};
}

std::unique_ptr<Work> begin(const FieldJobOptions& options, const simulate::FieldPlan& plan,
                            Resumable& resumable) {
    if (plan.waves.empty()) {
        return std::make_unique<DensityWork>(options, plan, resumable.log(), resumable.from());
    }
    return std::make_unique<AdjointWork>(plan, resumable.from());
}

/// What a checkpoint of this run belongs to. An adjoint run stores no fields on its way.
Resumable::Identity identity_of(const FieldJobOptions& options, const simulate::FieldPlan& plan) {
    const bool is_adjoint = !plan.waves.empty();
    simulate::FieldOptions field = options.field;
    Configuration physics = physics_of(simulate::describe(field));
    physics.emplace_back("seed", std::to_string(field.seed));
    physics.emplace_back("sk.k-max", fmt::format("{}", options.sk.k_max));
    return {.kind = is_adjoint ? "field adjoint" : "field",
            .output = options.output,
            .log = is_adjoint ? "" : ".fields",
            .configuration = std::move(physics),
            .record = options.output};
}

// Sixteen blocks of sums of two quantities for each mode, of the density and of the order.
double bytes_of_spectra(const FieldJobOptions& options) {
    constexpr double bytes_of_mode = 512;
    const simulate::LatticeOptions& lattice = options.field.lattice;
    const double rows = lattice.dimension == 1 ? 1 : lattice.ny == 0 ? lattice.nx : lattice.ny;
    const auto below = [&](double cells) {
        const double most = options.sk.k_max * cells * lattice.spacing / (2 * std::numbers::pi);
        return std::min(1 + 2 * most, cells);
    };
    return bytes_of_mode * below(lattice.nx) * (lattice.dimension == 1 ? 1 : below(rows)) / 2;
}

void require_room(const FieldJobOptions& options, Job& job) {
    JobSize size = simulate::size_of(options.field);
    size.bytes += bytes_of_spectra(options);
    require_room(size, available_memory(),
                 "use a smaller lattice (lattice.nx, lattice.ny), fewer record.replicas or a "
                 "shorter record.record",
                 job.size_check, job.plan);
}

void save(Work& work, Resumable& resumable) {
    Checkpoint checkpoint;
    work.save(checkpoint);
    resumable.save(std::move(checkpoint));
}

/// Advances `work` to `total`, saving now and then; returns the signal that stopped it, if any.
int advance(Work& work, std::int64_t total, Resumable& resumable, Progress& progress) {
    std::int64_t chunk = 1;
    while (work.step() < total) {
        const Clock::time_point start = Clock::now();
        const std::int64_t steps = work.advance(chunk);
        progress.advance(steps);
        const double took = std::max(seconds_since(start), 1e-6);
        const double ideal = static_cast<double>(steps) * longest_chunk / took;
        chunk = std::clamp<std::int64_t>(static_cast<std::int64_t>(ideal), 1, 2 * chunk + 1);
        if (caught_signal() != 0) {
            save(work, resumable);
            return caught_signal();
        }
        if (resumable.is_due()) save(work, resumable);
    }
    return 0;
}

}  // namespace

void plan_field(const FieldJobOptions& options, Job& job) {
    const DiscardDeadline deadline("the plan", options.output.string());
    require_room(options, job);
    const simulate::FieldPlan plan = simulate::plan_field(options.field, job.plan);
    Resumable(job, identity_of(options, plan), options.resume).explain();
}

FieldJobResult run_field(const FieldJobOptions& options, Job& job) {
    std::optional<DiscardDeadline> starting(std::in_place, "the simulation",
                                            options.output.string());
    require_room(options, job);
    const simulate::FieldPlan plan = simulate::plan_field(options.field, job.plan);
    Resumable resumable(job, identity_of(options, plan), options.resume);
    resumable.require_free();
    starting.reset();
    const InterruptDeadline deadline([&](int signal) { return resumable.cut_off(signal); });
    io::FieldWriter writer(options.output, resumable.overwrite());
    resumable.start();
    const std::unique_ptr<Work> work = begin(options, plan, resumable);

    const std::int64_t total = plan.schedule.total();
    const std::int64_t first = work->step();
    Progress progress("simulating", total - first, "steps", job.verbosity);
    const Clock::time_point start = Clock::now();
    FieldJobResult result;
    result.signal = advance(*work, total, resumable, progress);
    progress.finish();
    const std::int64_t taken = work->step() - first;
    result.steps = work->step();
    result.scheme = plan.scheme;
    result.ms_per_step = taken > 0 ? 1e3 * seconds_since(start) / static_cast<double>(taken) : 0;
    result.mass_drift = work->mass_drift();
    result.memory_mb = static_cast<double>(work->memory()) / 1e6;
    result.statistics = work->results();
    if (result.signal != 0) {
        job.plan.warn(resumable.interrupted(static_cast<double>(result.steps),
                                            static_cast<double>(total), "steps"));
        return result;
    }
    work->finish(writer);
    writer.finish(result.statistics, simulate::identity_of(options.field), job.record());
    job.outputs.push_back(options.output);
    resumable.finish();
    return result;
}

}  // namespace grainfield::pipelines
