#include "tracking/refine/disc_scene.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

// Beyond the edge a disc changes by less than 0.1 % of the contrast over this path.
constexpr double kMostStale = 0.05;  // [w]

}  // namespace

DiscScene::DiscScene(const Image& darkness, const DiscProfile& disc, int spacing)
    : darkness_(padded_darkness(darkness, disc)),
      transmission_(clear_transmission(darkness.width(), darkness.height(), disc)),
      stencil_(disc, transmission_.pitch(), spacing),
      templates_(stencil_),
      pixels_(static_cast<double>(darkness.size())) {}

void DiscScene::restart(const WriteRow& write_row, int threads) {
    const int width = darkness_.width();
    in_row_bands(width, darkness_.height(), threads, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            write_row(y, darkness_.row(y));
            std::fill_n(transmission_.row(y), width, 1.0F);
        }
    });
    visible_.hide_others(darkness_, 1.0F);
    visible_.hide_others(transmission_, 0.0F);
    discs_.clear();
    free_.clear();
    slots_ = 0;
}

void DiscScene::look_at(const Image& darkness, int threads) {
    in_row_bands(darkness_.width(), darkness_.height(), threads, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            std::copy_n(darkness.row(y), darkness.width(), darkness_.row(y));
        }
    });
    visible_.hide_others(darkness_, 1.0F);
}

void DiscScene::set_visible(VisiblePixels visible) {
    visible_ = std::move(visible);
    pixels_ = static_cast<double>(
        visible_.count(static_cast<std::int64_t>(darkness_.width()) * darkness_.height()));
}

DiscTemplate DiscScene::shape_of(const SceneDisc& disc) const {
    return disc.number != DiscTemplates::kNone ? templates_[disc.number] : DiscTemplate{};
}

ConstStencilView DiscScene::view(const SceneDisc& disc) const {
    return {stencil_,
            darkness_,
            transmission_,
            disc.anchor,
            kept_.data() + disc.slot * stencil_.size(),
            shape_of(disc)};
}

StencilView DiscScene::view(const SceneDisc& disc) {
    return {stencil_,
            darkness_,
            transmission_,
            disc.anchor,
            kept_.data() + disc.slot * stencil_.size(),
            shape_of(disc)};
}

