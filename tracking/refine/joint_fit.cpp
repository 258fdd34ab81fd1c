#include "tracking/refine/joint_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "core/support/parallel.h"
#include "tracking/point_grid.h"
#include "tracking/refine/image_cells.h"

namespace grainfield::tracking {
namespace {

constexpr float kUnmoved = 0.2F;  // [px]

}  // namespace

JointFit::JointFit(const Image& darkness, const DiscProfile& disc, int threads, int spacing)
    : discs_{DiscScene(darkness, disc, spacing), threads, {}, {}, false, 0} {}

void JointFit::restart(const Image& darkness) {
    restart([&](int y, float* row) { std::copy_n(darkness.row(y), darkness.width(), row); });
}

void JointFit::restart(const WriteRow& write_row) {
    discs_.scene.restart(write_row, discs_.threads);
    discs_.position.clear();
    discs_.motion.clear();
    discs_.some_pending = false;
    ++discs_.revision;
    ++arrangement_;
}

void JointFit::look_at(const Image& darkness, double left) {
    draw_pending();
    discs_.scene.look_at(darkness, discs_.threads);
    for (DiscMotion& motion : discs_.motion) {
        motion = {};
        motion.last_step = motion.left = static_cast<float>(left);
    }
    ++discs_.revision;
    ++arrangement_;
}

void JointFit::add(Vec2 position) {
    ++discs_.revision;
    ++arrangement_;
    discs_.append(position, {}, {});
    discs_.scene.draw(discs_.size() - 1, Drawing::exactly);
}

namespace {

/// Many discs, not drawn yet; the number of the first one.
std::uint32_t append_all(FittedDiscs& discs, const std::vector<Vec2>& positions,
                         const std::vector<double>& explained, std::optional<double> left) {
    const auto first = static_cast<std::uint32_t>(discs.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        discs.append(positions[i], explained.empty() ? std::nullopt : std::optional(explained[i]),
                     left);
    }
    return first;
}

}  // namespace

void JointFit::add_all(const std::vector<Vec2>& positions, const std::vector<double>& explained,
                       std::optional<double> left) {
    ++discs_.revision;
    ++arrangement_;
    std::vector<std::uint32_t> added(positions.size());
    std::iota(added.begin(), added.end(), append_all(discs_, positions, explained, left));
    discs_.in_tiles(added, [&](const std::vector<std::uint32_t>& tile) {
        for (const std::uint32_t j : tile) {
            discs_.position[j] = discs_.scene.draw(j, Drawing::roughly);
        }
    });
}

void JointFit::add_all(const std::vector<Vec2>& positions, const std::vector<double>& explained,
                       std::optional<double> left, const Visit& visit) {
    if (discs_.size() > 0) {
        throw std::logic_error("JointFit::add_all with visits: not an empty fit");
    }
    ++discs_.revision;
    ++arrangement_;
    append_all(discs_, positions, explained, left);
    scene().drawing_order().draw_and_visit(
        discs_.threads, transmission(), darkness(),
        [&](std::uint32_t j) { discs_.position[j] = discs_.scene.draw(j, Drawing::roughly); },
        visit);
}

void JointFit::move(std::size_t j, Vec2 to) {
    ++discs_.revision;
    ++arrangement_;
    const Vec2 place = discs_.scene.inside(to);
    discs_.scene.move_to(j, place);
    discs_.position[j] = place;
    DiscMotion& motion = discs_.motion[j];
    motion.last_step = motion.left = motion.drift = DiscMotion::kFresh;
}

void JointFit::keep_only(const std::vector<char>& keep) {
    ++discs_.revision;
    ++arrangement_;
    // Discs beside a gap have to move again: they count as fresh.
    const ImageCells cells(scene().width(), scene().height(), 2 * disc().reach());
    const std::vector<char> beside_gap =
        cells.around(discs_.position, [&](std::size_t j) { return keep[j] == 0; });
    discs_.scene.remove(keep);
    std::size_t kept = 0;
    for (std::size_t j = 0; j < keep.size(); ++j) {
        if (!keep[j]) continue;
        DiscMotion& motion = discs_.motion[j];
        if (beside_gap[cells.at(discs_.position[j])] != 0) {
            motion.last_step = motion.left = motion.drift = DiscMotion::kFresh;
        }
        discs_.position[kept] = discs_.position[j];
        discs_.motion[kept] = motion;
        ++kept;
    }
    discs_.position.resize(kept);
    discs_.motion.resize(kept);
}

const std::vector<double>& JointFit::explained() {
    const ImageCells cells(scene().width(), scene().height(), 2 * disc().reach());
    const std::vector<char> moved = cells.around(
        discs_.position, [&](std::size_t j) { return discs_.motion[j].drift > kUnmoved; });
    explained_.resize(discs_.size());
    parallel_for(static_cast<std::int64_t>(discs_.size()), discs_.threads, [&](std::int64_t i) {
        const auto j = static_cast<std::size_t>(i);
        DiscMotion& motion = discs_.motion[j];
        if (moved[cells.at(discs_.position[j])] != 0) motion.explained = scene().explained(j);
        explained_[j] = motion.explained;
    });
    for (DiscMotion& motion : discs_.motion) {
        if (motion.drift > kUnmoved) motion.drift = 0;
    }
    return explained_;
}

std::int64_t JointFit::displace(const Displacement& all, double least_drawn, double far,
                                bool check_far) {
    std::vector<std::uint32_t> drawn;
    std::int64_t went_far = 0;
    for (std::uint32_t j = 0; j < discs_.size(); ++j) {
        DiscMotion& motion = discs_.motion[j];
        const Vec2 step = all.step[j];
        const double length = std::sqrt(squared_norm(step));
        if (!(length <= far)) {
            motion.is_disturbed = true;
            ++went_far;
        }
        motion.last_step = static_cast<float>(std::min(length, kLongestStep));
        // What is neglected is of second order in the step.
        const auto neglected = static_cast<float>(length * length / disc().edge_width);
        const bool is_checked = length > (check_far ? far : kLongestStep);
        motion.left = is_checked ? motion.last_step : std::max(all.left[j], neglected);
        motion.drift += motion.last_step;
        const Vec2 d = length > kLongestStep ? (kLongestStep / length) * step : step;
        discs_.position[j] = scene().inside(scene()[j].centre + d);
        if (length > least_drawn) {
            drawn.push_back(j);
        } else {
            discs_.some_pending = discs_.some_pending || length > 0;
        }
    }
    // A step that is shorter than the distance to the nearest template can be would not be drawn.
    const bool roughly =
        least_drawn >= std::numbers::sqrt2 * DiscTemplates::kFarthest * disc().edge_width;
    discs_.some_pending = discs_.some_pending || roughly;
    discs_.redraw(drawn, roughly ? Drawing::roughly : Drawing::exactly);
    return went_far;
}

std::vector<char> JointFit::collect_disturbed() {
    const double range = 2 * disc().edge_reach();
    PointGrid grid(darkness().width(), scene().height(), range);
    for (std::uint32_t j = 0; j < discs_.size(); ++j) {
        if (!discs_.motion[j].is_disturbed) continue;
        grid.add(discs_.position[j], j);
        discs_.motion[j].is_disturbed = false;
    }
    std::vector<char> disturbed(discs_.size());
    for (std::size_t j = 0; j < discs_.size(); ++j) {
        disturbed[j] = grid.any(discs_.position[j], range);
    }
    return disturbed;
}

JointFit::Residuals JointFit::residuals(const std::vector<double>& gain) const {
    const std::vector<double> none(discs_.size(), std::numeric_limits<double>::quiet_NaN());
    Residuals rms{none, none, std::vector<double>(discs_.size(), 0)};
    parallel_for(static_cast<std::int64_t>(none.size()), discs_.threads, [&](std::int64_t i) {
        const auto j = static_cast<std::size_t>(i);
        const LocalMisfit misfit = scene().misfit_about(j);
        if (!(misfit.pixels > 0)) return;
        const double pending = gain.empty() ? 0 : gain[j];
        rms.within_reach[j] = std::sqrt(std::max(0.0, misfit.sum - pending) / misfit.pixels);
        if (!(misfit.edge > 0)) return;
        rms.edge_pixels[j] = misfit.edge * misfit.edge / misfit.edge2;
        // These are what a pending step changes.
        const double at_edge = misfit.at_edge / misfit.edge - pending / rms.edge_pixels[j];
        rms.at_edge[j] = std::sqrt(std::max(0.0, at_edge));
    });
    return rms;
}

double JointFit::residual_rms(const std::vector<double>& gain) const {
    const double sum =
        scene().misfit(discs_.threads) - std::accumulate(gain.begin(), gain.end(), 0.0);
    const double n = scene().pixels();
    return n > 0 ? std::sqrt(std::max(0.0, sum) / n) : 0;
}

}  // namespace grainfield::tracking
