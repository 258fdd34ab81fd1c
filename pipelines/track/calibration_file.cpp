#include "pipelines/track/calibration_file.h"

#include <map>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pipelines/camera/camera_file.h"
#include "pipelines/detail/toml_values.h"
#include "tracking/model/known_models.h"
#include "tracking/synthesis/bias_terms.h"

namespace grainfield::pipelines {

namespace {

using tracking::KeptCalibration;
using tracking::Polarity;

constexpr const char* kFormat = "grainfield calibration 1";
constexpr int kHighestDegree = 10;

template <class Part>
std::map<std::string, const Part*> by_name(std::span<const Part* const> parts) {
    std::map<std::string, const Part*> names;
    for (const Part* part : parts) names.emplace(part->name(), part);
    return names;
}

}  // namespace

std::string text_of(const KeptCalibration& kept) {
    const tracking::ImageModel& model = kept.model;
    std::string text =
        "# All that 'grainfield track' estimated on one film; use with --calibration.\n";
    text += fmt::format("format = \"{}\"\n\n", kFormat);
    text += fmt::format("[frame]  # px\nwidth = {}\nheight = {}\n\n", kept.width, kept.height);
    text += fmt::format(
        "[spheres]  # px\npolarity = \"{}\"\ndisc-diameter = {}\nedge-width = {}\nprofile = "
        "\"{}\"\nmeeting-edges = \"{}\"\n\n",
        model.polarity == Polarity::dark ? "dark" : "bright", model.disc.diameter,
        model.disc.edge_width, model.disc.shape->name(), model.overlap->name());
    text += fmt::format("[learned]  # px, contrast\nspacing = {}\nvalues = {}\n\n",
                        model.correction.spacing, list_of(model.correction.value));
    text += fmt::format("[light]  # counts\ncore = {}\ndegree = {}\nbackground = {}\n\n",
                        text_of_number(model.dark_level), model.background.degree(),
                        list_of(model.background.coefficients()));
    text += fmt::format(
        "[check]  # of the frame it was made on\nnoise = {}\nrough-residual = {}\nresidual = "
        "{}\ndiameter = {}\nlow = {}\nhigh = {}\n",
        model.noise, model.residual_rms, kept.check.residual, kept.check.diameter,
        text_of_number(kept.check.low), text_of_number(kept.check.high));
    if (kept.bias) {
        const tracking::BiasCorrection& bias = *kept.bias;
        text += fmt::format(
            "\n[bias]  # px, a, contrast; of 'grainfield track --correct-bias'\ndiameter = {}\n"
            "height = {}\ncamera-distance = {}\nbefore = {}\nafter = {}\nquality = {}\nremaining "
            "= {}\nweights = {}\n",
            text_of_number(bias.diameter), text_of_number(bias.height),
            text_of_number(bias.camera_distance), text_of_number(bias.before),
            text_of_number(bias.after), list_of(bias.quality), list_of(bias.remaining),
            list_of(bias.weights));
    }
    if (kept.camera) {
        text += "\n# Lens and tilt, of 'grainfield calibrate-camera'.\n" +
                text_of(*kept.camera, "camera.");
    }
    return text;
}

KeptCalibration read_calibration(const std::filesystem::path& path) {
    constexpr double largest = 1e12;
    TomlValues values(path, "calibration", "a file of --save-calibration",
                      "save the calibration again");
    values.choice<int>("format", {{kFormat, 1}});
    KeptCalibration kept;
    kept.width = values.whole("frame.width", 1, 1 << 24);
    kept.height = values.whole("frame.height", 1, 1 << 24);
    tracking::ImageModel& model = kept.model;
    model.polarity = values.choice<Polarity>(
        "spheres.polarity", {{"dark", Polarity::dark}, {"bright", Polarity::bright}});
    model.disc.diameter = values.number("spheres.disc-diameter", 1, 1e5);
    model.disc.edge_width = values.number("spheres.edge-width", 1e-3, 1e5);
    model.disc.shape = values.choice("spheres.profile", by_name(tracking::profile_shapes()));
    model.overlap = values.choice("spheres.meeting-edges", by_name(tracking::overlap_rules()));
    model.correction.spacing = values.number("learned.spacing", 0, 1e5);
    for (const double v : values.list("learned.values")) {
        model.correction.value.push_back(static_cast<float>(v));
    }
    if (!model.correction.is_zero() && model.correction.spacing <= 0) {
        values.refuse_value("learned.spacing", "a distance above zero");
    }
    model.dark_level = values.number("light.core", -largest, largest);
    const int degree = values.whole("light.degree", 0, kHighestDegree);
    std::vector<double> coefficients = values.list("light.background");
    const int terms = tracking::BackgroundSurface::terms_of(degree);
    if (static_cast<int>(coefficients.size()) != terms) {
        values.refuse_value("light.background", fmt::format("{} coefficients", terms));
    }
    model.background = degree == 0 ? tracking::BackgroundSurface(coefficients.front())
                                   : tracking::BackgroundSurface(kept.width, kept.height, degree,
                                                                 std::move(coefficients));
    model.noise = values.number("check.noise", 0, largest);
    model.residual_rms = values.number("check.rough-residual", 0, largest);
    kept.check.residual = values.number("check.residual", 0, largest);
    kept.check.diameter = values.number("check.diameter", 0, 1e5);
    kept.check.low = values.number("check.low", -largest, largest);
    kept.check.high = values.number("check.high", -largest, largest);
    if (values.has("camera")) kept.camera = camera_in(values, "camera.");
    if (values.has("bias")) {
        tracking::BiasCorrection& bias = kept.bias.emplace();
        bias.diameter = values.number("bias.diameter", 2, 2000);
        bias.height = values.number("bias.height", 1, 1e6);
        bias.camera_distance = values.number("bias.camera-distance", 0, 1e9);
        bias.before = values.number("bias.before", 0, 1);
        bias.after = values.number("bias.after", 0, 1);
        const auto list = [&](const char* key, int length) {
            std::vector<double> numbers = values.list(key);
            if (static_cast<int>(numbers.size()) != length) {
                values.refuse_value(key, fmt::format("{} numbers", length));
            }
            return numbers;
        };
        bias.quality = list("bias.quality", tracking::kQualityClasses - 1);
        bias.remaining =
            list("bias.remaining", tracking::kQualityClasses * tracking::kOverlapClasses);
        bias.weights = list("bias.weights", tracking::BiasTerms::kCount);
    }
    values.require_no_others();
    return kept;
}

}  // namespace grainfield::pipelines
