#include "tracking/refine/joint_fit.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/support/parallel.h"
#include "tracking/point_grid.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

constexpr int kFullSteps = 30;
constexpr float kFresh = std::numeric_limits<float>::max();
constexpr float kUnmoved = 0.2F;
constexpr double kLag = 1;  // tolerances
// Beyond the edge a disc changes by less than 0.1 % of the contrast over this path.
constexpr double kMostStale = 0.05;  // [w]
constexpr int kInnerSweeps = 2;
// Two images of this size and their surroundings stay in the second-level cache.
constexpr double kTile = 128;

/// A square grid over the image.
struct Grid {
    double cell;
    int columns, rows;

    Grid(double width, double height, double cell_size)
        : cell(cell_size),
          columns(static_cast<int>(width / cell_size) + 1),
          rows(static_cast<int>(height / cell_size) + 1) {}

    int column(double x) const { return std::clamp(static_cast<int>(x / cell), 0, columns - 1); }
    int row(double y) const { return std::clamp(static_cast<int>(y / cell), 0, rows - 1); }
    std::size_t index(int c, int r) const {
        return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(c);
    }
    std::size_t size() const { return index(0, rows); }
    std::size_t at(Vec2 p) const { return index(column(p.x), row(p.y)); }
};

/// Cells in which a point fulfils the condition, and all their neighbours.
template <class Condition>
std::vector<char> cells_around(const Grid& grid, const std::vector<Vec2>& points,
                               Condition&& condition) {
    std::vector<char> marked(grid.size(), 0);
    for (std::size_t j = 0; j < points.size(); ++j) {
        if (!condition(j)) continue;
        const int c = grid.column(points[j].x);
        const int r = grid.row(points[j].y);
        for (int y = std::max(0, r - 1); y <= std::min(grid.rows - 1, r + 1); ++y) {
            for (int x = std::max(0, c - 1); x <= std::min(grid.columns - 1, c + 1); ++x) {
                marked[grid.index(x, y)] = 1;
            }
        }
    }
    return marked;
}

}  // namespace

OptionTable describe(RefinementOptions& options) {
    OptionTable table("refine");
    table.number("tolerance", options.tolerance, "px", {1e-6, 1},
                 "a sphere rests when its refinement step is smaller than this");
    table.integer("max-sweeps", options.max_sweeps, "-", {1, 10000},
                  "most refinement sweeps over all spheres");
    return table;
}

JointFit::JointFit(const Image& darkness, const DiscProfile& disc, int threads, int spacing)
    : profile_(disc),
      threads_(threads),
      darkness_(padded_darkness(darkness, disc)),
      transmission_(clear_transmission(darkness.width(), darkness.height(), disc)),
      stencil_(disc, transmission_.pitch(), spacing),
      templates_(stencil_),
      pixels_(static_cast<double>(darkness.size())) {}

void JointFit::restart(const Image& darkness) {
    restart([&](int y, float* row) { std::copy_n(darkness.row(y), darkness.width(), row); });
}

void JointFit::restart(const WriteRow& write_row) {
    const int width = darkness_.width();
    in_row_bands(width, darkness_.height(), threads_, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            write_row(y, darkness_.row(y));
            std::fill_n(transmission_.row(y), width, 1.0F);
        }
    });
    visible_.hide_others(darkness_, 1.0F);
    visible_.hide_others(transmission_, 0.0F);
    positions_.clear();
    discs_.clear();
    free_.clear();
    slots_ = 0;
    some_undrawn_ = false;
    ++revision_;
}

void JointFit::set_visible(VisiblePixels visible) {
    visible_ = std::move(visible);
    pixels_ = static_cast<double>(
        visible_.count(static_cast<std::int64_t>(darkness_.width()) * darkness_.height()));
}

StencilView JointFit::view(const Disc& disc) const {
    return {stencil_,
            darkness_,
            const_cast<PaddedImage&>(transmission_),
            disc.anchor,
            const_cast<HalfFloat*>(kept_.data()) + disc.slot * stencil_.size(),
            disc.number != DiscTemplates::kNone ? templates_[disc.number] : DiscTemplate{}};
}

