#include "tracking/synthesis/general_correction.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "tracking/locate.h"
#include "tracking/synthesis/bias_terms.h"
#include "tracking/synthesis/corrected_positions.h"
#include "tracking/synthesis/general_correction_text.h"
#include "tracking/synthesis/rendered_part.h"

namespace grainfield::tracking {
namespace {

constexpr double kMeanWidth = 0.11, kSpreadOfWidth = 0.025;         // [a]
constexpr double kMeanDiameter = 0.875, kSpreadOfDiameter = 0.025;  // [a]
/// Of the range learned from, beyond either end of it.
constexpr double kBeyond = 0.1;
constexpr double kPart = 40;   // [a]
constexpr double kMargin = 2;  // [a]
/// Less is not told from none [contrast].
constexpr double kLeastMisfit = 1e-3;

bool is_beyond(double value, double least, double most) {
    const double margin = kBeyond * (most - least);
    return value < least - margin || value > most + margin;
}

/// The next numbers of a line that begins with `name`.
std::vector<double> numbers_after(std::istream& text, const std::string& name) {
    std::string line;
    do {
        if (!std::getline(text, line)) throw std::invalid_argument("no line '" + name + "'");
    } while (line.empty() || line.front() == '#');
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::string first;
    words >> first;
    if (first != name) {
        throw std::invalid_argument(fmt::format("'{}' stands where '{}' should", first, name));
    }
    std::vector<double> numbers;
    for (double number = 0; words >> number;) numbers.push_back(number);
    if (!words.eof()) throw std::invalid_argument(fmt::format("no number in '{}'", line));
    return numbers;
}

std::vector<double> numbers_after(std::istream& text, const std::string& name, std::size_t count) {
    std::vector<double> numbers = numbers_after(text, name);
    if (numbers.size() != count) {
        throw std::invalid_argument(
            fmt::format("'{}' has {} numbers, {} are needed", name, numbers.size(), count));
    }
    return numbers;
}

PatternKind kind_after(std::istream& text, const std::string& name) {
    constexpr std::size_t n = ResidualPattern::kNumbers;
    PatternKind kind;
    kind.mean = numbers_after(text, name, n);
    kind.weights = numbers_after(text, name + "-weights", n * n);
    kind.log_determinant = numbers_after(text, name + "-log-determinant", 1)[0];
    return kind;
}

std::string text_of(const std::string& name, const PatternKind& kind) {
    std::string text = name;
    for (const double number : kind.mean) text += fmt::format(" {:.5g}", number);
    text += "\n" + name + "-weights";
    for (const double weight : kind.weights) text += fmt::format(" {:.6g}", weight);
    return text + fmt::format("\n{}-log-determinant {:.5g}\n", name, kind.log_determinant);
}

}  // namespace

void ResidualPattern::add(const BiasTerms::Terms& terms) {
    constexpr auto kFirst = static_cast<std::size_t>(BiasTerms::kDistances);  // of the moments
    for (std::size_t ring = 0; ring < kRings; ++ring) {
        const auto x = static_cast<double>(terms.x[kFirst + ring]);
        const auto y = static_cast<double>(terms.y[kFirst + ring]);
        squares_[ring] += x * x + y * y;
        if (ring + 1 == kRings) continue;
        products_[ring] += x * static_cast<double>(terms.x[kFirst + ring + 1]) +
                           y * static_cast<double>(terms.y[kFirst + ring + 1]);
    }
}

ResidualPattern::Numbers ResidualPattern::numbers(double misfit) const {
    Numbers numbers{};
    double mean = 0;
    for (const double s : squares_) mean += s / kRings;
    for (std::size_t ring = 0; ring < kRings; ++ring) {
        if (ring + 1 < kRings) {
            numbers[ring] = products_[ring] / std::sqrt(squares_[ring] * squares_[ring + 1]);
        }
        numbers[kRings - 1 + ring] = 0.5 * std::log(squares_[ring] / mean);
    }
    numbers[kNumbers - 1] = std::log(misfit);
    return numbers;
}

double PatternKind::squared_distance(const ResidualPattern::Numbers& numbers) const {
    constexpr std::size_t n = ResidualPattern::kNumbers;
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            sum += (numbers[i] - mean[i]) * weights[i * n + j] * (numbers[j] - mean[j]);
        }
    }
    return sum;
}

