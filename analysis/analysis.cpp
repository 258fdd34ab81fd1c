#include "analysis/analysis.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "analysis/observable_set.h"
#include "analysis/order/bond_statistics.h"
#include "analysis/order/order_correlation.h"
#include "analysis/order/order_examples.h"
#include "analysis/order/solid_clusters.h"
#include "analysis/spectra/listed_modes.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/parallel.h"

namespace grainfield::analysis {
namespace {

using Clock = std::chrono::steady_clock;

// Adds the time of a stage to `seconds` when it ends.
class Stopwatch {
 public:
    explicit Stopwatch(double& seconds) : seconds_(seconds) {}
    ~Stopwatch() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

 private:
    double& seconds_;
    Clock::time_point start_ = Clock::now();
};

struct Seconds {
    double q4 = 0, phase = 0, msd = 0, sk = 0, s4 = 0, variance = 0, fit = 0;

    Seconds& operator+=(const Seconds& o) {
        q4 += o.q4;
        phase += o.phase;
        msd += o.msd;
        sk += o.sk;
        s4 += o.s4;
        variance += o.variance;
        return *this;
    }
};

// What the threads made of one snapshot.
struct Measured {
    Pattern pattern;
    BondStatistics::Sample bonds;
    OrderCorrelation::Sample order_pairs;
    StructureFactor::Sample modes;
    ListedModes::Sample listed_modes;
    OrderStructureFactor::Sample order_modes;
    NumberVariance::Sample windows;
    Seconds seconds;
};

PhaseHistory::Sample phase_sample(const Pattern& pattern, const BondOrderField& field) {
    PhaseHistory::Sample sample{pattern.frame, pattern.time, pattern.id, {}};
    sample.abs_q.reserve(field.q.size());
    for (const auto& q : field.q)
        sample.abs_q.push_back(static_cast<float>(std::sqrt(std::norm(q))));
    return sample;
}

// The accumulators of one run.
class Run {
 public:
    Run(const AnalysisOptions& options, const TrajectoryInfo& info, const Box& box,
        std::int64_t frames, int threads)
        : options_(options),
          wanted_(ObservableSet::parse(options.observables)),
          bonds_(options.q4) {
        // Phases are classes of |Q4|, whatever symmetry the q4 observable is asked for.
        phase_order_ = options.q4;
        phase_order_.symmetry = 4;
        if (wanted_.phase || wanted_.msd) phase_.emplace(options.phase, info, frames);
        if (wanted_.q4) order_.emplace(box, frames);
        if (wanted_.phase) clusters_.emplace(phase_->follows());
        if (wanted_.phase && phase_->follows()) examples_.emplace(options.phase);
        cluster_stride_ = std::max<std::int64_t>(1, (frames + 63) / 64);
        if (wanted_.msd) msd_.emplace(options.msd, frames, threads);
        if (wanted_.sk || wanted_.fit || wanted_.synthetic) sk_.emplace(options.sk, box, frames);
        if (wanted_.sk && !options.wavevectors.empty()) {
            listed_.emplace(options.wavevectors, box, frames);
        }
        if (wanted_.s4) s4_.emplace(options.s4, box, frames);
        if (wanted_.variance) variance_.emplace(options.variance, box, frames, threads);
    }

    Measured measure(Pattern pattern, std::int64_t ordinal) const {
        Measured m;
        m.pattern = std::move(pattern);
        if (wanted_.q4 || phase_ || s4_) {
            const Stopwatch watch(m.seconds.q4);
            m.bonds = BondStatistics::measure(m.pattern, options_.q4);
            if (order_) m.order_pairs = order_->measure(m.pattern, m.bonds.field, ordinal);
        }
        if (sk_) {
            const Stopwatch watch(m.seconds.sk);
            m.modes = sk_->measure(m.pattern);
            if (listed_) m.listed_modes = listed_->measure(m.pattern);
        }
        if (s4_) {
            const Stopwatch watch(m.seconds.s4);
            m.order_modes = s4_->measure(m.pattern, m.bonds.field.q);
        }
        if (variance_) {
            const Stopwatch watch(m.seconds.variance);
            m.windows = variance_->measure(m.pattern);
        }
        return m;
    }