std::uint32_t JointFit::free_slot() {
    if (!free_.empty()) {
        const std::uint32_t slot = free_.back();
        free_.pop_back();
        return slot;
    }
    // Vectors may run beyond the last one.
    const std::size_t needed =
        (slots_ + std::size_t{1}) * stencil_.size() + std::size_t{DiscStencil::kLanes};
    if (kept_.size() < needed) kept_.resize(std::max(needed, 3 * kept_.size() / 2));
    return slots_++;
}

/// Kept within the image; written so that a NaN ends in a corner.
Vec2 JointFit::inside(Vec2 p) const {
    return {std::max(-0.5, std::min(p.x, darkness_.width() - 0.5)),
            std::max(-0.5, std::min(p.y, height() - 0.5))};
}

Vec2 JointFit::roughly(Vec2 p) const {
    return templates_.is_empty() ? inside(p) : templates_.nearest(inside(p)).centre;
}

void JointFit::append(Vec2 position, std::optional<double> explained, std::optional<double> left) {
    const Vec2 p = inside(position);
    const float expected = left ? static_cast<float>(*left) : kFresh;
    positions_.push_back(p);
    discs_.push_back({.anchor = Anchor::of(p, stencil_.spacing()),
                      .placed = p,
                      .slot = free_slot(),
                      .last_step = expected,
                      .left = expected,
                      .drift = explained ? 0 : kFresh,
                      .explained = explained.value_or(0)});
}

void JointFit::add(Vec2 position) {
    ++revision_;
    append(position, {}, {});
    draw(view(discs_.back()), positions_.back());
}

/// One of many: at the nearest template, if there are any.
void JointFit::draw_new(std::size_t j) {
    Disc& disc = discs_[j];
    if (templates_.is_empty()) {
        draw(view(disc), positions_[j]);
        return;
    }
    const DiscTemplates::Place place = templates_.nearest(positions_[j]);
    positions_[j] = place.centre;
    use(disc, place);
    draw_template(view(disc));
}

/// From now on a disc is drawn from the template of that place.
void JointFit::use(Disc& disc, const DiscTemplates::Place& place) {
    disc.anchor = place.anchor;
    disc.placed = place.centre;
    disc.number = place.number;
}

bool JointFit::is_at(const Disc& disc, const DiscTemplates::Place& place) const {
    return disc.number == place.number && disc.anchor == place.anchor;
}

/// Divides a disc out where it is drawn and multiplies it in at the template's place. Returns the
/// change of Σ (I − M)².
double JointFit::move_to(std::size_t j, const DiscTemplates::Place& place) {
    Disc& disc = discs_[j];
    double change = 0;
    if (disc.anchor == place.anchor) {
        change = shift(view(disc), templates_[place.number]);
        use(disc, place);
    } else {
        change = lift(view(disc));
        use(disc, place);
        change += place_template(view(disc));
    }
    return change;
}

void JointFit::add_all(const std::vector<Vec2>& positions, const std::vector<double>& explained,
                       std::optional<double> left) {
    ++revision_;
    std::vector<std::uint32_t> added;
    added.reserve(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        added.push_back(static_cast<std::uint32_t>(discs_.size()));
        append(positions[i], explained.empty() ? std::nullopt : std::optional(explained[i]), left);
    }
    in_tiles(added, [&](const std::vector<std::uint32_t>& tile) {
        for (const std::uint32_t j : tile) draw_new(j);
    });
}

DrawingOrder JointFit::drawing_order() const {
    std::vector<Anchor> anchors;
    anchors.reserve(discs_.size());
    for (const Disc& disc : discs_) anchors.push_back(disc.anchor);
    return {darkness_, stencil_, anchors};
}

int JointFit::parts() const {
    return DrawingOrder::parts(darkness_, stencil_);
}

void JointFit::add_all(const std::vector<Vec2>& positions, const std::vector<double>& explained,
                       std::optional<double> left, const Visit& visit) {
    if (!discs_.empty()) throw std::logic_error("JointFit::add_all with visits: not an empty fit");
    ++revision_;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        append(positions[i], explained.empty() ? std::nullopt : std::optional(explained[i]), left);
    }
    drawing_order().draw_and_visit(
        threads_, transmission_, darkness_, [&](std::uint32_t j) { draw_new(j); }, visit);
}

void JointFit::in_parts(const Visit& visit) const {
    drawing_order().visit(threads_, visit);
}

void JointFit::move(std::size_t j, Vec2 to) {
    ++revision_;
    move_to(j, inside(to));
    discs_[j].last_step = kFresh;
    discs_[j].left = kFresh;
    discs_[j].drift = kFresh;
}