double GeneralCorrection::unlikeness(const ResidualPattern::Numbers& numbers) const {
    return std::sqrt(mirrors.squared_distance(numbers) /
                     static_cast<double>(ResidualPattern::kNumbers));
}

double GeneralCorrection::log_odds(const ResidualPattern::Numbers& numbers) const {
    return 0.5 * (rims.squared_distance(numbers) + rims.log_determinant -
                  mirrors.squared_distance(numbers) - mirrors.log_determinant);
}

std::array<double, GeneralCorrection::kFilmTerms> GeneralCorrection::film_terms(
    double edge_width, double apparent_diameter) {
    return {1, (edge_width - kMeanWidth) / kSpreadOfWidth,
            (apparent_diameter - kMeanDiameter) / kSpreadOfDiameter};
}

std::string GeneralCorrection::refused(const DiscProfile& disc, double diameter) const {
    const double width = disc.edge_width / diameter;
    const double apparent = disc.diameter / diameter;
    if (is_beyond(width, least_width, most_width)) {
        return fmt::format(
            "edges are {:.3f} a wide, those of the cameras that it was learned from {:.3f} to "
            "{:.3f} a",
            width, least_width, most_width);
    }
    if (is_beyond(apparent, least_diameter, most_diameter)) {
        return fmt::format(
            "discs are {:.3f} a wide, those of the cameras that it was learned from {:.3f} to "
            "{:.3f} a{}",
            apparent, least_diameter, most_diameter,
            apparent > most_diameter
                ? "; if spheres mirror their neighbours, is track.sphere-diameter too small?"
                : "");
    }
    return {};
}

BiasCorrection GeneralCorrection::of(const DiscProfile& disc, double diameter) const {
    const auto film = film_terms(disc.edge_width / diameter, disc.diameter / diameter);
    BiasCorrection correction;
    correction.diameter = diameter;
    correction.shares = shares;
    correction.doubt = doubt;
    correction.before = before;
    correction.after = after;
    for (const auto& weight : weights) {
        double sum = 0;
        for (std::size_t k = 0; k < kFilmTerms; ++k) sum += weight[k] * film[k];
        correction.weights.push_back(sum);
    }
    return correction;
}

const GeneralCorrection& general_correction() {
    static const GeneralCorrection kept = read_general_correction(general_correction_text);
    return kept;
}

GeneralCorrection read_general_correction(std::string_view text) {
    std::istringstream lines{std::string(text)};
    GeneralCorrection general;
    const auto learned_from = numbers_after(lines, "learned-from", 2);
    general.cameras = static_cast<int>(learned_from[0]);
    general.spheres = static_cast<int>(learned_from[1]);
    const auto errors = numbers_after(lines, "errors", 2);
    general.before = errors[0];
    general.after = errors[1];
    const auto widths = numbers_after(lines, "widths", 2);
    general.least_width = widths[0];
    general.most_width = widths[1];
    const auto diameters = numbers_after(lines, "diameters", 2);
    general.least_diameter = diameters[0];
    general.most_diameter = diameters[1];
    general.shares = numbers_after(lines, "shares", kOverlapClasses);
    general.doubt = numbers_after(lines, "doubt", 1)[0];
    general.mirrors = kind_after(lines, "mirrors");
    general.rims = kind_after(lines, "rims");
    for (int k = 0; k < BiasTerms::kCount; ++k) {
        const auto weight = numbers_after(lines, "weight", GeneralCorrection::kFilmTerms);
        general.weights.push_back({weight[0], weight[1], weight[2]});
    }
    return general;
}

