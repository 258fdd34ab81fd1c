#include "pipelines/track/calibration_file.h"

#include <algorithm>
#include <array>
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

std::string pair_of(const std::array<double, 2>& numbers) {
    return list_of(std::vector<double>(numbers.begin(), numbers.end()));
}

tracking::FilmOptics optics_in(TomlValues& values) {
    tracking::FilmOptics film;
    film.diameter = values.number("optics.diameter", 2, 2000);
    film.height = values.number("optics.height", 1, 1e6);
    tracking::MirrorOptics& optics = film.optics;
    optics.distance = values.number("optics.camera-distance", 0, 1e9);
    optics.reflectivity = values.number("optics.reflectivity", 0, 1);
    optics.blur = values.number("optics.blur", 1e-3, 10);
    optics.ambient = values.number("optics.ambient", 0, 1);
    optics.grazing = values.number("optics.grazing", 0, 1);
    film.error.reflectivity = values.number("optics.reflectivity-std", 0, 1e3);
    film.error.blur = values.number("optics.blur-std", 0, 1e3);
    film.error.ambient = values.number("optics.ambient-std", 0, 1e3);
    film.error.grazing = values.number("optics.grazing-std", 0, 1e3);
    const auto factors = [&](const char* key, std::array<double, 2>& into) {
        const std::vector<double> numbers = values.list(key);
        if (numbers.size() != into.size()) values.refuse_value(key, "2 numbers");
        const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
        if (!(*least >= 1 && *most <= 1000)) values.refuse_value(key, "factors of 1 to 1000");
        std::copy(numbers.begin(), numbers.end(), into.begin());
    };
    factors("optics.factors-plane", film.error_scale.plane);
    factors("optics.factors-height", film.error_scale.height);
    film.error_scale.spheres = values.whole("optics.factors-spheres", 1, 1 << 30);
    return film;
}

}  // namespace

std::string text_of(const KeptCalibration& kept) {
    const tracking::ImageModel& model = kept.model;
    std::string text =
        "# All that 'grainfield track' estimated on one film; use with --calibration.\n";
    text += fmt::format("format = \"{}\"\n\n", kFormat);
    text += fmt::format("[frame]  # px\nwidth = {}\nheight = {}\n\n", kept.width, kept.height);
    text += fmt::format(
        "[spheres]  # lengths in blocks of binning x binning px\nbinning = {}\npolarity = "
        "\"{}\"\ndisc-diameter = {}\nedge-width = {}\nprofile = "
        "\"{}\"\nmeeting-edges = \"{}\"\n\n",
        model.binning.factor, model.polarity == Polarity::dark ? "dark" : "bright",
        model.disc.diameter, model.disc.edge_width, model.disc.shape->name(),
        model.overlap->name());
    text += fmt::format("[learned]  # blocks, contrast\nspacing = {}\nvalues = {}\n\n",
                        model.correction.spacing, list_of(model.correction.value));
    text += fmt::format("[light]  # counts\ncore = {}\ndegree = {}\nbackground = {}\n\n",
                        text_of_number(model.dark_level), model.background.degree(),
                        list_of(model.background.coefficients()));
    text += fmt::format(
        "[check]  # of the frame it was made on; px, and contrast of blocks\nnoise = "
        "{}\nrough-residual = {}\nresidual = "
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
    if (kept.optics) {
        const tracking::FilmOptics& film = *kept.optics;
        text += fmt::format(
            "\n[optics]  # px, a; of 'grainfield track --synthesis', with standard errors\n"
            "diameter = {}\nheight = {}\ncamera-distance = {}\nreflectivity = {}\n"
            "reflectivity-std = {}\nblur = {}\nblur-std = {}\nambient = {}\nambient-std = {}\n"
            "grazing = {}\ngrazing-std = {}\nfactors-plane = {}\nfactors-height = {}\n"
            "factors-spheres = {}\n",
            text_of_number(film.diameter), text_of_number(film.height),
            text_of_number(film.optics.distance), text_of_number(film.optics.reflectivity),
            text_of_number(film.error.reflectivity), text_of_number(film.optics.blur),
            text_of_number(film.error.blur), text_of_number(film.optics.ambient),
            text_of_number(film.error.ambient), text_of_number(film.optics.grazing),
            text_of_number(film.error.grazing), pair_of(film.error_scale.plane),
            pair_of(film.error_scale.height), film.error_scale.spheres);
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
    if (values.has("spheres.binning")) {
        model.binning.factor = values.whole("spheres.binning", 1, 32);
    }
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
                                   : tracking::BackgroundSurface(model.binning.blocks(kept.width),
                                                                 model.binning.blocks(kept.height),
                                                                 degree, std::move(coefficients));
    model.noise = values.number("check.noise", 0, largest);
    model.residual_rms = values.number("check.rough-residual", 0, largest);
    kept.check.residual = values.number("check.residual", 0, largest);
    kept.check.diameter = values.number("check.diameter", 0, 1e5);
    kept.check.low = values.number("check.low", -largest, largest);
    kept.check.high = values.number("check.high", -largest, largest);
    if (values.has("camera")) kept.camera = camera_in(values, "camera.");
    if (values.has("optics")) kept.optics = optics_in(values);
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