/// Divides a disc out where it is and multiplies it in at `to`, in a window of its own.
double JointFit::move_to(std::size_t j, Vec2 to) {
    Disc& disc = discs_[j];
    const double lifted = lift(view(disc));
    disc.anchor = Anchor::of(to, stencil_.spacing());
    disc.placed = to;
    disc.stale = 0;
    disc.number = DiscTemplates::kNone;
    positions_[j] = to;
    return lifted + place(view(disc), to);
}

void JointFit::keep_only(const std::vector<char>& keep) {
    ++revision_;
    // Whoever looks at the gap next has to move again, so its neighbours count as fresh.
    const Grid grid(darkness_.width(), height(), 2 * profile_.reach());
    const std::vector<char> disturbed =
        cells_around(grid, positions_, [&](std::size_t j) { return keep[j] == 0; });
    std::size_t kept = 0;
    for (std::size_t j = 0; j < positions_.size(); ++j) {
        Disc& disc = discs_[j];
        if (!keep[j]) {
            lift(view(disc));
            free_.push_back(disc.slot);
            continue;
        }
        if (disturbed[grid.at(positions_[j])] != 0) {
            disc.last_step = kFresh;
            disc.left = kFresh;
            disc.drift = kFresh;
        }
        positions_[kept] = positions_[j];
        discs_[kept] = disc;
        ++kept;
    }
    positions_.resize(kept);
    discs_.resize(kept);
}

DampedInverse::DampedInverse(const NormalEquations& n) {
    const double damping = 1e-3 * (n.xx + n.yy) + 1e-3;
    const double a = n.xx + damping;
    const double b = n.yy + damping;
    const double determinant = a * b - n.xy * n.xy;
    xx = b / determinant;
    xy = -n.xy / determinant;
    yy = a / determinant;
}

/// How much of a disc is drawn anew when it goes to `to`, and its path since it was drawn as a
/// whole, after that.
std::pair<Redraw, float> JointFit::redraw_for(const Disc& disc, Vec2 to) const {
    if (disc.number != DiscTemplates::kNone) return {Redraw::whole, 0.0F};
    const auto path = disc.stale + static_cast<float>(norm(to - disc.placed));
    if (static_cast<double>(path) > kMostStale * profile_.edge_width) return {Redraw::whole, 0.0F};
    return {Redraw::edge, path};
}

/// One damped Gauss–Newton step of disc j; returns the length of the displacement done. Steps up to
/// `lag` are not drawn.
double JointFit::step(std::size_t j, double relaxation, double lag, Drawing drawing) {
    thread_local BeforeShift before;
    Disc& disc = discs_[j];
    const Vec2 start = positions_[j];
    const Vec2 from = disc.placed;
    const NormalEquations n = linearise(view(disc), from);
    Vec2 d = relaxation * (DampedInverse(n) * Vec2{n.bx, n.by});
    // Steps shrink from sweep to sweep, so the last one says how much room the next needs.
    const double room =
        std::clamp(1.5 * static_cast<double>(disc.last_step), kLongestStep, longest_step(profile_));
    const double length = std::sqrt(squared_norm(d));
    if (length <= lag) {
        positions_[j] = inside(from + d);
        return norm(positions_[j] - start);
    }
    if (length > room) d *= room / length;
    if (drawing == Drawing::roughly && !templates_.is_empty()) return rough_step(j, d, n.misfit);

    for (int attempt = 0; attempt < 4; ++attempt) {
        const Vec2 to = inside(from + d);
        const bool in_window = disc.anchor.holds(to, stencil_.spacing());
        const auto [redraw, stale] = redraw_for(disc, to);
        const double change = in_window ? shift(view(disc), to, redraw, before) : move_to(j, to);
        if (change <= 1e-5 * (n.misfit + 1e-6)) {
            if (in_window) {
                disc.stale = stale;
                disc.number = DiscTemplates::kNone;
            }
            disc.placed = to;
            positions_[j] = to;
            return norm(to - start);
        }
        if (in_window) {
            undo(view(disc), before);
        } else {
            move_to(j, from);
        }
        d *= 0.3;
    }
    positions_[j] = from;
    return 0;
}

