#include "tracking/calibrate/calibration_options.h"

namespace grainfield::tracking {

OptionTable describe(CalibrationOptions& options) {
    OptionTable table("calibrate");
    table.number("disc-diameter", options.diameter, "px", {2, 2000},
                 "apparent diameter D of the disc that a sphere is in the image");
    table.also_called("diameter");
    table.number("edge-width", options.edge_width, "px", {0.05, 200}, "width w of its tanh edge");
    table.choice("polarity", options.polarity,
                 {{"auto", PolarityChoice::automatic},
                  {"dark", PolarityChoice::dark},
                  {"bright", PolarityChoice::bright}},
                 "spheres darker or brighter than the background");
    table.choice("meeting-edges", options.meeting_edges,
                 {{"auto", EdgeChoice::automatic},
                  {"product", EdgeChoice::product},
                  {"blurred-union", EdgeChoice::blurred_union}},
                 "image of edges that meet: transmissions multiply, or a lens blurs their union");
    table.choice("profile", options.profile,
                 {{"auto", ProfileChoice::automatic},
                  {"tanh", ProfileChoice::tanh},
                  {"learned", ProfileChoice::learned}},
                 "darkness across a sphere: a tanh edge, or learned where spheres stand alone");
    table.number("uniform-tolerance", options.uniform_tolerance, "-", {0, 1},
                 "variation of the background, relative to the contrast, that is ignored");
    return table;
}

}  // namespace grainfield::tracking
