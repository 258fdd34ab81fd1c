#include "simulate/render/optics/silhouette.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "core/support/parallel.h"
#include "simulate/render/optics/disc_union.h"
#include "simulate/render/optics/lens_aperture.h"

namespace grainfield::simulate {

namespace {

constexpr int rows_per_band = 64;
constexpr std::int32_t open = -1;
constexpr std::int32_t covered = -2;

struct Bands {
    std::vector<std::vector<std::int32_t>> discs;  // of each band, in order
};

Bands sort_into_bands(const std::vector<Disc>& discs, int height) {
    Bands bands;
    bands.discs.resize(static_cast<std::size_t>((height + rows_per_band - 1) / rows_per_band));
    const auto last = static_cast<double>(bands.discs.size()) - 1;
    for (std::size_t i = 0; i < discs.size(); ++i) {
        const Disc& d = discs[i];
        const double low = std::floor((d.centre.y - d.radius + 0.5) / rows_per_band);
        const double high = std::floor((d.centre.y + d.radius + 0.5) / rows_per_band);
        if (high < 0 || low > last) continue;
        const auto end = static_cast<std::size_t>(std::min(high, last));
        for (auto b = static_cast<std::size_t>(std::max(low, 0.0)); b <= end; ++b) {
            bands.discs[b].push_back(static_cast<std::int32_t>(i));
        }
    }
    return bands;
}

bool any_overlap(const std::vector<Disc>& discs) {
    for (std::size_t i = 0; i < discs.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const double reach = discs[i].radius + discs[j].radius;
            if (squared_norm(discs[i].centre - discs[j].centre) < reach * reach) return true;
        }
    }
    return false;
}

/// The union of discs in one band of rows.
class UnionBand {
 public:
    UnionBand(Image& image, int first_row, int end_row)
        : image_(image),
          first_row_(first_row),
          end_row_(end_row),
          width_(static_cast<std::size_t>(image.width())),
          owner_(width_ * static_cast<std::size_t>(end_row - first_row), open) {}

    void paint(const std::vector<Disc>& discs, const std::vector<std::int32_t>& members) {
        DiscScan scan;
        for (const std::int32_t i : members) {
            scan.scan(
                discs[static_cast<std::size_t>(i)], image_.width(), first_row_, end_row_,
                [&](int x, int y, double area) { add_edge(x, y, area, i); },
                [&](int y, int x, int end) {
                    std::fill(owner_.begin() + offset(x, y), owner_.begin() + offset(end, y),
                              covered);
                });
        }
        join(discs);
        for (int y = first_row_; y < end_row_; ++y) {
            float* row = image_.row(y);
            const std::int32_t* owner = owner_.data() + offset(0, y);
            for (std::size_t x = 0; x < width_; ++x) row[x] = owner[x] == covered ? 0 : row[x];
        }
    }

 private:
    std::ptrdiff_t offset(int x, int y) const {
        return static_cast<std::ptrdiff_t>(y - first_row_) * static_cast<std::ptrdiff_t>(width_) +
               x;
    }

    void add_edge(int x, int y, double area, std::int32_t disc) {
        std::int32_t& owner = owner_[static_cast<std::size_t>(offset(x, y))];
        if (owner == covered) return;
        image_(x, y) -= static_cast<float>(area);
        if (owner == open) {
            owner = disc;
        } else {
            shared_.push_back(
                {static_cast<std::int32_t>(offset(x, y)), disc, static_cast<float>(area)});
        }
    }

    // Pixels cut by several circles: the areas were added; right unless the discs overlap.
    void join(const std::vector<Disc>& discs) {
        std::sort(shared_.begin(), shared_.end(), [](const Shared& a, const Shared& b) {
            return std::tie(a.pixel, a.disc) < std::tie(b.pixel, b.disc);
        });
        std::vector<Disc> here;
        for (std::size_t i = 0; i < shared_.size();) {
            const Shared& second = shared_[i];
            const std::int32_t owner = owner_[static_cast<std::size_t>(second.pixel)];
            here.clear();
            if (owner >= 0) here.push_back(discs[static_cast<std::size_t>(owner)]);
            for (; i < shared_.size() && shared_[i].pixel == second.pixel; ++i) {
                here.push_back(discs[static_cast<std::size_t>(shared_[i].disc)]);
            }
            if (owner < 0 || !any_overlap(here)) continue;
            const int x = second.pixel % image_.width();
            const int y = first_row_ + second.pixel / image_.width();
            std::optional<double> area;
            if (here.size() == 2) {
                const double first_area = 1 - static_cast<double>(image_(x, y) + second.area);
                area = union_of_two(here[0], first_area, here[1], static_cast<double>(second.area),
                                    x, y);
            }
            if (!area) area = union_area(here.data(), static_cast<int>(here.size()), x, y);
            image_(x, y) = static_cast<float>(1 - *area);
        }
    }