/// The same to the template nearest to the end of step d.
double JointFit::rough_step(std::size_t j, Vec2 d, double misfit) {
    Disc& disc = discs_[j];
    const Vec2 start = positions_[j];
    const Vec2 from = disc.placed;
    const DiscTemplates::Place back{from, disc.anchor, disc.number};
    const double square = 0.999 / templates_.per_pixel();
    for (int attempt = 0; attempt < 4; ++attempt) {
        const Vec2 to = inside(from + d);
        const DiscTemplates::Place place = templates_.nearest(to);
        const bool stays = is_at(disc, place);
        if (stays || move_to(j, place) <= 1e-5 * (misfit + 1e-6)) {
            positions_[j] = to;
            return norm(to - start);
        }
        if (back.number != DiscTemplates::kNone) {
            move_to(j, back);
        } else {
            move_to(j, from);
        }
        // From one template to the next the misfit may rise though the step is right: as far as the
        // edge of its square, then.
        if (squared_norm(d) <= 2 * square * square) {
            positions_[j] = from + Vec2{std::clamp(d.x, -square / 2, square / 2),
                                        std::clamp(d.y, -square / 2, square / 2)};
            return norm(positions_[j] - start);
        }
        d *= 0.3;
    }
    positions_[j] = from;
    return 0;
}

void JointFit::take_step(std::size_t j, double relaxation, double lag, Drawing drawing) {
    Disc& disc = discs_[j];
    const auto done = static_cast<float>(step(j, relaxation, lag, drawing));
    disc.is_disturbed = true;
    // Steps that shrink by q each leave s (q + q² + …); next to one another discs may shrink
    // slowly.
    const float q = disc.last_step == kFresh || disc.last_step <= 0 ? 1 : done / disc.last_step;
    disc.left = q < 0.5F ? done * q / (1 - q) : done;
    disc.last_step = done;
    disc.drift += done;
}

std::vector<char> JointFit::active_discs(double tolerance) const {
    const Grid grid(darkness_.width(), height(), profile_.diameter + 2 * profile_.edge_width);
    const std::vector<char> moving = cells_around(
        grid, positions_, [&](std::size_t j) { return discs_[j].is_restless(tolerance); });
    std::vector<char> active(positions_.size());
    for (std::size_t j = 0; j < positions_.size(); ++j) active[j] = moving[grid.at(positions_[j])];
    return active;
}

void JointFit::in_tiles(const std::vector<std::uint32_t>& discs,
                        const std::function<void(const std::vector<std::uint32_t>&)>& body) {
    // A disc writes at most reach and its steps in one visit (and the rest of a vector) beyond its
    // tile, so two tiles of one colour, one tile apart, never touch the same pixel.
    const double farthest_step = (1 + kInnerSweeps) * longest_step(profile_);
    const double furthest = profile_.reach() + std::max(1.0, farthest_step) + 1;
    const Grid tiles(darkness_.width(), height(),
                     std::max(kTile, 2 * furthest + PaddedImage::kMostLanes));
    std::vector<std::vector<std::uint32_t>> members(tiles.size());
    for (const std::uint32_t j : discs) members[tiles.at(positions_[j])].push_back(j);
    for (int colour = 0; colour < 4; ++colour) {
        std::vector<std::size_t> work;
        for (int r = colour / 2; r < tiles.rows; r += 2) {
            for (int c = colour % 2; c < tiles.columns; c += 2) {
                if (!members[tiles.index(c, r)].empty()) work.push_back(tiles.index(c, r));
            }
        }
        parallel_for(static_cast<std::int64_t>(work.size()), threads_,
                     [&](std::int64_t i) { body(members[work[static_cast<std::size_t>(i)]]); });
    }
}

