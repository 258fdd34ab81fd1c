#include "pipelines/validate/validation_scores.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "analysis/geometry/neighbours.h"
#include "analysis/order/bond_order.h"
#include "tracking/score/position_bounds.h"

namespace grainfield::pipelines {

namespace {

std::uint64_t bit(TruthClass c) {
    return std::uint64_t{1} << static_cast<unsigned>(c);
}

/// Distance of a point to the nearest edge of the outermost pixel centres; negative outside.
double inside_by(Vec2 p, const ScoredView& view) {
    return std::min({p.x, p.y, view.width - 1 - p.x, view.height - 1 - p.y});
}

/// Distance of every particle to the nearest other one [px]; infinite if there is none.
std::vector<double> nearest_distances(const Snapshot& snapshot) {
    std::vector<double> nearest(snapshot.size(), HUGE_VAL);
    if (snapshot.size() < 2) return nearest;
    Box box = snapshot.box;
    box.boundary = {Boundary::walls, Boundary::walls};
    const analysis::CellList cells(snapshot.position, box);
    analysis::NeighbourList list;
    for (const int i : cells.order()) {
        const auto reach = cells.near(i, 1, 0, list);
        if (reach.count > 0) nearest[static_cast<std::size_t>(i)] = reach.nearest;
    }
    return nearest;
}

std::uint64_t distance_bin(double distance) {
    const double bin = std::floor((distance - kLeastDistance) / kDistanceStep);
    if (bin < 0 || bin >= static_cast<double>(kDistanceBins)) return 0;
    return std::uint64_t{1} << (kTruthClasses + static_cast<std::size_t>(bin));
}

Box around(const std::vector<Vec2>& points, const ScoredView& view) {
    Vec2 low{-0.5, -0.5};
    Vec2 high{view.width - 0.5, view.height - 0.5};
    for (const Vec2 p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    return {low, high - low, {Boundary::walls, Boundary::walls}, 0};
}

}  // namespace

std::vector<std::string> truth_class_names() {
    std::vector<std::string> names{"all", "isolated", "liquid", "crystal",
                                   "top", "bottom",   "border"};
    for (std::size_t b = 0; b < kDistanceBins; ++b) {
        const double low = kLeastDistance + static_cast<double>(b) * kDistanceStep;
        names.push_back(fmt::format("nearest {:.2f}-{:.2f} a", low, low + kDistanceStep));
    }
    return names;
}

tracking::TruthFrame classify_truth(const Snapshot& truth, const ScoredView& view,
                                    const std::vector<double>& abs_q4) {
    tracking::TruthFrame frame{truth.position, {}, {}};
    const std::vector<double> nearest = nearest_distances(truth);
    const double diameter = view.disc.diameter;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const double inside = inside_by(truth.position[i], view);
        if (inside < diameter) {
            frame.classes.push_back(inside < diameter / 4 ? 0 : bit(TruthClass::border));
            continue;
        }
        std::uint64_t classes = bit(TruthClass::all);
        if (nearest[i] > diameter + 4 * view.disc.edge_width) classes |= bit(TruthClass::isolated);
        classes |=
            bit(abs_q4[i] >= analysis::solid_order ? TruthClass::crystal : TruthClass::liquid);
        if (!truth.layer.empty()) {
            if (truth.layer[i] == Layer::top) classes |= bit(TruthClass::top);
            if (truth.layer[i] == Layer::bottom) classes |= bit(TruthClass::bottom);
        }
        frame.classes.push_back(classes | distance_bin(nearest[i] / view.sphere_diameter));
    }
    if (view.noise > 0 && view.disc.diameter > 0) {
        frame.bound = tracking::position_bounds(truth.position, view.disc, view.width, view.height,
                                                view.noise, view.threads);
    }
    return frame;
}

ValidationScores::ValidationScores(const ScoredView& view)
    : view_(view),
      detection_(truth_class_names(), 0.25 * view.disc.diameter),
      continuity_(view.span.x > 0 ? view.span : Vec2{view.width + 0.0, view.height + 0.0},
                  simulate::Absence::ends) {}

void ValidationScores::add(const Snapshot& truth, const Snapshot& found) {
    // Neighbours beyond the frame belong to the order of a particle near its edge.
    Snapshot whole;
    whole.position = truth.position;
    whole.box = around(truth.position, view_);
    const std::vector<double> true_q4 = analysis::abs_q4(whole, view_.sphere_diameter, {});
    whole.layer = truth.layer;
    const tracking::TruthFrame frame = classify_truth(whole, view_, true_q4);
    const tracking::FrameMatch match = detection_.add(frame, found.position, found.position_error);
    layers_.add(truth.position, truth.layer, found.layer, match.partner,
                view_.contact * view_.sphere_diameter);
    add_q4(found, true_q4, frame.classes, match.partner);
    add_tracks(truth, found, frame.classes, match);
}

void ValidationScores::add_q4(const Snapshot& found, const std::vector<double>& true_q4,
                              const std::vector<std::uint64_t>& classes,
                              const std::vector<int>& partner) {
    if (found.size() == 0) return;
    const std::vector<double> found_q4 = analysis::abs_q4(found, view_.sphere_diameter, {});
    for (std::size_t i = 0; i < partner.size(); ++i) {
        if (partner[i] < 0 || (classes[i] & bit(TruthClass::all)) == 0) continue;
        const double error = found_q4[static_cast<std::size_t>(partner[i])] - true_q4[i];
        if (!std::isfinite(error)) continue;
        q4_sum_ += error;
        q4_squares_ += error * error;
        ++q4_count_;
    }
}

void ValidationScores::add_tracks(const Snapshot& truth, const Snapshot& found,
                                  const std::vector<std::uint64_t>& classes,
                                  const tracking::FrameMatch& match) {
    // Who is in view goes on, also where he does not count.
    std::vector<std::int64_t> id;
    std::vector<Vec2> position;
    std::vector<char> counts;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (classes[i] == 0) continue;
        id.push_back(truth.id[i]);
        position.push_back(truth.position[i]);
        counts.push_back((classes[i] & bit(TruthClass::all)) != 0);
    }
    const std::vector<simulate::Sighting> sightings = continuity_.follow(id, position);
    tracking::IdentifiedFrame true_frame, found_frame;
    for (std::size_t i = 0; i < id.size(); ++i) {
        std::int64_t& track = track_[id[i]];
        if (sightings[i] != simulate::Sighting::same) track = tracks_begun_++;
        if (!counts[i]) continue;
        true_frame.id.push_back(track);
        true_frame.position.push_back(position[i]);
    }
    for (std::size_t j = 0; j < found.id.size(); ++j) {
        if ((match.classes[j] & bit(TruthClass::all)) == 0) continue;
        found_frame.id.push_back(found.id[j]);
        found_frame.position.push_back(found.position[j]);
    }
    true_tracks_.push_back(std::move(true_frame));
    found_tracks_.push_back(std::move(found_frame));
}

