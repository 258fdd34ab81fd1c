#include "pipelines/field/field_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <system_error>

#include <fmt/format.h>

#include "analysis/density/field_statistics.h"
#include "analysis/spectra/adjoint_spectrum.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/progress.h"
#include "io/h5/checkpoint_file.h"
#include "io/h5/field_file.h"
#include "io/h5/field_log.h"
#include "simulate/field/adjoint.h"
#include "simulate/field/field_run.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double longest_chunk = 0.2;  // seconds without a look at signals and progress

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

fs::path with_suffix(fs::path path, const char* suffix) {
    path += suffix;
    return path;
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
    virtual void discard() {}
    virtual std::size_t memory() const { return 0; }  ///< of fields and tables [B]
    virtual std::vector<ObservableResult> results() const = 0;
};

class DensityWork : public Work {
 public:
    DensityWork(const FieldJobOptions& options, const simulate::FieldPlan& plan, int threads,
                const Checkpoint* from)
        : fields_(simulate::make_integrator(plan.setup, threads)),
          statistics_(options.sk, plan.schedule.samples),
          log_(with_suffix(options.output, ".fields"), from ? log_bytes(*from) : 0),
          run_(*fields_, plan.schedule, statistics_, log_),
          mass_at_start_(fields_->mass(0)) {
        if (from == nullptr) return;
        mass_at_start_ = from->reals.at("mass at start").at(0);
        fields_->restore(*from);
        statistics_.restore(*from, simulate::frame_of(*fields_));
    }
    std::int64_t step() const override { return fields_->step(); }
    std::int64_t advance(std::int64_t at_most) override { return run_.advance(at_most); }
    void save(Checkpoint& checkpoint) override {
        simulate::require_finite(*fields_);
        log_.sync();
        fields_->save(checkpoint);
        statistics_.save(checkpoint);
        checkpoint.integers["log bytes"] = {log_.bytes()};
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
    void discard() override { log_.remove(); }
    std::size_t memory() const override { return fields_->memory(); }
    std::vector<ObservableResult> results() const override { return statistics_.results(); }

 private:
    static std::int64_t log_bytes(const Checkpoint& from) {
        const auto found = from.integers.find("log bytes");
        const auto mass = from.reals.find("mass at start");
        if (found == from.integers.end() || found->second.size() != 1 || found->second[0] < 0 ||
            mass == from.reals.end() || mass->second.size() != 1) {
            throw InputError("the checkpoint does not fit: it is not one of a density run.");
        }
        return found->second[0];
    }

    std::unique_ptr<simulate::FieldIntegrator> fields_;
    analysis::FieldStatistics statistics_;
    io::FieldLog log_;
    simulate::FieldRun run_;
    double mass_at_start_;
};

class AdjointWork : public Work {
 public:
    AdjointWork(const simulate::FieldPlan& plan, int threads, const Checkpoint* from)
        : total_(plan.schedule.total()),
          nu_(plan.setup.has_order ? plan.setup.model.nu : 1),
          adjoint_(plan.setup, plan.waves, threads) {
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
                            int threads, const Checkpoint* from) {
    if (plan.waves.empty()) {
        return std::make_unique<DensityWork>(options, plan, threads, from);
    }
    return std::make_unique<AdjointWork>(plan, threads, from);
}

void save(Work& work, const FieldJobOptions& options, const fs::path& path) {
    Checkpoint checkpoint;
    work.save(checkpoint);
    checkpoint.configuration = simulate::physics_of(options.field);
    checkpoint.configuration.emplace_back("sk.k-max", fmt::format("{}", options.sk.k_max));
    io::write_checkpoint(checkpoint, path);
}

std::optional<Checkpoint> checkpoint_to_resume(const FieldJobOptions& options, const fs::path& path,
                                               Session& session) {
    const fs::path fields = with_suffix(options.output, ".fields");
    if (!options.resume) {
        for (const fs::path& left : {path, fields}) {
            if (session.common.force || !fs::exists(left)) continue;
            throw OutputError({.problem = fmt::format("'{}' exists: an interrupted run of '{}'",
                                                      left.string(), options.output.string()),
                               .actual = {},
                               .expected = {},
                               .suggestion = "go on with --resume, or start anew with --force"});
        }
        return std::nullopt;
    }
    if (!fs::exists(path)) {
        session.plan.warn(
            fmt::format("there is no '{}': starting from the beginning", path.string()));
        return std::nullopt;
    }
    Checkpoint checkpoint = io::read_checkpoint(path);
    auto configuration = simulate::physics_of(options.field);
    configuration.emplace_back("sk.k-max", fmt::format("{}", options.sk.k_max));
    io::require_same_configuration(checkpoint, configuration, path);
    return checkpoint;
}

/// Advances `work` to `total`, saving now and then; returns the signal that stopped it, if any.
int advance(Work& work, std::int64_t total, double checkpoint_every, Progress& progress,
            const std::function<void()>& save_now) {
    std::int64_t chunk = 1;
    Clock::time_point saved = Clock::now();
    while (work.step() < total) {
        const Clock::time_point start = Clock::now();
        const std::int64_t steps = work.advance(chunk);
        progress.advance(steps);
        const double took = std::max(seconds_since(start), 1e-6);
        const double ideal = static_cast<double>(steps) * longest_chunk / took;
        chunk = std::clamp<std::int64_t>(static_cast<std::int64_t>(ideal), 1, 2 * chunk + 1);
        if (caught_signal() != 0) {
            save_now();
            return caught_signal();
        }
        if (seconds_since(saved) < checkpoint_every) continue;
        save_now();
        saved = Clock::now();
    }
    return 0;
}

}  // namespace

FieldJobResult run_field_job(const FieldJobOptions& options, const simulate::FieldPlan& plan,
                             Session& session) {
    const auto overwrite = session.common.force ? io::Overwrite::force : io::Overwrite::refuse;
    const fs::path path = with_suffix(options.output, ".checkpoint");
    const std::optional<Checkpoint> from = checkpoint_to_resume(options, path, session);
    io::FieldWriter writer(options.output, overwrite);
    const std::unique_ptr<Work> work = begin(options, plan, plan.threads, from ? &*from : nullptr);

    const std::int64_t total = plan.schedule.total();
    const std::int64_t first = work->step();
    Progress progress("simulating", total - first, "steps", session.common.verbosity());
    const Clock::time_point start = Clock::now();
    FieldJobResult result;
    result.signal = advance(*work, total, options.checkpoint_every, progress,
                            [&] { save(*work, options, path); });
    progress.finish();
    const std::int64_t taken = work->step() - first;
    result.steps = work->step();
    result.scheme = plan.scheme;
    result.ms_per_step = taken > 0 ? 1e3 * seconds_since(start) / static_cast<double>(taken) : 0;
    result.mass_drift = work->mass_drift();
    result.memory_mb = static_cast<double>(work->memory()) / 1e6;
    result.statistics = work->results();
    if (result.signal != 0) {
        session.plan.warn(
            fmt::format("interrupted after {} of {} steps; go on with --resume "
                        "('{}' holds what was done)",
                        result.steps, total, path.string()));
        return result;
    }
    work->finish(writer);
    writer.finish(result.statistics, simulate::identity_of(options.field), session.record());
    session.outputs.push_back(options.output);
    std::error_code ignored;
    fs::remove(path, ignored);
    work->discard();
    return result;
}

}  // namespace grainfield::pipelines