std::uint32_t DiscScene::free_slot() {
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

/// Written so that a NaN ends in a corner.
Vec2 DiscScene::inside(Vec2 p) const {
    return {std::max(-0.5, std::min(p.x, width() - 0.5)),
            std::max(-0.5, std::min(p.y, height() - 0.5))};
}

bool DiscScene::is_at(std::size_t j, const DiscTemplates::Place& place) const {
    return discs_[j].number == place.number && discs_[j].anchor == place.anchor;
}

DiscTemplates::Place DiscScene::place_of(std::size_t j) const {
    return {discs_[j].centre, discs_[j].anchor, discs_[j].number};
}

bool DiscScene::is_drawn_at(std::size_t j, Vec2 p, Drawing drawing) const {
    return drawing == Drawing::roughly && has_templates()
               ? is_at(j, nearest(p))
               : !(squared_norm(p - discs_[j].centre) > 0);
}

void DiscScene::append(Vec2 centre) {
    discs_.push_back(
        {.anchor = Anchor::of(centre, spacing()), .centre = centre, .slot = free_slot()});
}

Vec2 DiscScene::draw(std::size_t j, Drawing drawing) {
    SceneDisc& disc = discs_[j];
    if (drawing == Drawing::exactly || !has_templates()) {
        tracking::draw(view(disc), disc.centre);
    } else {
        use(disc, nearest(disc.centre));
        draw_template(view(disc));
    }
    return disc.centre;
}

/// From now on a disc is drawn from the template of that place.
void DiscScene::use(SceneDisc& disc, const DiscTemplates::Place& place) {
    disc.anchor = place.anchor;
    disc.centre = place.centre;
    disc.number = place.number;
}

void DiscScene::remove(const std::vector<char>& keep) {
    std::size_t kept = 0;
    for (std::size_t j = 0; j < discs_.size(); ++j) {
        if (keep[j]) {
            discs_[kept] = discs_[j];
            ++kept;
        } else {
            lift(view(discs_[j]));
            free_.push_back(discs_[j].slot);
        }
    }
    discs_.resize(kept);
}

/// How much of a disc is drawn anew when it goes to `to`, and its path since it was drawn as a
/// whole, after that.
std::pair<Redraw, float> DiscScene::redraw_for(const SceneDisc& disc, Vec2 to) const {
    if (disc.number != DiscTemplates::kNone) return {Redraw::whole, 0.0F};
    const auto path = disc.stale + static_cast<float>(norm(to - disc.centre));
    if (static_cast<double>(path) > kMostStale * stencil_.disc().edge_width) {
        return {Redraw::whole, 0.0F};
    }
    return {Redraw::edge, path};
}

double DiscScene::move_to(std::size_t j, const DiscTemplates::Place& place) {
    SceneDisc& disc = discs_[j];
    if (disc.anchor == place.anchor) {
        const double change = shift(view(disc), templates_[place.number]);
        use(disc, place);
        return change;
    }
    const double lifted = lift(view(disc));
    use(disc, place);
    return lifted + place_template(view(disc));
}

double DiscScene::move_to(std::size_t j, Vec2 to) {
    SceneDisc& disc = discs_[j];
    const double lifted = lift(view(disc));
    disc.anchor = Anchor::of(to, spacing());
    disc.centre = to;
    disc.stale = 0;
    disc.number = DiscTemplates::kNone;
    return lifted + place(view(disc), to);
}

double DiscScene::move(std::size_t j, Vec2 to, WayBack& back) {
    SceneDisc& disc = discs_[j];
    back.disc = disc;
    back.in_window = disc.anchor.holds(to, spacing());
    if (!back.in_window) return move_to(j, to);
    const auto [what, stale] = redraw_for(disc, to);
    const double change = shift(view(disc), to, what, back.pixels);
    disc.centre = to;
    disc.stale = stale;
    disc.number = DiscTemplates::kNone;
    return change;
}

void DiscScene::move_back(std::size_t j, const WayBack& back) {
    if (!back.in_window) {
        move_to(j, back.disc.centre);
        return;
    }
    discs_[j] = back.disc;
    undo(view(discs_[j]), back.pixels);
}

void DiscScene::redraw(std::size_t j, Vec2 p, Drawing drawing) {
    SceneDisc& disc = discs_[j];
    if (drawing == Drawing::roughly && has_templates()) {
        const DiscTemplates::Place place = nearest(p);
        if (!is_at(j, place)) move_to(j, place);
        return;
    }
    if (!disc.anchor.holds(p, spacing())) {
        move_to(j, p);
        return;
    }
    const auto [what, stale] = redraw_for(disc, p);
    tracking::redraw(view(disc), p, what);
    disc.number = DiscTemplates::kNone;
    disc.stale = stale;
    disc.centre = p;
}

CrossBlock DiscScene::coupling(std::size_t i, std::size_t j) const {
    return tracking::coupling(view(discs_[i]), discs_[i].centre, view(discs_[j]), discs_[j].centre);
}

double DiscScene::misfit(int threads) const {
    const int width = darkness_.width();
    const int height = darkness_.height();
    std::vector<double> rows(static_cast<std::size_t>(height));
    in_row_bands(width, height, threads, [&](int first, int last) {
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
    return std::accumulate(rows.begin(), rows.end(), 0.0);
}

DrawingOrder DiscScene::drawing_order() const {
    std::vector<Anchor> anchors;
    anchors.reserve(discs_.size());
    for (const SceneDisc& disc : discs_) anchors.push_back(disc.anchor);
    return {darkness_, stencil_, anchors};
}

}  // namespace grainfield::tracking