std::string write_general_correction(const GeneralCorrection& general) {
    std::string text =
        "# How discs err on mirror-like spheres (tracking/synthesis/general_correction.h).\n"
        "# Written by bench.tracking.learn_general_correction; not to be changed by hand.\n"
        "# cameras, spheres\n";
    text += fmt::format("learned-from {} {}\n", general.cameras, general.spheres);
    text += "# RMS error per axis of discs and corrected, cameras left out, median of them [a]\n";
    text += fmt::format("errors {:.5f} {:.5f}\n", general.before, general.after);
    text += "# of the cameras learned from [a]\n";
    text += fmt::format("widths {:.4f} {:.4f}\n", general.least_width, general.most_width);
    text += fmt::format("diameters {:.4f} {:.4f}\n", general.least_diameter, general.most_diameter);
    text += "# of a standard error that remain, by class of overlap\nshares";
    for (const double share : general.shares) text += fmt::format(" {:.4f}", share);
    text += "\n# standard error of a correction, as a share of it\n";
    text += fmt::format("doubt {:.4f}", general.doubt);
    text += "\n# patterns of the residual: mean, inverse covariance, ln of its determinant\n";
    text += text_of("mirrors", general.mirrors) + text_of("rims", general.rims);
    text += "# of each term, times 1, edge width and diameter about their means [a]\n";
    for (const auto& [one, width, diameter] : general.weights) {
        text += fmt::format("weight {:.4g} {:.4g} {:.4g}\n", one, width, diameter);
    }
    return text;
}

CorrectionJudgement judge_correction(const GeneralCorrection& general, const Image& counts,
                                     const ImageModel& model, const DetectionOptions& detection,
                                     const RefinementOptions& refinement, double diameter,
                                     int threads) {
    const auto side = [&](int whole) {
        return std::min(whole, static_cast<int>(std::ceil(kPart * diameter)));
    };
    const int width = side(counts.width());
    const int height = side(counts.height());
    const int x0 = (counts.width() - width) / 2;
    const int y0 = (counts.height() - height) / 2;
    Image darkness(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            darkness(x, y) = model.darkness_of(x0 + x, y0 + y)(counts(x0 + x, y0 + y));
        }
    }
    Locator locator(width, height, model, threads);
    locator.expect_misfit(model.residual_rms);
    DetectionOptions once = detection;
    once.cores = CoreSearch::never;
    const Located found = locator.locate(darkness, once, refinement);
    const Image residual = locator.residual();
    const std::vector<Vec2> errors = standard_errors(found);
    const BiasCorrector corrector(general.of(model.disc, diameter), darkness, residual,
                                  found.fitted, diameter);
    ResidualPattern pattern;
    CorrectionJudgement judgement;
    double moved = 0;
    double expected = 0;
    for (std::size_t i = 0; i < found.position.size(); ++i) {
        const Vec2 p = found.position[i];
        const double inside = std::min({p.x, p.y, width - 1 - p.x, height - 1 - p.y});
        if (inside < kMargin * diameter || !std::isfinite(squared_norm(errors[i]))) continue;
        ++judgement.spheres;
        pattern.add(corrector.terms().of(p));
        moved += squared_norm(corrector.corrected(p) - p);
        expected += squared_norm(errors[i]);
    }
    if (judgement.spheres == 0) return judgement;
    judgement.moved = std::sqrt(moved / (2 * judgement.spheres)) / diameter;
    judgement.expected = std::sqrt(expected / (2 * judgement.spheres)) / diameter;
    const double misfit = found.residual_rms * found.residual_rms - found.noise * found.noise;
    judgement.pattern = pattern.numbers(std::sqrt(std::max(misfit, kLeastMisfit * kLeastMisfit)));
    judgement.unlikeness = general.unlikeness(judgement.pattern);
    judgement.log_odds = general.log_odds(judgement.pattern);
    return judgement;
}

}  // namespace grainfield::tracking