tracking::TrackScores ValidationScores::tracks() const {
    return tracking::score_tracks(found_tracks_, true_tracks_, detection_.gate());
}

double ValidationScores::q4_rms() const {
    return std::sqrt(q4_squares_ / static_cast<double>(q4_count_));
}

double ValidationScores::q4_bias() const {
    return q4_sum_ / static_cast<double>(q4_count_);
}

double recall_by_chance(const ValidationScores& scores) {
    const tracking::ClassScore& all = scores.detection().find("all");
    const ScoredView& view = scores.view();
    const double area = static_cast<double>(view.width) * view.height *
                        static_cast<double>(std::max<std::int64_t>(1, scores.detection().frames()));
    const double gate = scores.detection().gate();
    const double density = static_cast<double>(all.matched + all.spurious) / area;
    return 1 - std::exp(-density * std::numbers::pi * gate * gate);
}

void warn_of_other_truth(const ValidationScores& scores, RunPlan& plan) {
    constexpr double half = 0.5;
    const tracking::ClassScore& all = scores.detection().find("all");
    const auto found = static_cast<double>(all.matched + all.spurious);
    const auto there = static_cast<double>(all.matched + all.missed);
    if (!(there > 0) || !(all.recall() < half) || found < half * there) return;
    plan.warn(WarningCode::other_truth,
              fmt::format("{:.0f} % of the true places have a sphere within {:.1f} px, and places "
                          "at random would have {:.0f} %, though {:.0f} spheres were found where "
                          "{:.0f} are: is this the truth of these frames, in their pixels, with "
                          "the centre of the first pixel at 0?",
                          100 * all.recall(), scores.detection().gate(),
                          100 * recall_by_chance(scores), found, there));
}

}  // namespace grainfield::pipelines
