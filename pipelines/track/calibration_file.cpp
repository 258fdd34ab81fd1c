#include "pipelines/track/calibration_file.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "pipelines/detail/toml_text.h"
#include "tracking/model/known_models.h"

namespace grainfield::pipelines {

namespace {

using tracking::KeptCalibration;
using tracking::Polarity;

constexpr const char* kFormat = "grainfield calibration 1";
constexpr int kHighestDegree = 10;

/// TOML has no negative zero without a point.
template <class Number>
std::string text_of_number(Number value) {
    return value == 0 && std::signbit(value) ? "-0.0" : fmt::format("{}", value);
}

template <class Number>
std::string list_of(const std::vector<Number>& values) {
    std::string text = "[";
    for (const Number value : values) text += (text.size() > 1 ? ", " : "") + text_of_number(value);
    return text + "]";
}

/// The values of a file, each to be asked for once by "section.key".
class Values {
 public:
    explicit Values(const std::filesystem::path& path) : file_(path.string()) {
        std::ifstream in;
        if (std::filesystem::is_regular_file(path)) in.open(path, std::ios::binary);
        if (!in.is_open()) {
            refuse("cannot be read as a calibration", "", "a file of --save-calibration");
        }
        const std::string text{std::istreambuf_iterator<char>(in),
                               std::istreambuf_iterator<char>()};
        try {
            root_ = parsed_toml(text);
        } catch (const toml::parse_error& error) {
            refuse(fmt::format("line {}: not valid TOML", error.source().begin.line),
                   std::string(error.description()), "a file of --save-calibration");
        }
    }

    double number(const std::string& key, double low, double high) {
        const auto value = node(key).value<double>();
        if (!value || !(*value >= low && *value <= high)) {
            refuse_value(key, fmt::format("a number from {} to {}", low, high));
        }
        return *value;
    }

    int whole(const std::string& key, int low, int high) {
        const auto value = node(key).value_exact<std::int64_t>();
        if (!value || *value < low || *value > high) {
            refuse_value(key, fmt::format("a whole number from {} to {}", low, high));
        }
        return static_cast<int>(*value);
    }

    std::vector<double> list(const std::string& key) {
        std::vector<double> values;
        const toml::node_view<const toml::node> found = node(key);
        const toml::array* array = found.as_array();
        if (array == nullptr) refuse_value(key, "a list of numbers");
        for (const toml::node& element : *array) {
            const auto value = element.value<double>();
            if (!value || !std::isfinite(*value)) refuse_value(key, "a list of numbers");
            values.push_back(*value);
        }
        return values;
    }

    template <class Choice>
    Choice choice(const std::string& key, const std::map<std::string, Choice>& choices) {
        const auto value = node(key).value<std::string>();
        const auto found = value ? choices.find(*value) : choices.end();
        if (found == choices.end()) {
            std::string names;
            for (const auto& [name, meaning] : choices) names += (names.empty() ? "" : ", ") + name;
            refuse_value(key, "one of " + names);
        }
        return found->second;
    }

    void require_no_others() const {
        for (const auto& [section, part] : root_) {
            const std::string name(section.str());
            const toml::table* table = part.as_table();
            if (table == nullptr) {
                if (!asked_.contains(name)) refuse(fmt::format("unknown key '{}'", name), "", "");
                continue;
            }
            for (const auto& [key, value] : *table) {
                const std::string whole_name = name + "." + std::string(key.str());
                if (!asked_.contains(whole_name)) {
                    refuse(fmt::format("unknown key '{}'", whole_name), "", "");
                }
            }
        }
    }

    [[noreturn]] void refuse_value(const std::string& key, std::string expected) const {
        refuse(fmt::format("key '{}' is missing or wrong", key), "", std::move(expected));
    }

 private:
    toml::node_view<const toml::node> node(const std::string& key) {
        asked_.insert(key);
        return std::as_const(root_).at_path(key);
    }

    [[noreturn]] void refuse(const std::string& problem, std::string actual,
                             std::string expected) const {
        throw InputError({.problem = fmt::format("'{}': {}", file_, problem),
                          .actual = std::move(actual),
                          .expected = std::move(expected),
                          .suggestion = "save the calibration again"});
    }

    std::string file_;
    toml::table root_;
    std::set<std::string> asked_;
};

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
    return text;
}

KeptCalibration read_calibration(const std::filesystem::path& path) {
    constexpr double largest = 1e12;
    Values values(path);
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
    values.require_no_others();
    return kept;
}

}  // namespace grainfield::pipelines