    void add(Measured m) {
        seconds_ += m.seconds;
        dropped_ += m.pattern.dropped;
        const bool shares_order = options_.q4.symmetry == phase_order_.symmetry;
        BondOrderField of_phase;
        if (phase_) {
            const Stopwatch watch(seconds_.phase);
            if (!shares_order) of_phase = bond_order(m.pattern, phase_order_);
            add_phase(m.pattern, shares_order ? m.bonds.field : of_phase);
        }
        if (order_) {
            const Stopwatch watch(seconds_.q4);
            order_->add(m.order_pairs, m.pattern, m.bonds.field);
        }
        if (wanted_.q4) {
            const Stopwatch watch(seconds_.q4);
            bonds_.add(std::move(m.bonds));
        }
        if (clusters_ && phase_->follows()) {
            const bool is_kept = shares_order && wanted_.q4;
            if (!is_kept) last_.field = std::move(shares_order ? m.bonds.field : of_phase);
            last_.kept = is_kept ? &bonds_.last().field : nullptr;
            last_.id = m.pattern.id;
            last_.time = m.pattern.time;
        }
        if (sk_) {
            const Stopwatch watch(seconds_.sk);
            sk_->add(std::move(m.modes));
            if (listed_) listed_->add(std::move(m.listed_modes));
        }
        if (s4_) {
            const Stopwatch watch(seconds_.s4);
            s4_->add(std::move(m.order_modes));
        }
        if (variance_) {
            const Stopwatch watch(seconds_.variance);
            variance_->add(std::move(m.windows));
        }
        if (msd_) {
            const Stopwatch watch(seconds_.msd);
            msd_->add(std::move(m.pattern));
        }
    }

    std::vector<ObservableResult> results() {
        std::vector<ObservableResult> results;
        const auto push = [&](double seconds, auto&& make) {
            {
                const Stopwatch watch(seconds);
                results.push_back(make());
            }
            results.back().seconds = seconds;
        };
        if (phase_) phase_->close_window();
        if (clusters_ && phase_->follows() && !last_.id.empty()) add_clusters();
        if (examples_) examples_->close_window();
        if (wanted_.q4) {
            push(seconds_.q4, [&] {
                ObservableResult q4 = bonds_.result();
                order_->add_to(q4);
                return q4;
            });
        }
        if (wanted_.phase) {
            push(seconds_.phase, [&] {
                ObservableResult phase = phase_->result();
                clusters_->add_to(phase);
                if (examples_) examples_->add_to(phase);
                return phase;
            });
        }
        if (msd_) {
            push(seconds_.msd,
                 [&] { return msd_->result(phase_ && phase_->follows() ? &*phase_ : nullptr); });
        }
        if (wanted_.sk) {
            push(seconds_.sk, [&] {
                ObservableResult sk = sk_->result();
                if (listed_) listed_->add_to(sk);
                return sk;
            });
        }
        if (s4_) push(seconds_.s4, [&] { return s4_->result(); });
        if (variance_) push(seconds_.variance, [&] { return variance_->result(); });
        if (wanted_.fit || wanted_.synthetic) add_fits(results);
        return results;
    }

    std::int64_t dropped() const { return dropped_; }

 private:
    void add_phase(const Pattern& pattern, const BondOrderField& field) {
        const std::int64_t before = phase_->windows();
        PhaseHistory::Sample sample = phase_sample(pattern, field);
        if (examples_ && examples_->wants_more()) {
            phase_->add(sample);
            if (phase_->windows() > before) examples_->close_window();
            examples_->add(std::move(sample));
        } else {
            phase_->add(std::move(sample));
        }
        if (!clusters_) return;
        if (!phase_->follows()) {
            if (phase_frames_++ % cluster_stride_ != 0) return;
            std::vector<bool> solid;
            for (const auto& q : field.q)
                solid.push_back(std::abs(q) >= options_.phase.solid_above);
            clusters_->add({pattern.id, std::move(solid), &field, pattern.time});
            return;
        }
        if (phase_->windows() > before) add_clusters();
    }

    // The clusters of the window that was closed last, in its last frame.
    void add_clusters() {
        const std::int64_t window = phase_->window_of(last_.time);
        std::vector<bool> solid;
        for (const std::int64_t id : last_.id) {
            std::int64_t first = 0;
            const auto classes = phase_->classes(id, first);
            const std::int64_t at = window - first;
            solid.push_back(at >= 0 && at < static_cast<std::int64_t>(classes.size()) &&
                            classes[static_cast<std::size_t>(at)] == Phase::solid);
        }
        const BondOrderField* field = last_.kept != nullptr ? last_.kept : &last_.field;
        clusters_->add({std::move(last_.id), std::move(solid), field, last_.time});
        last_ = {};
    }