JointFit::Summary JointFit::refine(const RefinementOptions& options, Drawing drawing) {
    Summary summary;
    std::vector<std::uint32_t> active;
    for (; summary.sweeps < options.max_sweeps; ++summary.sweeps) {
        const std::vector<char> is_active = active_discs(options.tolerance);
        active.clear();
        for (std::uint32_t j = 0; j < is_active.size(); ++j) {
            if (is_active[j]) {
                active.push_back(j);
            } else {
                ++summary.skipped;
            }
        }
        if (active.empty()) return summary;
        ++revision_;
        if (some_undrawn_) {
            // A disc is compared with the image of all that share pixels with it.
            std::vector<Vec2> places;
            for (const std::uint32_t j : active) places.push_back(positions_[j]);
            draw_undrawn_near(places, 2 * profile_.reach(), drawing);
        }
        std::atomic<std::int64_t> steps = 0;
        // A few discs at the edge of what can be resolved would step to and fro for ever.
        const double relaxation = summary.sweeps < kFullSteps ? 1.0 : 0.5;
        in_tiles(active, [&](const std::vector<std::uint32_t>& tile) {
            for (std::size_t k = 0; k < tile.size(); ++k) {
                if (k + 1 < tile.size()) fetch(tile[k + 1]);
                take_step(tile[k], relaxation, kLag * options.tolerance, drawing);
            }
            auto done = static_cast<std::int64_t>(tile.size());
            // While the tile is in the cache.
            for (int again = 0; again < kInnerSweeps; ++again) {
                for (const std::uint32_t j : tile) {
                    if (!discs_[j].is_restless(options.tolerance)) continue;
                    take_step(j, relaxation, kLag * options.tolerance, drawing);
                    ++done;
                }
            }
            steps += done;
        });
        some_undrawn_ = some_undrawn_ || drawing == Drawing::roughly;
        summary.steps += steps;
    }
    summary.unsettled = std::count_if(discs_.begin(), discs_.end(), [&](const Disc& disc) {
        return disc.is_restless(options.tolerance);
    });
    return summary;
}

const std::vector<double>& JointFit::explained() {
    const Grid grid(darkness_.width(), height(), 2 * profile_.reach());
    const std::vector<char> moved =
        cells_around(grid, positions_, [&](std::size_t j) { return discs_[j].drift > kUnmoved; });
    explained_.resize(discs_.size());
    parallel_for(static_cast<std::int64_t>(discs_.size()), threads_, [&](std::int64_t i) {
        const auto j = static_cast<std::size_t>(i);
        Disc& disc = discs_[j];
        if (moved[grid.at(positions_[j])] != 0) {
            disc.explained = tracking::explained(view(disc));
        }
        explained_[j] = disc.explained;
    });
    for (Disc& disc : discs_) {
        if (disc.drift > kUnmoved) disc.drift = 0;
    }
    return explained_;
}

NormalEquations JointFit::normal_equations(std::size_t j) const {
    return linearise(view(discs_[j]), discs_[j].placed);
}

CrossBlock JointFit::coupling(std::size_t i, std::size_t j) const {
    return tracking::coupling(view(discs_[i]), discs_[i].placed, view(discs_[j]), discs_[j].placed);
}

void JointFit::fetch(std::size_t j) const {
    tracking::fetch(view(discs_[j]));
}

std::int64_t JointFit::displace(const Displacement& all, double least_drawn, double far,
                                bool check_far) {
    std::vector<std::uint32_t> drawn;
    std::int64_t went_far = 0;
    for (std::uint32_t j = 0; j < discs_.size(); ++j) {
        Disc& disc = discs_[j];
        const Vec2 step = all.step[j];
        const double length = std::sqrt(squared_norm(step));
        if (!(length <= far)) {
            disc.is_disturbed = true;
            ++went_far;
        }
        disc.last_step = static_cast<float>(std::min(length, kLongestStep));
        // What is neglected is of second order in the step.
        const auto neglected = static_cast<float>(length * length / profile_.edge_width);
        const bool is_checked = length > (check_far ? far : kLongestStep);
        disc.left = is_checked ? disc.last_step : std::max(all.left[j], neglected);
        disc.drift += disc.last_step;
        const Vec2 d = length > kLongestStep ? (kLongestStep / length) * step : step;
        positions_[j] = inside(disc.placed + d);
        if (length > least_drawn) {
            drawn.push_back(j);
        } else {
            some_undrawn_ = some_undrawn_ || length > 0;
        }
    }
    // As far as a template can be from a disc, a step would not be drawn at all.
    const bool roughly =
        least_drawn >= std::numbers::sqrt2 * DiscTemplates::kFarthest * profile_.edge_width;
    some_undrawn_ = some_undrawn_ || roughly;
    redraw_all(drawn, roughly ? Drawing::roughly : Drawing::exactly);
    return went_far;
}

