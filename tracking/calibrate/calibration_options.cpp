#include "tracking/calibrate/calibration_options.h"

#include <string>
#include <utility>
#include <vector>

#include "tracking/model/known_models.h"

namespace grainfield::tracking {
namespace {

template <class Choice>
using Choices = std::vector<std::pair<std::string, Choice>>;

Choices<const OverlapRule*> rule_choices() {
    Choices<const OverlapRule*> choices{{"auto", nullptr}};
    for (const OverlapRule* rule : overlap_rules()) choices.emplace_back(rule->name(), rule);
    return choices;
}

/// Every listed shape, and learning on the first of them.
Choices<ProfileChoice> profile_choices() {
    const ProfileShape* first = profile_shapes().front();
    Choices<ProfileChoice> choices{{"auto", {first, Learning::automatic}}};
    for (const ProfileShape* shape : profile_shapes()) {
        choices.push_back({std::string(shape->name()), {shape, Learning::never}});
    }
    choices.push_back({"learned", {first, Learning::always}});
    return choices;
}

}  // namespace

OptionTable describe(CalibrationOptions& options) {
    OptionTable table("calibrate");
    table.number("disc-diameter", options.diameter, "px", {2, 2000},
                 "apparent diameter D of the disc that a sphere is in the image");
    table.also_called("diameter");
    table.number("edge-width", options.edge_width, "px", {0.05, 200}, "width w of its edge");
    table.choice("polarity", options.polarity,
                 {{"auto", PolarityChoice::automatic},
                  {"dark", PolarityChoice::dark},
                  {"bright", PolarityChoice::bright}},
                 "spheres darker or brighter than the background");
    table.choice("meeting-edges", options.meeting_edges, rule_choices(),
                 "image of edges that meet: transmissions multiply, or a lens blurs their union");
    table.choice("profile", options.profile, profile_choices(),
                 "darkness across a sphere: an edge, or learned where spheres stand alone");
    table.number("uniform-tolerance", options.uniform_tolerance, "-", {0, 1},
                 "variation of the background, relative to the contrast, that is ignored");
    return table;
}

}  // namespace grainfield::tracking
