#include "pipelines/tune/tune_candidates.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "analysis/order/bond_order.h"
#include "io/frame_region.h"
#include "pipelines/page/report_page.h"
#include "pipelines/tune/tune_settings.h"

namespace grainfield::pipelines {

namespace {

using tracking::Polarity;
using tracking::SizeCandidate;

const char* polarity_name(const SizeCandidate& candidate) {
    return candidate.polarity == Polarity::dark ? "dark" : "bright";
}

std::string title_of(const SizeCandidate& candidate) {
    return fmt::format("{} D = {:.1f} px: {:.1f} % explained", polarity_name(candidate),
                       candidate.diameter, 100 * std::max(0.0, candidate.explained.signal));
}

Preview preview_of(const Frame& frame, const SizeCandidate& candidate) {
    Preview preview;
    preview.frame = frame;
    preview.frame.image =
        io::cropped(frame.image, {candidate.x, candidate.y, candidate.width, candidate.height});
    Snapshot& snapshot = preview.snapshot;
    snapshot.frame = frame.index;
    snapshot.time = frame.time;
    snapshot.box = {
        .origin = {-0.5, -0.5},
        .length = {static_cast<double>(candidate.width), static_cast<double>(candidate.height)}};
    const Vec2 corner{static_cast<double>(candidate.x), static_cast<double>(candidate.y)};
    for (const Vec2 p : candidate.position) snapshot.position.push_back(p - corner);
    preview.abs_q4 = analysis::abs_q4(snapshot, candidate.diameter, {});
    return preview;
}

}  // namespace

std::vector<Results> candidate_runs(WatchedFrames& frames, std::int64_t position,
                                    const std::vector<SizeCandidate>& weighed, const Job& job) {
    std::vector<Results> runs;
    if (weighed.empty() || position < 0) return runs;
    const Frame frame = frames.read(position);
    if (frame.status != FrameStatus::ok) return runs;
    for (const std::size_t i : tracking::named_candidates(weighed)) {
        const SizeCandidate& candidate = weighed[i];
        Results run;
        run.source.origin = Origin::video;
        run.source.length_unit = LengthUnit::pixel;
        run.source.diameter = candidate.diameter;
        run.source.diameter_origin = DiameterOrigin::apparent;
        run.source.source = frames.name();
        run.identity = identity_of(run.source);
        run.label = title_of(candidate);
        run.frames = 1;
        run.particles_mean = static_cast<double>(candidate.spheres);
        run.previews.push_back(preview_of(frame, candidate));
        runs.push_back(page_run(std::move(run), job));
    }
    return runs;
}

std::vector<report::CopyBlock> candidate_blocks(const std::vector<SizeCandidate>& weighed,
                                                const tracking::TrackOptions& given,
                                                const FilmOptions& film,
                                                const std::optional<tracking::ImageModel>& taken) {
    std::vector<report::CopyBlock> blocks;
    for (const std::size_t i : tracking::named_candidates(weighed)) {
        if (taken && is_of(weighed[i], *taken)) continue;
        blocks.push_back({title_of(weighed[i]), toml_of(settings_of(given, film, weighed[i])), ""});
    }
    return blocks;
}

std::optional<SizeAdvice> advice_on(const tracking::ImageModel& taken,
                                    const std::vector<SizeCandidate>& weighed) {
    for (const SizeCandidate& candidate : weighed) {
        if (!is_of(candidate, taken)) continue;
        const std::optional<SizeCandidate> better = tracking::better_than(candidate, weighed);
        if (!better) return std::nullopt;
        return SizeAdvice{tracking::advice_on_size(candidate, *better), *better};
    }
    return std::nullopt;
}

bool is_of(const SizeCandidate& candidate, const tracking::ImageModel& model) {
    SizeCandidate taken;
    taken.polarity = model.polarity;
    taken.diameter = model.disc.diameter;
    return tracking::is_same_size(candidate, taken);
}

report::Table candidates_table(const std::vector<SizeCandidate>& weighed) {
    report::Table table;
    table.name = "candidates";
    table.title = "What was weighed";
    table.note =
        "Share of the variance of that part of the frame that the fitted discs explain; charged: "
        "after every fitted coordinate has paid for itself.";
    table.columns = {{"explained", "Explained", "%", true},
                     {"charged", "Charged", "%", true},
                     {"positions", "Positions", "", true}};
    for (const std::size_t i : tracking::named_candidates(weighed)) {
        const SizeCandidate& candidate = weighed[i];
        const double nan = std::numeric_limits<double>::quiet_NaN();
        table.rows.push_back(
            {fmt::format("{} D = {:.1f} px", polarity_name(candidate), candidate.diameter),
             {{nan, fmt::format("{:.1f}", 100 * std::max(0.0, candidate.explained.signal)), false},
              {nan, fmt::format("{:.1f}", 100 * candidate.explained.charged), false},
              {nan, fmt::format("{}", candidate.spheres), false}}});
    }
    return table;
}

}  // namespace grainfield::pipelines