    // What is made of S(k): its fit, and the number variance of other boxes.
    void add_fits(std::vector<ObservableResult>& results) {
        ObservableResult fit;
        {
            const Stopwatch watch(seconds_.fit);
            fit = fit_result(*sk_, options_.fit);
        }
        fit.seconds = seconds_.fit;
        if (wanted_.synthetic) {
            double seconds = 0;
            ObservableResult synthetic;
            {
                const Stopwatch watch(seconds);
                synthetic = synthetic_result(synthetic_input(*sk_, fit), options_.synthetic);
            }
            synthetic.seconds = seconds;
            if (wanted_.fit) results.push_back(std::move(fit));
            results.push_back(std::move(synthetic));
            return;
        }
        results.push_back(std::move(fit));
    }

    const AnalysisOptions& options_;
    ObservableSet wanted_;
    BondOrderOptions phase_order_;
    BondStatistics bonds_;
    std::optional<OrderCorrelation> order_;
    std::optional<PhaseHistory> phase_;
    std::optional<SolidClusters> clusters_;
    std::optional<OrderExamples> examples_;
    struct LastFrame {  // of the open window
        std::vector<std::int64_t> id;
        const BondOrderField* kept = nullptr;  // by bonds_; else it is here
        BondOrderField field;
        double time = 0;
    };
    LastFrame last_;
    std::int64_t phase_frames_ = 0;
    std::int64_t cluster_stride_ = 1;
    std::optional<Displacement> msd_;
    std::optional<StructureFactor> sk_;
    std::optional<ListedModes> listed_;
    std::optional<OrderStructureFactor> s4_;
    std::optional<NumberVariance> variance_;
    Seconds seconds_;
    std::int64_t dropped_ = 0;
};

// A region that particles fill only partly makes S(k) and the number variance those of the
// region's shape.
void warn_if_unfilled(const Pattern& pattern, RunPlan& plan) {
    if (pattern.size() < 100) return;
    Vec2 low = pattern.position.front();
    Vec2 high = low;
    for (const Vec2& p : pattern.position) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const Vec2 filled{(high.x - low.x) / pattern.box.length.x,
                      (high.y - low.y) / pattern.box.length.y};
    if (filled.x > 0.93 && filled.y > 0.93) return;
    plan.warn(fmt::format(
        "particles fill {:.0f} % x {:.0f} % of the box: S(k), its wavevectors and the number "
        "variance refer to the whole box",
        100 * filled.x, 100 * filled.y));
}

}  // namespace

std::vector<OptionTable> describe(AnalysisOptions& options) {
    OptionTable table("analysis");
    table.text("observables", options.observables,
               "comma list of q4, phase, msd, sk, s4, variance, fit, synthetic; or all");
    return {table,
            describe(options.q4),
            describe(options.phase),
            describe(options.msd),
            describe(options.sk),
            describe(options.s4),
            describe(options.variance),
            describe(options.fit),
            describe(options.synthetic)};
}

void plan_analysis(SnapshotSource& source, const AnalysisOptions& options, RunPlan& plan) {
    const ObservableSet wanted = ObservableSet::parse(options.observables);
    const std::int64_t frames = source.count();
    if (frames == 0) {
        plan.skip("all observables", "no frames", "");
        return;
    }
    // The first frames may be empty: they say nothing about the particles.
    Pattern first = pattern_of(source.read(0), diameter_of(source.info()));
    for (std::int64_t i = 1; i < frames && first.size() == 0; ++i) {
        throw_if_interrupted("planning the analysis");
        first = pattern_of(source.read(i), diameter_of(source.info()));
    }
    if (first.size() == 0) plan.warn("no frame has a particle");
    warn_if_unfilled(first, plan);
    const bool linked = !first.id.empty();
    if (wanted.q4) {
        plan.run("q4",
                 fmt::format("|Q{}| of every particle, neighbours by {}", options.q4.symmetry,
                             needs_triangulation(options.q4.rule) ? "triangulation" : "distance"));
    }
    if (wanted.phase) {
        const PhaseWindow window = PhaseWindow::of(options.phase, source.info());
        std::string why = frames == 1 ? "one frame" : !linked ? "not linked" : window.reason;
        const double rate = source.info().frame_rate.value_or(0);
        if (why.empty() && *window.length * rate > 0 && *window.length * rate < 1 - 1e-9) {
            why = fmt::format("the averaging time {:.4g} is shorter than the frame interval {:.4g}",
                              *window.length, 1 / rate);
        }
        plan.run("phase", why.empty() ? fmt::format("average over {:.4g}", *window.length)
                                      : "every frame alone: " + why);
    }
    if (wanted.msd) {
        if (frames < 2 || !linked) {
            plan.skip("msd", frames < 2 ? "one frame" : "particles are not linked",
                      "16 B a particle and frame");
        } else {
            plan.run("msd", "displacements over pairs of frames");
        }
    }
    if (wanted.sk) {
        const char* estimators = first.box.is_periodic() ? "periodic box: raw estimator"
                                 : frames < 2            ? "one frame: raw estimator"
                                                         : "walls: connected and cosine estimators";
        const StructureFactor sk(options.sk, first.box, frames);
        plan.run("sk", fmt::format("{}; {}", estimators, sk.method(first.size())));
        if (!options.wavevectors.empty()) {
            plan.run("sk list", fmt::format("{} listed wavevectors by direct sums",
                                            options.wavevectors.size()));
        }
    }
    if (wanted.s4) {
        plan.run("s4", fmt::format("structure factor of Q{}, two weighted sums over the particles",
                                   options.q4.symmetry));
    }
    if (wanted.variance) {
        plan.run("variance", frames < 2 ? "one frame: over positions" : "temporal, per position");
    }
    if (wanted.synthetic) {
        plan.run("synthetic", "number variance of other boxes from S(k), where it has a fit");
    }
    if (wanted.fit) {
        if (frames < 2 && !first.box.is_periodic()) {
            plan.skip("fit", "one frame: S(k) has the walls in it", "");
        } else {
            plan.run("fit", "S0 + S1 (ka)^alpha below the pre-peak, if there is one");
        }
    }
}

std::vector<ObservableResult> analyze(SnapshotSource& source, const AnalysisOptions& options,
                                      int threads, RunPlan& plan, Progress& progress) {
    plan_analysis(source, options, plan);
    const std::int64_t frames = source.count();
    const double diameter = diameter_of(source.info());
    const int workers = thread_count(threads);
    Box box{{0, 0}, {1, 1}, {Boundary::walls, Boundary::walls}, 0};
    std::size_t particles = 0;
    if (frames > 0) {
        const Pattern first = pattern_of(source.read(0), diameter);
        box = first.box;
        particles = first.size();
    }
    Run run(options, source.info(), box, frames, workers);

    // While a batch is measured, the one before is added and the next one is read. Long batches
    // keep all threads busy, as long as they are small.
    constexpr std::int64_t most_particles = 200000;  // of a thread
    const std::int64_t each =
        most_particles / std::max<std::int64_t>(1, static_cast<std::int64_t>(particles));
    const std::int64_t batch = std::clamp<std::int64_t>(each, 4, 16) * workers;
    const auto read = [&](std::int64_t first) {
        std::vector<Pattern> patterns;
        for (std::int64_t i = first; i < std::min(first + batch, frames); ++i) {
            patterns.push_back(pattern_of(source.read(i), diameter));
        }
        return patterns;
    };
    std::vector<Pattern> next = read(0);
    std::vector<Measured> before;
    const auto add_before = [&] {
        for (Measured& m : before) run.add(std::move(m));
        progress.advance(static_cast<std::int64_t>(before.size()));
    };
    for (std::int64_t first = 0; first < frames; first += batch) {
        throw_if_interrupted("analysis");
        std::vector<Pattern> patterns = std::exchange(next, {});
        const auto count = static_cast<std::int64_t>(patterns.size());
        std::vector<Measured> measured(patterns.size());
        parallel_for(count + 2, workers, [&](std::int64_t task) {
            if (task == 0) return add_before();
            if (task == 1) {
                next = read(first + batch);
                return;
            }
            const auto at = static_cast<std::size_t>(task - 2);
            measured[at] = run.measure(std::move(patterns[at]), first + task - 2);
        });
        before = std::move(measured);
    }
    add_before();
    if (run.dropped() > 0) {
        plan.warn(fmt::format("{} positions that are not finite were left out", run.dropped()));
    }
    return run.results();
}

}  // namespace grainfield::analysis
