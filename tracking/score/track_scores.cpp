#include "tracking/score/track_scores.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <unordered_map>

#include "tracking/link/assignment.h"
#include "tracking/point_grid.h"
#include "tracking/score/match_positions.h"
#include "tracking/score/share.h"

namespace grainfield::tracking {
namespace {

/// Tracks by number 0, 1, … in the order of their first appearance, with their lengths.
struct Numbering {
    explicit Numbering(const std::vector<IdentifiedFrame>& frames) {
        for (const IdentifiedFrame& f : frames) {
            std::vector<std::uint32_t> numbers;
            for (const std::int64_t id : f.id) {
                const auto [at, is_new] =
                    of_id.emplace(id, static_cast<std::uint32_t>(length.size()));
                if (is_new) length.push_back(0);
                ++length[at->second];
                numbers.push_back(at->second);
            }
            number.push_back(std::move(numbers));
        }
    }
    double points() const {
        double sum = 0;
        for (const double n : length) sum += n;
        return sum;
    }

    std::unordered_map<std::int64_t, std::uint32_t> of_id;
    std::vector<std::vector<std::uint32_t>> number;  ///< per frame and particle
    std::vector<double> length;
};

/// What two tracks have in common.
struct Shared {
    double saved = 0;  ///< Σ (ε − distance) over frames in which they are nearer than ε
    double close = 0;  ///< number of those frames
    double both = 0;   ///< frames in which both exist
};
using SharedOf = std::map<std::pair<std::uint32_t, std::uint32_t>, Shared>;

SharedOf shared_tracks(const std::vector<IdentifiedFrame>& found, const Numbering& found_numbers,
                       const std::vector<IdentifiedFrame>& truth, const Numbering& true_numbers,
                       double epsilon) {
    SharedOf shared;
    const std::size_t frames = std::min(found.size(), truth.size());
    for (std::size_t f = 0; f < frames; ++f) {
        const PointGrid grid(found[f].position, epsilon);
        for (std::size_t i = 0; i < truth[f].position.size(); ++i) {
            grid.around(truth[f].position[i], [&](std::uint32_t j, Vec2 p) {
                const double d = norm(p - truth[f].position[i]);
                if (d >= epsilon) return;
                Shared& s = shared[{true_numbers.number[f][i], found_numbers.number[f][j]}];
                s.saved += epsilon - d;
                ++s.close;
            });
        }
    }
    std::vector<std::vector<std::pair<std::uint32_t, Shared*>>> of_true(true_numbers.length.size());
    for (auto& [pair, s] : shared) of_true[pair.first].push_back({pair.second, &s});
    std::vector<char> present(found_numbers.length.size(), 0);
    for (std::size_t f = 0; f < frames; ++f) {
        for (const std::uint32_t y : found_numbers.number[f]) present[y] = 1;
        for (const std::uint32_t x : true_numbers.number[f]) {
            for (auto& [y, s] : of_true[x]) s->both += present[y];
        }
        for (const std::uint32_t y : found_numbers.number[f]) present[y] = 0;
    }
    return shared;
}

void count_identities(const std::vector<IdentifiedFrame>& found, const Numbering& found_numbers,
                      const std::vector<IdentifiedFrame>& truth, const Numbering& true_numbers,
                      double epsilon, TrackScores& scores) {
    constexpr std::int64_t kNever = -1;
    std::vector<std::int64_t> identity(true_numbers.length.size(), kNever);
    std::vector<char> lost(true_numbers.length.size(), 0);
    std::vector<std::int64_t> owner(found_numbers.length.size(), kNever);
    for (std::size_t f = 0; f < truth.size(); ++f) {
        const auto& positions = f < found.size() ? found[f].position : std::vector<Vec2>();
        const std::vector<int> partner = match_positions(positions, truth[f].position, epsilon);
        for (std::size_t i = 0; i < truth[f].position.size(); ++i) {
            const std::uint32_t x = true_numbers.number[f][i];
            if (partner[i] < 0) {
                lost[x] = identity[x] != kNever;
                continue;
            }
            const std::int64_t now = found_numbers.number[f][static_cast<std::size_t>(partner[i])];
            if (identity[x] != kNever) {
                ++scores.links;
                scores.switches += identity[x] != now;
                scores.fragments += lost[x];
            }
            std::int64_t& last = owner[static_cast<std::size_t>(now)];
            scores.wrong_links += last != kNever && last != x;
            last = x;
            identity[x] = now;
            lost[x] = 0;
        }
    }
}

}  // namespace

double TrackScores::correct_link_fraction() const {
    return share(links - switches, links);
}

TrackScores score_tracks(const std::vector<IdentifiedFrame>& found,
                         const std::vector<IdentifiedFrame>& truth, double epsilon) {
    const Numbering y(found);
    const Numbering x(truth);
    const SharedOf shared = shared_tracks(found, y, truth, x, epsilon);

    std::vector<AssignmentPair> pairs;
    for (const auto& [pair, s] : shared) {
        const double frames_of_either = x.length[pair.first] + y.length[pair.second] - s.both;
        pairs.push_back({pair.first, pair.second, epsilon * frames_of_either - s.saved});
    }
    std::vector<double> alone;
    for (const double n : x.length) alone.push_back(epsilon * n);
    AssignmentSolver solver;
    const auto& partner = solver.solve(static_cast<std::uint32_t>(x.length.size()),
                                       static_cast<std::uint32_t>(y.length.size()), pairs, alone);

    double distance = 0;
    double close = 0;
    double paired = 0;
    double paired_points = 0;
    for (std::uint32_t i = 0; i < partner.size(); ++i) {
        if (partner[i] < 0) {
            distance += alone[i];
            continue;
        }
        const auto j = static_cast<std::uint32_t>(partner[i]);
        const Shared& s = shared.at({i, j});
        distance += epsilon * (x.length[i] + y.length[j] - s.both) - s.saved;
        close += s.close;
        ++paired;
        paired_points += y.length[j];
    }
    const double nothing = epsilon * x.points();
    const double spurious = epsilon * (y.points() - paired_points);
    TrackScores scores;
    scores.alpha = share(nothing - distance, nothing);
    scores.beta = share(nothing - distance, nothing + spurious);
    scores.jaccard_points = share(close, x.points() + y.points() - close);
    scores.jaccard_tracks =
        share(paired, static_cast<double>(x.length.size() + y.length.size()) - paired);
    count_identities(found, y, truth, x, epsilon, scores);
    return scores;
}

}  // namespace grainfield::tracking
