#include "tracking/synthesis/arrangement_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include "core/image_part.h"
#include "core/support/parallel.h"

namespace grainfield::tracking {
namespace {

constexpr double kWindow = 1.6;     // [a] half side of the square that is judged
constexpr double kFree = 1.35;      // [a] spheres nearer than this are fitted again
constexpr double kSeen = 4.0;       // [a] spheres farther away do not matter
constexpr double kApart = 3.6;      // [a] places of one round
constexpr double kSpotBlur = 0.13;  // [a]
constexpr double kSpotRange = 1.1;  // [a]
constexpr std::size_t kSpots = 3;
constexpr std::size_t kNearest = 4;    // spheres that are lifted, moved or left out
constexpr float kOtherHeight = 0.3F;   // [a]
constexpr double kOverlap = 0.9;       // [a²] nearer in the picture: one lies above the other
constexpr float kHalfSplit = 0.3F;     // [a]
constexpr float kFarSplit = 0.45F;     // [a]
constexpr double kUnusual = 2.5;       // medians
constexpr double kOverlapPrice = 400;  // [contrast²/a²]
constexpr double kUsualMisfits = 6;    // a change must gain this many times the usual misfit m² A

constexpr int kRoughly = 2;             // rounds of a trial
constexpr double kFewRays = 12;         // … along a diameter
constexpr int kWell = 3;                // rounds of the best trials, with all rays
constexpr double kLongTrialStep = 0.2;  // [a]
constexpr std::size_t kFitted = 12;
constexpr std::size_t kFinalists = 2;

struct Candidate {
    std::vector<Point3> spheres;  ///< in the window's coordinates, those fitted first
    int added = 0;                ///< −1, 0, 1
};

/// The surroundings of one place, cut out.
struct Window {
    Image brightness, ceiling;
    Point3 origin;                     ///< of its coordinates [a]
    std::vector<std::int32_t> member;  ///< numbers of the spheres, those fitted first
    std::size_t free = 0;
    std::vector<Point3> spheres;
    MirrorOptics optics;
    FrameLight light;
    Image residual;
};

double squared_in_plane(const Point3& a, const Point3& b) {
    const auto x = static_cast<double>(a.x - b.x);
    const auto y = static_cast<double>(a.y - b.y);
    return x * x + y * y;
}

Window cut_out(const Image& brightness, const Image& ceiling, const SynthesisFit& fit, double scale,
               Point3 place) {
    Window w;
    const int half = static_cast<int>(std::ceil((kWindow + 3 * fit.optics().blur) * scale));
    const int column = static_cast<int>(std::lround(static_cast<double>(place.x) * scale));
    const int row = static_cast<int>(std::lround(static_cast<double>(place.y) * scale));
    const int x0 = std::clamp(column - half, 0, brightness.width() - 1);
    const int y0 = std::clamp(row - half, 0, brightness.height() - 1);
    const int x1 = std::clamp(column + half + 1, x0 + 1, brightness.width());
    const int y1 = std::clamp(row + half + 1, y0 + 1, brightness.height());
    w.brightness = part_of(brightness, x0, y0, x1 - x0, y1 - y0);
    w.ceiling = part_of(ceiling, x0, y0, x1 - x0, y1 - y0);
    w.residual = part_of(fit.residual(), x0, y0, x1 - x0, y1 - y0);
    w.origin = {static_cast<float>(x0 / scale), static_cast<float>(y0 / scale), 0};
    w.optics = fit.optics();
    w.optics.middle_x -= static_cast<double>(w.origin.x);
    w.optics.middle_y -= static_cast<double>(w.origin.y);
    w.light = fit.light();
    w.light.gain += w.light.fall * from_middle(brightness, column, row);
    w.light.fall = 0;
    for (const bool wants_free : {true, false}) {
        for (std::size_t i = 0; i < fit.spheres().size(); ++i) {
            const Point3& p = fit.spheres()[i];
            const double squared = squared_in_plane(p, place);
            if (squared > kSeen * kSeen || (squared < kFree * kFree) != wants_free) continue;
            w.member.push_back(static_cast<std::int32_t>(i));
            w.spheres.push_back({p.x - w.origin.x, p.y - w.origin.y, p.z});
        }
        if (wants_free) w.free = w.spheres.size();
    }
    return w;
}

/// Heights as the overlaps in the picture demand: of two discs nearer than kOverlap one is high and
/// one low. Begins at the first sphere; of groups that do not overlap each keeps the sense nearer
/// to its present heights. One that has high and low neighbours alike lies in the middle.
void lay_in_turns(std::vector<Point3>& spheres, std::size_t free, float low, float high) {
    const float middle = 0.5F * (low + high);
    std::vector<int> side(free, 0);
    for (std::size_t first = 0; first < free; ++first) {
        if (side[first] != 0) continue;
        std::vector<std::size_t> group{first};
        side[first] = spheres[first].z > middle ? 1 : -1;
        for (std::size_t k = 0; k < group.size(); ++k) {
            const std::size_t i = group[k];
            for (std::size_t j = 0; j < free; ++j) {
                if (side[j] != 0 || squared_in_plane(spheres[i], spheres[j]) > kOverlap) continue;
                side[j] = -side[i];
                group.push_back(j);
            }
        }
        double agrees = 0;
        for (const std::size_t i : group) {
            agrees += side[i] * static_cast<double>(spheres[i].z - middle);
        }
        if (agrees < 0) {
            for (const std::size_t i : group) side[i] = -side[i];
        }
    }
    for (std::size_t i = 0; i < free; ++i) {
        const bool is_between =
            std::any_of(spheres.begin(), spheres.begin() + static_cast<std::ptrdiff_t>(free),
                        [&](const Point3& other) {
                            const auto j = static_cast<std::size_t>(&other - spheres.data());
                            return j != i && side[j] == side[i] &&
                                   squared_in_plane(spheres[i], other) < kOverlap;
                        });
        spheres[i].z = is_between ? middle : side[i] > 0 ? high : low;
    }
}

/// Where image is darkest beside the rendering, within kSpotRange of the place: at most kSpots
/// local minima of the smoothed residual, darkest first.
std::vector<Point3> dark_spots(const Window& w, double scale, Point3 place) {
    const Image smooth = gaussian_blurred(w.residual, kSpotBlur * scale, 1);
    std::vector<std::pair<float, Point3>> found;
    for (int y = 1; y + 1 < smooth.height(); ++y) {
        for (int x = 1; x + 1 < smooth.width(); ++x) {
            const float value = smooth(x, y);
            if (value >= 0) continue;
            const Point3 p{static_cast<float>(x / scale), static_cast<float>(y / scale), 0};
            if (squared_in_plane(p, place) > kSpotRange * kSpotRange) continue;
            bool is_least = true;
            for (int v = -1; v <= 1; ++v) {
                for (int u = -1; u <= 1; ++u) is_least = is_least && value <= smooth(x + u, y + v);
            }
            if (is_least) found.emplace_back(value, p);
        }
    }
    std::sort(found.begin(), found.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Point3> spots;
    for (const auto& [value, p] : found) {
        if (spots.size() == kSpots) break;
        spots.push_back(p);
    }
    return spots;
}

/// A point `far` from a towards b, or b if that is nearer.
Point3 towards(const Point3& a, const Point3& b, float far, float z) {
    const auto length = static_cast<float>(std::sqrt(squared_in_plane(a, b)));
    const float share = length > far ? far / length : 1.0F;
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), z};
}

/// Other arrangements, the likelier first. `discs`: the start, in the window's coordinates.
std::vector<Candidate> candidates(const Window& w, const std::vector<Point3>& discs, double scale,
                                  Point3 place, double top) {
    std::vector<Candidate> all;
    const auto low = static_cast<float>(0.05 * top);
    const auto high = static_cast<float>(0.95 * top);
    const std::pair<float, float> both[] = {{low, high}, {high, low}};
    const std::vector<Point3> spots = dark_spots(w, scale, place);
    const std::vector<Point3>& present = w.spheres;
    std::vector<std::size_t> near(w.free);
    std::iota(near.begin(), near.end(), std::size_t{0});
    std::sort(near.begin(), near.end(), [&](std::size_t a, std::size_t b) {
        return squared_in_plane(present[a], place) < squared_in_plane(present[b], place);
    });
    if (near.size() > kNearest) near.resize(kNearest);
    const auto put = [&](std::vector<Point3> spheres, int added) {
        all.push_back({std::move(spheres), added});
    };
    const auto with = [&](std::size_t i, Point3 p) {
        std::vector<Point3> spheres = present;
        spheres[i] = p;
        return spheres;
    };
    const auto and_one = [](std::vector<Point3> spheres, Point3 p) {
        spheres.insert(spheres.begin(), p);
        return spheres;
    };
    // Heights by the overlaps, from the discs of the start and from the spheres of now.
    for (const bool from_discs : {true, false}) {
        std::vector<Point3> spheres = present;
        if (from_discs) {
            spheres.erase(spheres.begin(), spheres.begin() + static_cast<std::ptrdiff_t>(w.free));
            spheres.insert(spheres.begin(), discs.begin(), discs.end());
        }
        const std::size_t free = from_discs ? discs.size() : w.free;
        const int added = static_cast<int>(free) - static_cast<int>(w.free);
        lay_in_turns(spheres, free, low, high);
        put(spheres, added);
        for (std::size_t i = 0; i < free; ++i) spheres[i].z = low + high - spheres[i].z;
        put(std::move(spheres), added);
    }
    // One at another height; two that overlap change places.
    for (const std::size_t i : near) {
        for (const float z : {low, high}) {
            if (std::abs(present[i].z - z) < kOtherHeight) continue;
            put(with(i, {present[i].x, present[i].y, z}), 0);
        }
    }
    for (std::size_t k = 0; k < near.size(); ++k) {
        for (std::size_t l = k + 1; l < near.size(); ++l) {
            if (squared_in_plane(present[near[k]], present[near[l]]) > 1) continue;
            std::vector<Point3> spheres = present;
            std::swap(spheres[near[k]].z, spheres[near[l]].z);
            if (std::abs(spheres[near[k]].z - spheres[near[l]].z) > kOtherHeight) {
                put(std::move(spheres), 0);
            }
        }
    }
    // One more; one that stands for two; one elsewhere.
    for (const Point3& spot : spots) {
        for (const float z : {low, high}) put(and_one(present, {spot.x, spot.y, z}), 1);
    }
    for (std::size_t k = 0; k < std::min<std::size_t>(2, near.size()); ++k) {
        const Point3 one = present[near[k]];
        for (std::size_t a = 0; a < spots.size(); ++a) {
            for (const auto& [here, there] : both) {
                const Point3 opposite{2 * one.x - spots[a].x, 2 * one.y - spots[a].y, 0};
                put(and_one(with(near[k], towards(one, opposite, kHalfSplit, here)),
                            towards(one, spots[a], kHalfSplit, there)),
                    1);
                for (std::size_t b = a + 1; b < spots.size(); ++b) {
                    put(and_one(with(near[k], towards(one, spots[a], kFarSplit, here)),
                                towards(one, spots[b], kFarSplit, there)),
                        1);
                }
                put(with(near[k], {spots[a].x, spots[a].y, here}), 0);
            }
        }
    }
    // One less.
    for (const std::size_t i : near) {
        std::vector<Point3> spheres = present;
        spheres.erase(spheres.begin() + static_cast<std::ptrdiff_t>(i));
        put(std::move(spheres), -1);
    }
    return all;
}

struct Outcome {
    double misfit = 0;
    std::vector<Point3> spheres;
};

double price(const SynthesisFit& fit) {
    return fit.misfit() + kOverlapPrice * fit.overlap();
}

/// The spheres of a window as they are; those beyond the first `free` are fixed.
SynthesisFit fit_of(const Window& w, double scale, const std::vector<Point3>& spheres,
                    std::size_t free, double rays) {
    SynthesisFit fit(w.brightness, w.ceiling, scale, 1, rays);
    std::vector<char> is_fixed(spheres.size(), 1);
    std::fill_n(is_fixed.begin(), free, 0);
    fit.start(spheres, w.optics, std::move(is_fixed), w.light);
    return fit;
}

Outcome fitted(const Window& w, double scale, const std::vector<Point3>& spheres, std::size_t free,
               const SynthesisLimits& limits, int rounds, double rays) {
    SynthesisFit fit = fit_of(w, scale, spheres, free, rays);
    SynthesisLimits few = limits;
    few.most_rounds = rounds;
    few.longest_step = kLongTrialStep;
    fit.refine(few);
    return {price(fit), fit.spheres()};
}

}  // namespace

