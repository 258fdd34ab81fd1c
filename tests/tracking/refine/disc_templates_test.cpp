#include "tracking/refine/disc_templates.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/tracking/refine/disc_oracle.h"
#include "tracking/refine/computed_disc.h"
#include "tracking/refine/disc_kernel.h"
#include "tracking/refine/drawn_disc.h"

namespace grainfield::tracking {
namespace {

/// Two discs that overlap, drawn from templates or computed at the same places.
struct Pair {
    PaddedImage darkness;
    PaddedImage transmission = clear_transmission(33, 33, kDisc);
    DiscStencil stencil;
    DiscTemplates templates;
    std::vector<DiscTemplates::Place> place;
    std::vector<DiscTemplate> shape;
    std::vector<std::vector<HalfFloat>> own;

    explicit Pair(bool from_templates)
        : darkness(dark()), stencil(kDisc, darkness.pitch()), templates(stencil) {
        for (const Vec2 p : {Vec2{12.3, 11.8}, Vec2{18.9, 14.2}}) {
            place.push_back(templates.nearest(p));
            shape.push_back(templates[place.back().number]);
            own.emplace_back(stencil.size() + DiscStencil::kLanes);
        }
        for (std::size_t j = 0; j < place.size(); ++j) {
            if (from_templates) {
                draw_template(view(j, true));
            } else {
                draw(view(j, false), place[j].centre);
            }
        }
    }

    static PaddedImage dark() {
        RandomStream random(3, "darkness");
        Image d(33, 33);
        for (float& v : d.pixels()) v = static_cast<float>(random.uniform(0, 1));
        return padded_darkness(d, kDisc);
    }
    StencilView view(std::size_t j, bool from_template) {
        return {stencil,         darkness,      transmission,
                place[j].anchor, own[j].data(), from_template ? shape[j] : DiscTemplate{}};
    }
};

TEST(DiscTemplates, TheNearestPlaceIsWithinHalfASquareAndStaysItself) {
    RandomStream random(5, "places");
    for (const int spacing : {1, 2}) {
        const PaddedImage image = clear_transmission(40, 40 / spacing, kDisc);
        const DiscStencil stencil(kDisc, image.pitch(), spacing);
        const DiscTemplates templates(stencil);
        ASSERT_FALSE(templates.is_empty());
        const double half = 0.5 / templates.per_pixel();
        EXPECT_LE(half, DiscTemplates::kFarthest * kDisc.edge_width);
        for (int i = 0; i < 1000; ++i) {
            const Vec2 p{random.uniform(-0.5, 39.5), random.uniform(-0.5, 39.5)};
            const auto place = templates.nearest(p);
            EXPECT_LE(std::abs(place.centre.x - p.x), half + 1e-12);
            EXPECT_LE(std::abs(place.centre.y - p.y), half + 1e-12);
            EXPECT_EQ(place.anchor, Anchor::of(p, spacing));
            const auto again = templates.nearest(place.centre);
            EXPECT_EQ(again.number, place.number);
            EXPECT_EQ(again.anchor, place.anchor);
        }
    }
}

TEST(DiscTemplates, TheCornersOfAnImageHavePlaces) {
    const PaddedImage image = clear_transmission(40, 30, kDisc);
    const DiscTemplates templates(DiscStencil(kDisc, image.pitch()));
    for (const Vec2 p : {Vec2{-0.5, -0.5}, Vec2{39.5, 29.5}}) {
        const auto place = templates.nearest(p);
        EXPECT_NEAR(place.centre.x, p.x, DiscTemplates::kFarthest * kDisc.edge_width);
        EXPECT_NEAR(place.centre.y, p.y, DiscTemplates::kFarthest * kDisc.edge_width);
    }
}

TEST(DiscTemplates, DrawingOneIsDrawingTheDisc) {
    const Pair tables(true);
    const Pair computed(false);
    for (int y = 0; y < 33; ++y) {
        for (int x = 0; x < 33; ++x) {
            EXPECT_NEAR(tables.transmission(x, y), computed.transmission(x, y), 1e-3);
            double t = 1;
            for (const auto& place : tables.place) {
                t *= oracle_transmission(std::hypot(x - place.centre.x, y - place.centre.y));
            }
            EXPECT_NEAR(tables.transmission(x, y), t, 2e-3);
        }
    }
}

TEST(DiscTemplates, WhatTablesSayOfADiscIsWhatIsComputed) {
    Pair tables(true);
    Pair computed(false);
    for (const std::size_t j : {0U, 1U}) {
        const NormalEquations a = linearise(tables.view(j, true), tables.place[j].centre);
        const NormalEquations b = linearise(computed.view(j, false), computed.place[j].centre);
        const double scale = 1e-3 * kDisc.information();
        EXPECT_NEAR(a.xx, b.xx, scale);
        EXPECT_NEAR(a.xy, b.xy, scale);
        EXPECT_NEAR(a.yy, b.yy, scale);
        EXPECT_NEAR(a.bx, b.bx, scale);
        EXPECT_NEAR(a.by, b.by, scale);
        EXPECT_NEAR(a.misfit, b.misfit, 1e-3 * b.misfit);
    }
    const CrossBlock a = coupling(tables.view(0, true), tables.place[0].centre,
                                  tables.view(1, true), tables.place[1].centre);
    const CrossBlock b = coupling(computed.view(0, false), computed.place[0].centre,
                                  computed.view(1, false), computed.place[1].centre);
    const double size = std::abs(b.xx) + std::abs(b.xy) + std::abs(b.yx) + std::abs(b.yy);
    ASSERT_GT(size, 0.01);
    EXPECT_NEAR(a.xx, b.xx, 5e-3 * size);
    EXPECT_NEAR(a.xy, b.xy, 5e-3 * size);
    EXPECT_NEAR(a.yx, b.yx, 5e-3 * size);
    EXPECT_NEAR(a.yy, b.yy, 5e-3 * size);
}

double misfit(const Pair& pair) {
    double sum = 0;
    for (int y = 0; y < 33; ++y) {
        for (int x = 0; x < 33; ++x) {
            const double r = static_cast<double>(pair.darkness(x, y)) - 1 +
                             static_cast<double>(pair.transmission(x, y));
            sum += r * r;
        }
    }
    return sum;
}

TEST(DiscTemplates, AShiftSaysHowTheMisfitChangesAndGoesBack) {
    Pair pair(true);
    const Image before = pair.transmission.inner();
    const double at_first = misfit(pair);
    const DiscTemplates::Place to =
        pair.templates.nearest(pair.place[0].centre + Vec2{0.12, -0.15});
    ASSERT_EQ(to.anchor, pair.place[0].anchor);
    ASSERT_NE(to.number, pair.place[0].number);
    const double change = shift(pair.view(0, true), pair.templates[to.number]);
    EXPECT_NEAR(change, misfit(pair) - at_first, 1e-3);
    EXPECT_GT(std::abs(change), 0.02);
    const DiscTemplate back = pair.shape[0];
    pair.shape[0] = pair.templates[to.number];
    shift(pair.view(0, true), back);
    for (int y = 0; y < 33; ++y) {
        for (int x = 0; x < 33; ++x) {
            EXPECT_NEAR(pair.transmission(x, y), before(x, y), 1e-6);
        }
    }
}

TEST(DiscTemplates, LargeDiscsWithSharpEdgesAreComputed) {
    const DiscProfile disc{200, 0.8};
    const PaddedImage image = clear_transmission(500, 500, disc);
    EXPECT_TRUE(DiscTemplates(DiscStencil(disc, image.pitch())).is_empty());
}

}  // namespace
}  // namespace grainfield::tracking
