#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "analysis/analysis.h"
#include "analysis/gather.h"
#include "core/errors.h"
#include "core/support/parallel.h"

namespace grainfield::analysis {
namespace {

constexpr const char* kKind = "analysis of a part 1";

[[noreturn]] void refuse(std::string actual, std::string expected) {
    throw InputError(ErrorText{"parts of an analysis do not fit", std::move(actual),
                               std::move(expected), "measure all parts with the same options"});
}

template <class T>
const std::vector<T>& stored(const std::map<std::string, std::vector<T>>& arrays,
                             const std::string& name, std::size_t count) {
    const auto found = arrays.find(name);
    if (found == arrays.end()) refuse(fmt::format("there is no '{}'", name), "");
    if (found->second.size() != count) {
        refuse(fmt::format("'{}' has {} values", name, found->second.size()),
               fmt::format("{}", count));
    }
    return found->second;
}

bool can_be_saved(const Observable& observable, const AnalysisOptions& options) {
    return observable.can_be_saved &&
           std::ranges::all_of(observable.needs(options),
                               [&](const Observable& need) { return can_be_saved(need, options); });
}

void save(const TrajectoryInfo& info, Checkpoint& checkpoint) {
    checkpoint.integers["info"] = {
        static_cast<std::int64_t>(info.origin), static_cast<std::int64_t>(info.length_unit),
        static_cast<std::int64_t>(info.time_unit), static_cast<std::int64_t>(info.diameter_origin)};
    checkpoint.reals["diameter"] = {info.diameter};
    checkpoint.texts["source"] = {info.source};
    if (info.frame_rate) checkpoint.reals["frame rate"] = {*info.frame_rate};
    if (info.vibration_frequency) {
        checkpoint.reals["vibration frequency"] = {*info.vibration_frequency};
    }
    if (info.control) {
        checkpoint.integers["control"] = {static_cast<std::int64_t>(info.control->parameter)};
        checkpoint.reals["control"] = {info.control->value};
        checkpoint.texts["control"] = {info.control->unit.text()};
    }
}

std::optional<double> known_number(const Checkpoint& checkpoint, const std::string& name) {
    if (!checkpoint.reals.contains(name)) return std::nullopt;
    return stored(checkpoint.reals, name, 1)[0];
}

/// The choice that stands at this place in its enumeration.
template <class Choice>
Choice choice(std::int64_t number, Choice last) {
    if (number < 0 || number > static_cast<std::int64_t>(last)) {
        refuse(fmt::format("a choice has the number {}", number),
               fmt::format("0 … {}", static_cast<std::int64_t>(last)));
    }
    return static_cast<Choice>(number);
}

TrajectoryInfo info_of(const Checkpoint& checkpoint) {
    const auto& numbers = stored(checkpoint.integers, "info", 4);
    TrajectoryInfo info;
    info.origin = choice(numbers[0], Origin::field);
    info.length_unit = choice(numbers[1], LengthUnit::diameter);
    info.time_unit = choice(numbers[2], TimeUnit::sqrt_a_over_g);
    info.diameter_origin = choice(numbers[3], DiameterOrigin::apparent);
    info.diameter = stored(checkpoint.reals, "diameter", 1)[0];
    if (!(info.diameter > 0) || !std::isfinite(info.diameter)) {
        refuse(fmt::format("a diameter of {}", info.diameter), "a length above zero");
    }
    info.source = stored(checkpoint.texts, "source", 1)[0];
    info.frame_rate = known_number(checkpoint, "frame rate");
    info.vibration_frequency = known_number(checkpoint, "vibration frequency");
    if (checkpoint.integers.contains("control")) {
        info.control = ControlValue{choice(stored(checkpoint.integers, "control", 1)[0],
                                           ControlParameter::critical_distance),
                                    stored(checkpoint.reals, "control", 1)[0],
                                    stored(checkpoint.texts, "control", 1)[0]};
    }
    return info;
}

void save(const Box& box, Checkpoint& checkpoint) {
    checkpoint.reals["box"] = {box.origin.x, box.origin.y, box.length.x, box.length.y, box.height};
    checkpoint.integers["box"] = {static_cast<std::int64_t>(box.boundary[0]),
                                  static_cast<std::int64_t>(box.boundary[1])};
}

Box box_of(const Checkpoint& checkpoint) {
    const auto& lengths = stored(checkpoint.reals, "box", 5);
    const auto& sides = stored(checkpoint.integers, "box", 2);
    const Box box{
        .origin = {lengths[0], lengths[1]},
        .length = {lengths[2], lengths[3]},
        .boundary = {choice(sides[0], Boundary::walls), choice(sides[1], Boundary::walls)},
        .height = lengths[4]};
    try {
        require_valid(box);
    } catch (const OptionError& error) {
        refuse(error.what(), "a box");
    }
    return box;
}

Box in_diameters(const Box& box, const TrajectoryInfo& info) {
    Snapshot empty;
    empty.box = box;
    return pattern_of(empty, diameter_of(info)).box;
}

/// A part as it was stored.
struct StoredPart {
    std::vector<Observable> wanted;
    TrajectoryInfo info;
    Box box;
    std::int64_t first = 0, whole = 0, frames = 0;
    double particles = 0;
};

StoredPart read(const Checkpoint& checkpoint, const std::vector<Observable>& known) {
    if (checkpoint.kind != kKind) {
        refuse(fmt::format("a file of kind '{}'", checkpoint.kind), kKind);
    }
    const auto names = checkpoint.texts.find("observables");
    if (names == checkpoint.texts.end()) refuse("it does not say what was measured", "");
    const auto& numbers = stored(checkpoint.integers, "part", 3);
    if (numbers[0] < 0 || numbers[1] < 1 || numbers[2] < 0 || numbers[0] > numbers[1] ||
        numbers[2] > numbers[1] - numbers[0]) {
        refuse(fmt::format("{} snapshots from {} of {}", numbers[2], numbers[0], numbers[1]), "");
    }
    return {.wanted = chosen(names->second, known),
            .info = info_of(checkpoint),
            .box = box_of(checkpoint),
            .first = numbers[0],
            .whole = numbers[1],
            .frames = numbers[2],
            .particles = stored(checkpoint.reals, "particles", 1)[0]};
}

void require_same_run(const StoredPart& part, const StoredPart& first, std::int64_t end) {
    if (part.whole != first.whole || part.first < end) {
        refuse(fmt::format("snapshots from {} of {}", part.first, part.whole),
               fmt::format("from {} or later of {}", end, first.whole));
    }
    const auto words = [](const StoredPart& p) {
        return fmt::format("'{}', box {} x {}, diameter {}", p.info.source, p.box.length.x,
                           p.box.length.y, p.info.diameter);
    };
    if (part.box != first.box || part.info.diameter != first.info.diameter ||
        part.info.frame_rate != first.info.frame_rate || part.info.source != first.info.source) {
        refuse(words(part), words(first));
    }
    if (!std::ranges::equal(part.wanted, first.wanted, {}, &Observable::name, &Observable::name)) {
        refuse("other observables", "the same in all parts");
    }
}

Run restored(const Checkpoint& checkpoint, const StoredPart& part, const AnalysisOptions& options,
             int threads) {
    Run run(part.wanted, {.options = options,
                          .info = part.info,
                          .box = in_diameters(part.box, part.info),
                          .frames = part.frames,
                          .threads = threads,
                          .first = part.first,
                          .whole = part.whole});
    run.restore(checkpoint);
    return run;
}

}  // namespace

Checkpoint measure_part(SnapshotSource& source, const PartOfRun& part,
                        const AnalysisOptions& options, const MeasureSettings& settings,
                        const std::vector<Observable>& known) {
    RunPlan own_plan;
    RunPlan& plan = settings.plan != nullptr ? *settings.plan : own_plan;
    std::vector<Observable> wanted;
    std::string left_out;
    for (const Observable& observable : chosen(options.observables, known)) {
        if (can_be_saved(observable, options)) {
            wanted.push_back(observable);
        } else {
            left_out += (left_out.empty() ? "" : ", ") + observable.name;
        }
    }
    if (wanted.empty()) {
        throw OptionError(ErrorText{"nothing that is asked for can be measured in parts", left_out,
                                    "sk, s4, variance, fit or synthetic",
                                    "link the parts and analyse the film"});
    }
    if (!left_out.empty()) {
        plan.warn(
            fmt::format("left out: {}; they follow particles from frame to frame: link the "
                        "parts and analyse the film",
                        left_out));
    }
    AnalysisOptions taken = options;
    taken.observables.clear();
    for (const Observable& observable : wanted) taken.observables.push_back(observable.name);
    plan_measurement(source, taken, plan, known);
    PartOfRun place = part;
    if (place.whole == 0) place.whole = std::max<std::int64_t>(1, source.count());
    const Gathered gathered = gather(source, wanted, taken, settings, place, plan);
    Checkpoint checkpoint;
    checkpoint.kind = kKind;
    checkpoint.texts["observables"] = taken.observables;
    checkpoint.integers["part"] = {place.first, place.whole, source.count()};
    checkpoint.reals["particles"] = {gathered.particles};
    save(gathered.box, checkpoint);
    save(source.info(), checkpoint);
    gathered.run.save(checkpoint);
    return checkpoint;
}

Results merged(const std::function<std::optional<Checkpoint>()>& next,
               const AnalysisOptions& options, const MeasureSettings& settings,
               const std::vector<Observable>& known) {
    std::optional<Checkpoint> checkpoint = next();
    if (!checkpoint) refuse("there is no part", "one at least");
    const int threads = thread_count(settings.threads);
    const StoredPart first = read(*checkpoint, known);
    Run run = restored(*checkpoint, first, options, threads);
    Results results;
    results.source = first.info;
    results.box = first.box;
    results.frames = first.frames;
    double particles = first.particles;
    for (std::int64_t end = first.first + first.frames; (checkpoint = next());) {
        const StoredPart part = read(*checkpoint, known);
        require_same_run(part, first, end);
        Run later = restored(*checkpoint, part, options, threads);
        run.merge(later);
        end = part.first + part.frames;
        results.frames += part.frames;
        particles += part.particles;
    }
    if (results.frames > 0) {
        results.particles_mean = particles / static_cast<double>(results.frames);
    }
    results.observables = run.results();
    return results;
}

}  // namespace grainfield::analysis