ArrangementChanges improve_arrangement(const Image& brightness, const Image& ceiling,
                                       const SynthesisFit& fit, const std::vector<Point3>& discs,
                                       double scale, const SynthesisLimits& limits, int threads,
                                       std::vector<Point3>& spheres) {
    spheres = fit.spheres();
    ArrangementChanges changes;
    if (spheres.empty()) return changes;
    std::vector<double> about(spheres.size());
    parallel_for(static_cast<std::int64_t>(spheres.size()), threads, [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        about[i] = fit.misfit_about(i).sum;
    });
    std::vector<double> sorted = about;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double median = *middle;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < about.size(); ++i) {
        if (about[i] > kUnusual * median) order.push_back(i);
    }
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return about[a] > about[b]; });
    std::vector<std::size_t> places;
    for (const std::size_t i : order) {
        const bool is_taken = std::any_of(places.begin(), places.end(), [&](std::size_t j) {
            return squared_in_plane(spheres[i], spheres[j]) < kApart * kApart;
        });
        if (!is_taken) places.push_back(i);
    }
    changes.places = static_cast<int>(places.size());
    const double enough = kUsualMisfits * median;
    struct Better {
        std::vector<std::int32_t> member;  ///< spheres that it replaces
        std::vector<Point3> spheres;
        int added = 0;
    };
    std::vector<std::optional<Better>> better(places.size());
    std::vector<int> trials(places.size());
    parallel_for(static_cast<std::int64_t>(places.size()), threads, [&](std::int64_t index) {
        const auto k = static_cast<std::size_t>(index);
        const Point3 centre = spheres[places[k]];
        const Window w = cut_out(brightness, ceiling, fit, scale, centre);
        const Point3 place{centre.x - w.origin.x, centre.y - w.origin.y, 0};
        std::vector<Point3> start;
        for (const Point3& p : discs) {
            if (squared_in_plane(p, centre) < kFree * kFree) {
                start.push_back({p.x - w.origin.x, p.y - w.origin.y, p.z});
            }
        }
        // As they are all of them, with few rays the better ones, with all rays the best of these
        // and what there is.
        struct Trial {
            int added;
            std::size_t free;
            Outcome outcome;
        };
        std::vector<Trial> tried;
        const auto keep_best = [&](std::size_t most) {
            std::sort(tried.begin(), tried.end(), [](const Trial& a, const Trial& b) {
                return a.outcome.misfit < b.outcome.misfit;
            });
            if (tried.size() > most) tried.resize(most);
        };
        for (Candidate& c : candidates(w, start, scale, place, limits.height - 1)) {
            const auto free =
                static_cast<std::size_t>(static_cast<std::ptrdiff_t>(w.free) + c.added);
            const double misfit = price(fit_of(w, scale, c.spheres, free, kFewRays));
            tried.push_back({c.added, free, {misfit, std::move(c.spheres)}});
        }
        trials[k] = static_cast<int>(tried.size());
        keep_best(kFitted);
        for (Trial& t : tried) {
            t.outcome = fitted(w, scale, t.outcome.spheres, t.free, limits, kRoughly, kFewRays);
        }
        keep_best(kFinalists);
        double least =
            fitted(w, scale, w.spheres, w.free, limits, kRoughly, kRaysPerDiameter).misfit - enough;
        for (Trial& t : tried) {
            t.outcome =
                fitted(w, scale, t.outcome.spheres, t.free, limits, kWell, kRaysPerDiameter);
            if (!(t.outcome.misfit < least)) continue;
            least = t.outcome.misfit;
            Better found{.member = {w.member.begin(),
                                    w.member.begin() + static_cast<std::ptrdiff_t>(w.free)},
                         .spheres = {},
                         .added = t.added};
            for (std::size_t i = 0; i < t.free; ++i) {
                const Point3& p = t.outcome.spheres[i];
                found.spheres.push_back({p.x + w.origin.x, p.y + w.origin.y, p.z});
            }
            better[k] = std::move(found);
        }
    });
    std::vector<char> keep(spheres.size(), 1);
    std::vector<Point3> fresh;
    for (std::size_t k = 0; k < places.size(); ++k) {
        changes.trials += trials[k];
        if (!better[k]) continue;
        changes.added += better[k]->added > 0 ? 1 : 0;
        changes.removed += better[k]->added < 0 ? 1 : 0;
        changes.lifted += better[k]->added == 0 ? 1 : 0;
        for (const std::int32_t j : better[k]->member) keep[static_cast<std::size_t>(j)] = 0;
        fresh.insert(fresh.end(), better[k]->spheres.begin(), better[k]->spheres.end());
    }
    std::vector<Point3> result;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        if (keep[i] != 0) result.push_back(spheres[i]);
    }
    result.insert(result.end(), fresh.begin(), fresh.end());
    spheres = std::move(result);
    return changes;
}

}  // namespace grainfield::tracking