std::vector<char> JointFit::take_disturbed() {
    const double range = 2 * profile_.edge_reach();
    PointGrid grid(darkness_.width(), height(), range);
    for (std::uint32_t j = 0; j < discs_.size(); ++j) {
        if (!discs_[j].is_disturbed) continue;
        grid.add(positions_[j], j);
        discs_[j].is_disturbed = false;
    }
    std::vector<char> disturbed(discs_.size());
    for (std::size_t j = 0; j < discs_.size(); ++j) disturbed[j] = grid.any(positions_[j], range);
    return disturbed;
}

void JointFit::draw_undrawn_near(const std::vector<Vec2>& places, double range, Drawing drawing) {
    if (!some_undrawn_) return;
    const bool roughly = drawing == Drawing::roughly && !templates_.is_empty();
    std::vector<std::uint32_t> waiting;
    for (std::uint32_t j = 0; j < discs_.size(); ++j) {
        const bool is_drawn = roughly ? is_at(discs_[j], templates_.nearest(positions_[j]))
                                      : !(squared_norm(undrawn_step(j)) > 0);
        if (!is_drawn) waiting.push_back(j);
    }
    if (waiting.empty()) return;
    PointGrid grid(darkness_.width(), height(), range);
    for (const Vec2 p : places) grid.add(p, 0);
    std::erase_if(waiting, [&](std::uint32_t j) { return !grid.any(positions_[j], range); });
    redraw_all(waiting, drawing);
}

void JointFit::draw_undrawn() {
    std::vector<std::uint32_t> waiting;
    for (std::uint32_t j = 0; j < discs_.size(); ++j) {
        if (squared_norm(undrawn_step(j)) > 0) waiting.push_back(j);
    }
    redraw_all(waiting, Drawing::exactly);
    some_undrawn_ = false;
}

void JointFit::redraw_all(const std::vector<std::uint32_t>& discs, Drawing drawing) {
    if (discs.empty()) return;
    ++revision_;
    in_tiles(discs, [&](const std::vector<std::uint32_t>& tile) {
        for (std::size_t k = 0; k < tile.size(); ++k) {
            if (k + 1 < tile.size()) fetch(tile[k + 1]);
            redraw(tile[k], drawing);
        }
    });
}

/// Draws a disc where it is now, or at the template nearest to that.
void JointFit::redraw(std::size_t j, Drawing drawing) {
    Disc& disc = discs_[j];
    const Vec2 to = positions_[j];
    if (drawing == Drawing::roughly && !templates_.is_empty()) {
        const DiscTemplates::Place place = templates_.nearest(to);
        if (!is_at(disc, place)) move_to(j, place);
        return;
    }
    if (!disc.anchor.holds(to, stencil_.spacing())) {
        move_to(j, to);
        return;
    }
    const auto [what, stale] = redraw_for(disc, to);
    tracking::redraw(view(disc), to, what);
    disc.number = DiscTemplates::kNone;
    disc.stale = stale;
    disc.placed = to;
}

std::vector<double> JointFit::residuals(const std::vector<double>& gain) const {
    std::vector<double> rms(discs_.size(), std::numeric_limits<double>::quiet_NaN());
    parallel_for(static_cast<std::int64_t>(rms.size()), threads_, [&](std::int64_t i) {
        const auto j = static_cast<std::size_t>(i);
        const LocalMisfit misfit = local_misfit(view(discs_[j]), discs_[j].placed);
        if (!(misfit.pixels > 0)) return;
        const double sum = misfit.sum - (gain.empty() ? 0 : gain[j]);
        rms[j] = std::sqrt(std::max(0.0, sum) / misfit.pixels);
    });
    return rms;
}

double JointFit::residual_rms(const std::vector<double>& gain) const {
    const int width = darkness_.width();
    const int height = darkness_.height();
    std::vector<double> rows(static_cast<std::size_t>(height));
    in_row_bands(width, height, threads_, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            const float* d = darkness_.row(y);
            const float* t = transmission_.row(y);
            float row = 0;
#pragma omp simd reduction(+ : row)
            for (int x = 0; x < width; ++x) {
                const float r = d[x] - 1.0F + t[x];
                row += r * r;
            }
            rows[static_cast<std::size_t>(y)] = static_cast<double>(row);
        }
    });
    const double sum = std::accumulate(rows.begin(), rows.end(), 0.0) -
                       std::accumulate(gain.begin(), gain.end(), 0.0);
    const double n = pixels();
    return n > 0 ? std::sqrt(std::max(0.0, sum) / n) : 0;
}

}  // namespace grainfield::tracking
