// What CONTRIBUTING says of a new optics: one class of its options and how it starts, and a line in
// the list. Choice, option table, checks, plan and frames follow.
#include <cmath>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "simulate/render/renderer.h"
#include "tests/simulate/render/render_scenes.h"

namespace grainfield::simulate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A shadow on a screen below the spheres: a disc, blurred at its edge by `softness` [a].
struct ShadowgraphOptions {
    double softness = 0;
    double darkness = 1;
};

class ShadowgraphOptics : public Optics {
 public:
    explicit ShadowgraphOptics(const ShadowgraphOptions& options) : options_(options) {}
    using Optics::radiance;
    Image radiance(std::span<const SphereScene> instants, const View& view) override {
        Image image(view.width(), view.height(), 1.0F);
        for (const SphereScene& scene : instants) {
            for (int y = 0; y < view.height(); ++y) {
                for (int x = 0; x < view.width(); ++x) image(x, y) -= shadow(scene, view, x, y);
            }
        }
        cost_.pixels += static_cast<double>(image.size());
        return image;
    }
    OpticsCost cost() const override { return cost_; }

 private:
    float shadow(const SphereScene& scene, const View& view, int x, int y) const {
        const Vec3 seen = view.at_height({static_cast<double>(x), static_cast<double>(y)}, 0);
        for (const Vec3 p : scene.centre) {
            if (std::hypot(p.x - seen.x, p.y - seen.y) < 0.5 + options_.softness / 2) {
                return static_cast<float>(options_.darkness);
            }
        }
        return 0;
    }

    ShadowgraphOptions options_;
    OpticsCost cost_;
};

class Shadowgraph final : public OpticsKindOf<Shadowgraph>, public ShadowgraphOptions {
 public:
    std::string name() const override { return "shadowgraph"; }
    std::string meaning() const override { return "shadows on a screen"; }
    std::string title() const override { return "shadows"; }
    OptionTable describe() override {
        OptionTable t(name());
        t.number("softness", softness, "a", {0, 1}, "of the edge of a shadow");
        t.number("darkness", darkness, "-", {0, 1}, "of a shadow");
        return t;
    }
    void require_valid() const override {
        if (darkness <= 0 && softness > 0) throw OptionError("a soft shadow must be dark.");
    }
    std::unique_ptr<Optics> make(double, int) const override {
        return std::make_unique<ShadowgraphOptics>(*this);
    }
    void explain(double, RunPlan& plan) const override {
        if (softness <= 0) plan.skip("soft edges", "softness = 0", "nothing");
    }
};

RenderOptions with_shadowgraph() {
    RenderOptions options;
    options.optics.add(std::make_unique<Shadowgraph>());
    options.camera = CameraKind::ideal;
    options.view.width = options.view.height = 60;
    options.view.scale = 20;
    options.view.projection = Projection::telecentric;
    options.light.blur = 0;
    options.exposure.time_ms = 0;
    return options;
}

void set(std::vector<OptionTable>& tables, const std::string& section, const std::string& option,
         const OptionValue& value) {
    for (OptionTable& table : tables) {
        if (table.section() == section) table.set(option, value);
    }
}

Image frame_of(const RenderOptions& options, RunPlan& plan) {
    Snapshot snapshot;
    snapshot.box = square_box(3);
    snapshot.position = {{1.5, 1.5}};
    snapshot.z = {0.5};
    Renderer renderer(options, {}, snapshot.box, 1, 1, plan);
    return renderer.render(snapshot, 0).frame.image;
}

TEST(AnOpticsAddedToTheList, IsChosenAndSetLikeTheOthers) {
    RenderOptions options = with_shadowgraph();
    std::vector<OptionTable> tables = describe(options);
    const Option* choice = tables.front().find("optics");
    ASSERT_NE(choice, nullptr);
    EXPECT_THAT(choice->choices, ElementsAre("silhouette", "raytrace", "shadowgraph"));
    EXPECT_THAT(choice->meaning, HasSubstr("shadows on a screen"));
    EXPECT_EQ(tables.back().section(), "shadowgraph");
    set(tables, "", "optics", std::string("shadowgraph"));
    set(tables, "shadowgraph", "softness", 0.25);
    EXPECT_TRUE(options.optics.is("shadowgraph"));
    EXPECT_EQ(options.optics.of<Shadowgraph>().softness, 0.25);
    EXPECT_THROW(options.optics.select("wave"), OptionError);
}

TEST(AnOpticsAddedToTheList, FormsTheFramesAndSpeaksInThePlan) {
    RenderOptions options = with_shadowgraph();
    options.optics.select("shadowgraph");
    RunPlan plan;
    const Image image = frame_of(options, plan);
    EXPECT_LT(image(30, 30), 6);  // the offset
    EXPECT_GT(image(5, 5), 100);
    EXPECT_THAT(plan.text(), HasSubstr("shadows, 60 × 60 px"));
    EXPECT_THAT(plan.text(), HasSubstr("soft edges"));
    options.optics.of<Shadowgraph>().darkness = 0;
    EXPECT_GT(frame_of(options, plan)(30, 30), 100);
    options.optics.of<Shadowgraph>().softness = 0.1;
    EXPECT_THROW(frame_of(options, plan), OptionError);
}

TEST(OpticsChoice, CopiesAreTheirOwnAndAssignmentKeepsTablesBound) {
    RenderOptions one = with_shadowgraph();
    std::vector<OptionTable> tables = describe(one);
    RenderOptions two = one;
    two.optics.select("shadowgraph");
    two.optics.of<Shadowgraph>().darkness = 0.5;
    EXPECT_EQ(one.optics.of<Shadowgraph>().darkness, 1);
    one = two;
    EXPECT_TRUE(one.optics.is("shadowgraph"));
    EXPECT_EQ(one.optics.of<Shadowgraph>().darkness, 0.5);
    set(tables, "shadowgraph", "darkness", 0.75);
    EXPECT_EQ(one.optics.of<Shadowgraph>().darkness, 0.75);
    EXPECT_EQ(two.optics.of<Shadowgraph>().darkness, 0.5);
}

}  // namespace
}  // namespace grainfield::simulate
