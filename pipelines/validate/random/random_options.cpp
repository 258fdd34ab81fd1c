#include "pipelines/validate/random/random_options.h"

#include "core/errors.h"

namespace grainfield::pipelines {

OptionTable describe(RandomThresholds& t) {
    OptionTable table("random-threshold");
    table.number("median-recall", t.median_recall, "-", {0, 1},
                 "least recall in the median of the scenes; auto: not checked");
    table.number("worst-recall", t.worst_recall, "-", {0, 1}, "least recall in any scene");
    table.number("median-false", t.median_false, "-", {0, 1},
                 "largest share of false spheres in the median");
    table.number("worst-false", t.worst_false, "-", {0, 1},
                 "largest share of false spheres in any scene");
    table.number("median-rmse", t.median_rmse, "a", {0, 1},
                 "largest RMS error per axis in the median");
    table.number("worst-rmse", t.worst_rmse, "a", {0, 1}, "largest RMS error per axis in any");
    table.number("median-within", t.median_within, "-", {0, 1},
                 "least share of errors within two reported standard errors, in the median");
    return table;
}

OptionTable RandomOptics::describe() {
    OptionTable table(name());
    table.integer("scenes", scenes, "-", {1, 100000}, "cameras and layers that are drawn");
    table.choice("scene-size", scene_size, {{"full", SceneSize::full}, {"small", SceneSize::small}},
                 "1,000 to 3,000 spheres a scene, or 250 to 500");
    table.number("crystals", crystals, "-", {0, 1},
                 "share of the layers that begin with a square crystal in the middle");
    table.text("keep", keep, "folder for the frames, their truth and cameras");
    return table;
}

std::unique_ptr<simulate::Optics> RandomOptics::make(double /*noise*/, int /*threads*/) const {
    throw OptionError({.problem = "random optics are one camera a scene",
                       .actual = "one camera was asked for",
                       .expected = "the optics of a scene that is drawn",
                       .suggestion = "choose the optics of one camera"});
}

}  // namespace grainfield::pipelines