    struct Shared {
        std::int32_t pixel;
        std::int32_t disc;
        float area;
    };

    Image& image_;
    int first_row_;
    int end_row_;
    std::size_t width_;
    std::vector<std::int32_t> owner_;
    std::vector<Shared> shared_;
};

// Bottom to top: every sphere hides what is below and adds its rim.
void paint_rims(const std::vector<Disc>& discs, const std::vector<std::int32_t>& members, float rim,
                int first_row, int end_row, Image& image) {
    DiscScan scan;
    for (const std::int32_t i : members) {
        Disc disc = discs[static_cast<std::size_t>(i)];
        scan.scan(
            disc, image.width(), first_row, end_row,
            [&](int x, int y, double area) {
                float& pixel = image(x, y);
                pixel += static_cast<float>(area) * (rim - pixel);
            },
            [&](int y, int x, int end) { std::fill(image.row(y) + x, image.row(y) + end, rim); });
        disc.radius *= std::numbers::sqrt2 / 2;
        scan.scan(
            disc, image.width(), first_row, end_row,
            [&](int x, int y, double area) {
                float& pixel = image(x, y);
                pixel = std::max(0.0F, pixel - static_cast<float>(area) * rim);
            },
            [&](int y, int x, int end) { std::fill(image.row(y) + x, image.row(y) + end, 0.0F); });
    }
}

}  // namespace

Disc silhouette_of(Vec3 centre, const View& view) {
    constexpr double radius = 0.5;
    const double scale = view.scale_at(centre.z);
    const Vec2 seen = view.project(centre);
    if (view.projection() == Projection::telecentric) return {seen, radius * scale};
    const double depth = view.distance() + view.mid_height() - centre.z;
    const double tangent2 = depth * depth - radius * radius;
    const Vec2 axis = view.project({view.centre().x, view.centre().y, centre.z});
    const Vec2 off = {centre.x - view.centre().x, centre.y - view.centre().y};
    const double minor = radius * scale * depth / std::sqrt(tangent2);
    const double major =
        radius * scale * depth * std::sqrt(tangent2 + squared_norm(off)) / tangent2;
    return {axis + (depth * depth / tangent2) * (seen - axis), std::sqrt(minor * major)};
}

OptionTable Silhouette::describe() {
    OptionTable t(name());
    t.number("rim", rim, "-", {0, 1}, "brightness of the mirroring ring outside R/√2");
    return t;
}

std::unique_ptr<Optics> Silhouette::make(double /*noise*/, int threads) const {
    return std::make_unique<SilhouetteOptics>(*this, threads);
}

void Silhouette::explain(double /*noise*/, RunPlan& plan) const {
    if (rim > 0) return;
    plan.skip("reflections", "silhouettes without a rim", "sorting by height");
}

SilhouetteOptics::SilhouetteOptics(const SilhouetteOptions& options, int threads)
    : options_(options), threads_(threads) {}

Image SilhouetteOptics::radiance(std::span<const SphereScene> instants, const View& view) {
    const std::vector<Vec2> lens = lens_points(view.aperture());
    Image mean(view.width(), view.height(), 0.0F);
    for (const SphereScene& scene : instants) {
        for (const Vec2 point : lens) {
            const Image image = at_one_instant(seen_through(scene, point, view), view);
            for (std::size_t i = 0; i < mean.size(); ++i) mean.pixels()[i] += image.pixels()[i];
        }
    }
    const std::size_t images = instants.size() * lens.size();
    if (images > 1) {
        const float weight = 1.0F / static_cast<float>(images);
        for (float& value : mean.pixels()) value *= weight;
    }
    cost_.pixels += static_cast<double>(mean.size());
    cost_.settled += static_cast<double>(mean.size());
    return mean;
}

Image SilhouetteOptics::at_one_instant(const SphereScene& scene, const View& view) const {
    std::vector<std::size_t> order(scene.centre.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    if (options_.rim > 0) {
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return scene.centre[a].z < scene.centre[b].z;
        });
    }
    std::vector<Disc> discs;
    discs.reserve(order.size());
    for (const std::size_t i : order) discs.push_back(silhouette_of(scene.centre[i], view));

    Image image(view.width(), view.height(), 1.0F);
    const Bands bands = sort_into_bands(discs, view.height());
    parallel_for(static_cast<std::int64_t>(bands.discs.size()), threads_, [&](std::int64_t b) {
        const auto& members = bands.discs[static_cast<std::size_t>(b)];
        const int first = static_cast<int>(b) * rows_per_band;
        const int end = std::min(first + rows_per_band, view.height());
        if (options_.rim > 0) {
            paint_rims(discs, members, static_cast<float>(options_.rim), first, end, image);
        } else if (!members.empty()) {
            UnionBand(image, first, end).paint(discs, members);
        }
    });
    return image;
}

}  // namespace grainfield::simulate
