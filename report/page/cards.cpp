#include "report/page/cards.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "core/fit_quality.h"
#include "core/run_identity.h"
#include "report/diffusion.h"
#include "report/figures/colours.h"
#include "report/page/definitions.h"
#include "report/possible_numbers.h"
#include "report/text.h"

namespace grainfield::report {

namespace {

constexpr std::size_t most_cards = 6;

const Measurement* known(const Results& run, const char* observable, const std::string& name) {
    const ObservableResult* result = run.find(observable);
    const Measurement* m = result == nullptr ? nullptr : result->find_measurement(name);
    return m != nullptr && m->value && std::isfinite(*m->value) ? m : nullptr;
}

std::string number(const Measurement& m) {
    return with_error(*m.value, m.error ? &*m.error : nullptr);
}

std::string with_unit(const std::string& text, const Results& run, const Measurement& m) {
    const std::string unit = typeset_text(m.unit, run.source.time_unit);
    return unit.empty() ? text : text + " " + unit;
}

bool is_of_particles(const Results& run) {
    return run.identity.role == RunRole::run && !run.identity.is_field() && run.frames > 0;
}

CardValue spheres(const Results& run, std::optional<double> /*sphere_mm*/) {
    if (!is_of_particles(run)) return {};
    return {count_text(std::round(run.particles_mean)),
            run.frames == 1
                ? "in one frame"
                : fmt::format("mean of {} frames", count_text(static_cast<double>(run.frames)))};
}

CardValue diameter(const Results& run, std::optional<double> sphere_mm) {
    if (!is_of_particles(run) || run.source.length_unit != LengthUnit::pixel) return {};
    const bool is_apparent = run.source.diameter_origin == DiameterOrigin::apparent;
    CardValue card{fmt::format("{:.4g} px", run.source.diameter), ""};
    if (sphere_mm) card.value += fmt::format(" = {:.4g} mm", *sphere_mm);
    const Measurement* seen = known(run, "lengths", "apparent_diameter");
    if (is_apparent) {
        card.detail = "apparent: as wide as the discs look; the true one was not given";
    } else if (seen != nullptr) {
        card.detail = fmt::format("given; the discs look {:.4g} px wide", *seen->value);
    } else if (run.source.diameter_origin == DiameterOrigin::given) {
        card.detail = "given";
    } else {
        card.detail = "as the file says";
    }
    if (sphere_mm) {
        card.detail += fmt::format("; 1 px is {:.3g} mm", *sphere_mm / run.source.diameter);
    }
    return card;
}

// How the frame rate came to be known: as an option of a step, or from the file.
std::string origin_of_rate(const Results& run) {
    const auto is_given = [](const RunRecord& record) {
        return std::ranges::any_of(record.configuration, [](const auto& option) {
            const bool is_rate = option.first == "fps" || option.first.ends_with(".fps");
            return is_rate && option.second != automatic && !option.second.empty();
        });
    };
    if (is_given(run.record)) return "given to analyze";
    for (const RunRecord& record : run.sources) {
        if (is_given(record)) return "given to " + record.command;
    }
    switch (run.source.origin) {
        case Origin::md:
        case Origin::rendered:
            return "of the simulation";
        case Origin::video:
            return "as the film says";
        case Origin::points:
        case Origin::field:
            break;
    }
    return "as the file says";
}

// "; vibration 80 Hz, Γ = 4.7": what is known of the plates under a film.
std::string vibration(const Results& run) {
    if (run.source.origin != Origin::video) return "";
    std::string text;
    if (run.source.vibration_frequency && run.source.time_unit == TimeUnit::second) {
        text = fmt::format("{:.6g} Hz", *run.source.vibration_frequency);
    }
    if (const auto& control = run.identity.control;
        control && control->parameter == ControlParameter::acceleration) {
        text += fmt::format("{}{} = {:.4g}", text.empty() ? "" : ", ", symbol(control->parameter),
                            control->value);
    }
    return text.empty() ? "" : "; vibration " + text;
}

CardValue frame_rate(const Results& run, std::optional<double> /*sphere_mm*/) {
    const double rate = run.source.frame_rate.value_or(0);
    const bool in_frames = run.source.time_unit == TimeUnit::frame;
    if (!is_of_particles(run) || run.frames < 2 || in_frames || rate <= 0) return {};
    const std::string time = typeset_text(Unit("time unit"), run.source.time_unit);
    // The rate is that of the camera, of which a selection takes some frames.
    const Measurement* interval = known(run, "lengths", "frame_interval");
    const double step = interval == nullptr ? 1 : std::round(*interval->value * rate);
    const std::string taken = step > 1 ? fmt::format("; one frame in {:.0f} taken", step) : "";
    return {fmt::format("{:.4g} frames/{}", rate, time),
            fmt::format("{}{}; {:.3g} {} in all{}", origin_of_rate(run), taken, length_of_film(run),
                        time, vibration(run))};
}

CardValue phases(const Results& run, std::optional<double> /*sphere_mm*/) {
    const Measurement* solid = known(run, "phase", "solid_fraction");
    const Measurement* liquid = known(run, "phase", "liquid_fraction");
    if (solid == nullptr || liquid == nullptr) return {};
    const auto share = [](double part, const std::optional<double>& error) {
        const double percent = 100 * part;
        if (!error || !(*error > 0)) return fmt::format("{:.1f} %", percent);
        const double of_error = 100 * *error;
        return with_error(percent, &of_error) + " %";
    };
    const double rest = std::max(0.0, 1 - *solid->value - *liquid->value);
    return {fmt::format("solid {}", share(*solid->value, solid->error)),
            fmt::format("liquid {}, rest {}", share(*liquid->value, liquid->error),
                        share(rest, std::nullopt))};
}

CardValue spacing(const Results& run, std::optional<double> sphere_mm) {
    const Measurement* m = known(run, "q4", "lattice_spacing");
    if (m == nullptr) return {};
    CardValue card{with_unit(number(*m), run, *m), "of the solid, seen from above"};
    if (sphere_mm) {
        card.detail += fmt::format("; {:.3g} mm", *m->value * *sphere_mm);
    } else if (run.source.length_unit == LengthUnit::pixel) {
        card.detail += fmt::format("; {:.4g} px", *m->value * run.source.diameter);
    }
    return card;
}

CardValue diffusion(const Results& run, std::optional<double> /*sphere_mm*/) {
    for (const char* phase : {"liquid", "all"}) {
        const Measurement* d = known(run, "msd", std::string("d_") + phase);
        const Measurement* e = known(run, "msd", std::string("exponent_") + phase);
        if (d == nullptr && e == nullptr) continue;
        // All spheres do not stand for a liquid that was followed.
        const DiffusionVerdict said = judge_diffusion(*run.find("msd"), phase);
        if (d == nullptr || !said.is_diffusion) return {};
        std::string detail = std::string(phase) == "all" ? "all spheres" : phase;
        if (e != nullptr) detail += fmt::format("; MSD grows as t^{:.2f}", *e->value);
        if (!said.words.empty()) detail += ", " + said.words;
        return {with_unit(number(*d), run, *d), detail};
    }
    return {};
}

CardValue at_long_waves(const Results& run, std::optional<double> /*sphere_mm*/) {
    if (const Measurement* s0 = known(run, "fit", "s0")) return {number(*s0), "S₀ of the fit"};
    return {};
}

// Without a fit. Between walls of the modes that fit there: plane waves leak.
CardValue at_lowest_k(const Results& run, std::optional<double> /*sphere_mm*/) {
    if (known(run, "fit", "s0") != nullptr) return {};
    const auto card = [&](const Measurement& s, double k, const Unit& unit, const char* modes) {
        const Measurement at{"k", unit, k, std::nullopt, 0, ""};
        return CardValue{
            number(s),
            fmt::format("k = {}{}", with_unit(fmt::format("{:.3g}", k), run, at), modes)};
    };
    const Measurement* walled = known(run, "sk", "s_neumann_lowest_k");
    const Curve* curve = walled == nullptr ? nullptr : run.find("sk")->find_curve("sk_neumann");
    const Column* of_curve = curve == nullptr ? nullptr : curve->find("k");
    if (of_curve != nullptr && !of_curve->values.empty()) {
        return card(*walled, of_curve->values.front(), of_curve->unit,
                    ", modes that fit between the walls");
    }
    const Measurement* s = known(run, "sk", "s_lowest_k");
    const Measurement* k = known(run, "sk", "lowest_k");
    if (s == nullptr || k == nullptr) return {};
    return card(*s, *k->value, k->unit, "");
}

// Of the camera [contrast]; 0: the file does not say it.
double noise_of(const Results& run) {
    const Measurement* m = known(run, "lengths", "noise");
    return m == nullptr ? 0 : *m->value;
}

CardValue residual(const Results& run, std::optional<double> /*sphere_mm*/) {
    const Measurement* m = known(run, "lengths", "residual");
    if (m == nullptr) return {};
    CardValue card{fmt::format("{:.3f}", *m->value), "of the contrast, picture less image model"};
    if (const double noise = noise_of(run); noise > 0) {
        card.detail += fmt::format("; noise {:.3f}", noise);
    }
    return card;
}

CardValue order(const Results& run, std::optional<double> /*sphere_mm*/) {
    const Measurement* m = known(run, "q4", "q4_mean");
    if (m == nullptr) return {};
    return {number(*m), "1: square lattice; 0.3: liquid"};
}

CardValue density(const Results& run, std::optional<double> /*sphere_mm*/) {
    const Measurement* m = known(run, "variance", "number_density");
    if (m == nullptr) return {};
    return {with_unit(number(*m), run, *m), "spheres an area"};
}

struct Kind {
    const char* title;
    CardValue (*value)(const Results&, std::optional<double>);
    bool instead = false;  ///< left out if the card before has a value for every run
};

// RMS misfit about the spheres, where the picture differs from the model much more elsewhere.
std::optional<double> misfit_of_spheres(const Results& run, double residual) {
    constexpr double much = 1.5;
    double squares = 0;
    double count = 0;
    for (const Preview& preview : run.previews) {
        for (const double q : preview.snapshot.quality) {
            if (!std::isfinite(q)) continue;
            squares += q * q;
            ++count;
        }
    }
    if (fit_quality(residual, noise_of(run)) != FitQuality::poor || count == 0) return std::nullopt;
    const double misfit = std::sqrt(squares / count);
    return residual > much * misfit ? std::optional(misfit) : std::nullopt;
}

// "Field, 2D, b = 4, ν = 0.01; S₀ = 0.0110 ± 0.0020"
std::string field_verdict(const Results& run) {
    std::string text = legend_of(run.identity);
    if (!text.empty()) text[0] = static_cast<char>(std::toupper(text[0]));
    if (const Measurement* s0 = known(run, "fit", "s0")) return text + "; S₀ = " + number(*s0);
    if (const Measurement* density = known(run, "field", "mean_density")) {
        return text + "; mean density " + with_unit(number(*density), run, *density);
    }
    return text;
}

}  // namespace

std::vector<Card> make_cards(const std::vector<Results>& runs, std::optional<double> sphere_mm) {
    static constexpr Kind kinds[] = {
        {"Spheres a frame", spheres},    {"Particle diameter a", diameter},
        {"Frame rate", frame_rate},      {"Phases", phases},
        {"Lattice spacing", spacing},    {"Diffusion coefficient", diffusion},
        {"S(k→0)", at_long_waves, true}, {"S at the lowest k", at_lowest_k, true},
        {"residual", residual},          {"Mean |Q₄|", order},
        {"Number density", density},
    };
    std::vector<Card> cards;
    bool is_complete = false;
    for (const Kind& kind : kinds) {
        if (cards.size() == most_cards) break;
        if (kind.instead && is_complete) continue;
        Card card{kind.title, {}};
        for (const Results& run : runs) {
            const Measurement* stored = known(run, "lengths", "sphere_mm");
            const bool is_stored = !sphere_mm && stored != nullptr;
            card.values.push_back(kind.value(run, is_stored ? stored->value : sphere_mm));
        }
        const auto has_value = [](const CardValue& v) { return !v.value.empty(); };
        is_complete = std::ranges::all_of(card.values, has_value);
        if (std::ranges::any_of(card.values, has_value)) cards.push_back(std::move(card));
    }
    return cards;
}

std::string cards_html(const std::vector<Card>& cards, const std::vector<std::string>& labels) {
    if (cards.empty()) return "";
    std::string out = "<section class=\"cards\" aria-label=\"Key numbers\">\n";
    for (const Card& card : cards) {
        std::string title = card.title;
        if (title[0] >= 'a' && title[0] <= 'z') title[0] = static_cast<char>(title[0] - 'a' + 'A');
        const std::string_view meaning = definition_of(card.title);
        out += "<div class=\"card\"><h3>" +
               (meaning.empty() ? with_definitions(title) : defined(escape_html(title), meaning)) +
               "</h3>\n";
        for (std::size_t r = 0; r < card.values.size(); ++r) {
            const CardValue& value = card.values[r];
            if (value.value.empty()) continue;
            if (labels.size() > 1) {
                out += fmt::format(
                    "<p class=\"whose\"><span class=\"block\" style=\"color:{}\"></span>{}</p>",
                    hex(distinct_colour(r, labels.size())), escape_html(labels[r]));
            }
            out += "<p class=\"value\">" + escape_html(value.value) + "</p>";
            if (!value.detail.empty()) {
                out += "<p class=\"detail\">" + escape_html(value.detail) + "</p>";
            }
            out += "\n";
        }
        out += "</div>\n";
    }
    return out + "</section>\n";
}

std::string critical_sentence(const Results& run) {
    const ObservableResult* critical = run.find("critical");
    const Curve* curve = critical == nullptr ? nullptr : critical->find_curve("critical");
    const Column* x = curve == nullptr ? nullptr : curve->find("x");
    if (x == nullptr) return "No critical point.";
    const std::string parameter = clean_text(x->meaning);
    if (const Measurement* power = known(run, "critical", "power"); power != nullptr) {
        const Measurement* limit = known(run, "critical", "constant");
        const std::string and_limit =
            limit == nullptr ? ""
                             : fmt::format(", to {} at zero", with_minus_signs(number(*limit)));
        return fmt::format("S₀/S₁ falls with {} as a power of {}{}.", parameter, number(*power),
                           and_limit);
    }
    const Measurement* value = critical->find_measurement("critical_value");
    if (value == nullptr || !value->value) {
        const std::string why = value == nullptr ? "" : clean_text(value->reason);
        return "No critical " + parameter + (why.empty() ? "." : ": " + why + ".");
    }
    std::string text =
        fmt::format("Critical at {} = {}", parameter, with_minus_signs(number(*value)));
    const Measurement* low = known(run, "critical", "critical_low");
    const Measurement* high = known(run, "critical", "critical_high");
    if (low != nullptr && high != nullptr) {
        text += "; 68 %: " + interval_text(*low->value, *high->value);
    }
    if (!value->reason.empty()) text += "; " + clean_text(value->reason);
    return text + ".";
}

std::string residual_words(double residual, double noise) {
    const auto word = [&] {
        switch (fit_quality(residual, noise)) {
            case FitQuality::good:
                return "good";
            case FitQuality::fair:
                return "fair";
            case FitQuality::poor:
                break;
        }
        return "poor";
    };
    std::string text = fmt::format("residual {:.3f}, ", residual);
    if (noise > 0) text += fmt::format("noise {:.3f}, ", noise);
    return text + word();
}

std::string verdict(const Results& run, std::optional<std::size_t> places) {
    if (run.identity.role == RunRole::critical_point) {
        std::string text = critical_sentence(run);
        text.pop_back();  // the full stop
        return text;
    }
    if (run.identity.is_field()) return field_verdict(run);
    std::string text =
        fmt::format("{} sphere{} a frame", count_text(std::round(run.particles_mean)),
                    std::round(run.particles_mean) == 1 ? "" : "s");
    const Measurement* residual = known(run, "lengths", "residual");
    if (residual != nullptr) {
        text += "; " + residual_words(*residual->value, noise_of(run));
    }
    if (places && *places > 0) {
        text += fmt::format("; {} place{} to look at", *places, *places == 1 ? "" : "s");
    } else if (places && residual != nullptr) {
        const std::optional<double> misfit = misfit_of_spheres(run, *residual->value);
        if (misfit) {
            text += fmt::format(
                "; {:.3f} about the spheres: --region or --mask leaves the rest out", *misfit);
        } else if (fit_quality(*residual->value, noise_of(run)) != FitQuality::poor) {
            text += "; no place stands out";
        }
    }
    return text;
}

std::string first_file(const Results& run) {
    const RunRecord& first = run.sources.empty() ? run.record : run.sources.front();
    if (first.inputs.empty()) return clean_text(run.source.source);
    std::string name =
        std::filesystem::path(clean_text(first.inputs.front().name)).filename().string();
    if (first.inputs.size() == 1) return name;
    return fmt::format("{} and {} more", name, first.inputs.size() - 1);
}

}  // namespace grainfield::report
