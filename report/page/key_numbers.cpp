#include "report/page/key_numbers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "report/page/text.h"

namespace grainfield::report {

namespace {

const std::map<std::string, std::string>& observable_titles() {
    static const std::map<std::string, std::string> titles{
        {"q4", "Bond-orientational order"},
        {"phase", "Phases"},
        {"msd", "Displacement"},
        {"sk", "Structure factor"},
        {"s4", "Structure factor of the order"},
        {"variance", "Number variance"},
        {"fit", "Fit of S(k)"},
        {"synthetic", "Number variance of other boxes"},
        {"critical", "Critical point"},
        {"sk_order", "Structure factor of the order field"},
        {"field", "Means of the fields"},
        {"lengths", "Lengths"},
        {"series", "Time series of the run"}};
    return titles;
}

const std::map<std::string, std::string>& quantity_titles() {
    static const std::map<std::string, std::string> titles{
        {"order_mean", "Mean {}"},
        {"order_low_mode", "{} of the liquid peak"},
        {"order_high_mode", "{} of the solid peak"},
        {"order_minimum", "{} between the peaks"},
        {"particle_diameter", "Particle diameter a, unit of all lengths"},
        {"apparent_diameter", "Apparent diameter D of the discs"},
        {"edge_width", "Edge width w of the discs"},
        {"residual", "Residual of the image model (RMS, of the contrast)"},
        {"nearest_distance", "Mean distance of the nearest neighbour"},
        {"lattice_spacing", "Lattice spacing of the solid, projected"},
        {"solid_fraction", "Solid fraction"},
        {"liquid_fraction", "Liquid fraction"},
        {"averaging_time", "Averaging time of the phase"},
        {"s_lowest_k", "S at the lowest k"},
        {"s_raw_lowest_k", "S at the lowest k, raw"},
        {"s_neumann_lowest_k", "S at the lowest k, modes of a walled box"},
        {"lowest_k", "Lowest k"},
        {"s4_zero", "S₄(0)"},
        {"xi4", "Correlation length ξ₄ of the order"},
        {"s4_lowest_k", "S₄ at the lowest k"},
        {"s0_over_s1", "S₀/S₁"},
        {"s0", "S₀"},
        {"s1", "S₁"},
        {"alpha", "Exponent α"},
        {"k_pre_peak", "Wavevector of the pre-peak"},
        {"energy_xy", "Horizontal kinetic energy per grain"},
        {"energy_z", "Vertical kinetic energy per grain"},
        {"energy_rotation", "Rotational energy per grain"},
        {"energy_potential", "Potential energy per grain"},
        {"pair", "Pair collisions per grain"},
        {"low_plate", "Collisions with the low plate per grain"},
        {"high_plate", "Collisions with the high plate per grain"},
        {"wall", "Collisions with side walls per grain"},
        {"sliding", "Share of collisions that slid"},
        {"resting", "Rebounds from plates that the TC model raised to its least speed, per grain"},
        {"contact_time", "Collisions that the TC model made elastic, per grain"},
        {"work", "Energy put in by the plates, per grain and period"},
        {"loss_pair", "Energy lost between grains, per grain and period"},
        {"loss_plate", "Energy lost at plates and walls, per grain and period"},
        {"impulse_low", "Mean force of the low plate per grain"},
        {"impulse_high", "Mean force of the high plate per grain"},
        {"pressure", "Pressure"},
        {"solid_share", "Share of solid grains, |Q₄| ≥ 0.7 in a snapshot"},
        {"critical_value", "Critical value of the control parameter"},
        {"critical_low", "Critical value, lower end"},
        {"critical_high", "Critical value, upper end"},
        {"slope", "Slope of S₀/S₁"},
        {"intercept", "Intercept of S₀/S₁"},
        {"chi2_per_dof", "χ² per degree of freedom"},
        {"k_fit", "End of the fit"},
        {"s0_s1_correlation", "Correlation of the errors of S₀ and S₁"},
        {"crossover_length", "Crossover length ℓ*"},
        {"anisotropy_2", "Two-fold anisotropy of S(k)"},
        {"anisotropy_4", "Four-fold anisotropy of S(k)"},
        {"order_length", "Distance at which the order is correlated by 1/e"},
        {"order_time", "Time in which the correlation of the order falls to 1/e"},
        {"largest_cluster", "Particles in the largest solid cluster"},
        {"cluster_size", "Solid particles in the cluster of one of them, mean"},
        {"q4_fluctuation", "Standard deviation of |Q₄| of a particle in the averaging time"},
        {"cluster_lifetime", "Lifetime of solid clusters"},
        {"s0_over_s1_low", "S₀/S₁, lower end"},
        {"s0_over_s1_high", "S₀/S₁, upper end"},
        {"s0_over_s1_connected", "S₀/S₁ from plane waves"},
        {"s0_over_s1_neumann", "S₀/S₁ from modes between walls"},
        {"s0_over_s1_systematic_alpha", "S₀/S₁, systematic of α"},
        {"s0_over_s1_systematic_range", "S₀/S₁, systematic of the range"},
        {"s0_over_s1_systematic_grid", "S₀/S₁, systematic of the shells"},
        {"number_density", "Number density"},
        {"variance_per_volume", "Variance in the largest window, per volume"},
        {"order_s_lowest_k", "S of the order at the lowest k"},
        {"order_s_raw_lowest_k", "S of the order at the lowest k, raw"},
        {"order_lowest_k", "Lowest k"},
        {"order_anisotropy_2", "Two-fold anisotropy of S of the order"},
        {"order_anisotropy_4", "Four-fold anisotropy of S of the order"},
        {"order_squared", "Mean square of the order, ⟨ψ²⟩"},
        {"mean_diffusivity", "Mean diffusivity ⟨D⟩"},
        {"mean_density", "Mean density"},
        {"relative_variance_10a", "σ²/⟨N⟩ at ℓ = 10 a"},
        {"d_all", "Diffusion coefficient"},
        {"d_liquid", "Diffusion coefficient, liquid"},
        {"d_solid", "Diffusion coefficient, solid"},
        {"offset_all", "Offset of the MSD, 4σ² of the localisation"},
        {"offset_liquid", "Offset of the MSD, liquid"},
        {"offset_solid", "Offset of the MSD, solid"},
        {"exponent_all", "MSD exponent"},
        {"exponent_liquid", "MSD exponent, liquid"},
        {"exponent_solid", "MSD exponent, solid"}};
    return titles;
}

// The known title, else the name with spaces.
std::string title_of(const std::map<std::string, std::string>& titles, const std::string& name) {
    const auto known = titles.find(name);
    if (known != titles.end()) return known->second;
    std::string words = clean_text(name);
    std::ranges::replace(words, '_', ' ');
    return words;
}

// The title of a measurement; q4_mean, q6_mean … carry the symmetry in their name.
std::string quantity_of(const std::string& name, const std::string& order) {
    const std::size_t digits = name.find_first_not_of("0123456789", 1);
    if (name.starts_with("q") && digits != std::string::npos && digits > 1 && name[digits] == '_') {
        const auto known = quantity_titles().find("order" + name.substr(digits));
        if (known != quantity_titles().end())
            return fmt::format(fmt::runtime(known->second), order);
    }
    return title_of(quantity_titles(), name);
}

KeyNumber key_number(const Measurement& m) {
    KeyNumber number;
    number.note = clean_text(m.reason);
    if (!m.value || !std::isfinite(*m.value)) {
        if (number.note.empty()) number.note = "no value";
        return number;
    }
    number.value = with_error(*m.value, m.error ? &*m.error : nullptr);
    if (m.samples > 0) number.samples = count_text(m.samples);
    if (m.error && *m.error == 0 && number.note.empty()) {
        number.note = "no fluctuations: the error is not known";
    }
    return number;
}

class Table {
 public:
    explicit Table(std::size_t runs) : runs_(runs) {}

    KeyNumberRow& row(const std::string& observable, const std::string& name,
                      const std::string& order = "|Q₄|") {
        const auto found = std::ranges::find_if(rows_, [&](const KeyNumberRow& row) {
            return row.observable == observable && row.name == name;
        });
        if (found != rows_.end()) return *found;
        // Behind the last row of its observable.
        const auto last = std::find_if(rows_.rbegin(), rows_.rend(), [&](const KeyNumberRow& row) {
            return row.observable == observable;
        });
        const auto place = last == rows_.rend() ? rows_.end() : last.base();
        KeyNumberRow fresh{observable, quantity_of(name, order), name, "", {}};
        fresh.numbers.assign(runs_, {"", "", "not among the results of this run"});
        return *rows_.insert(place, std::move(fresh));
    }
    std::vector<KeyNumberRow> take() { return std::move(rows_); }

 private:
    std::size_t runs_;
    std::vector<KeyNumberRow> rows_;
};

void add_run(Table& table, const Results& run, std::size_t r) {
    const auto plain = [&](const char* quantity, double value) {
        KeyNumberRow& row = table.row("Input", quantity);
        row.numbers[r] = {count_text(value), "", ""};
    };
    plain("Frames", static_cast<double>(run.frames));
    plain("Particles per frame", run.particles_mean);
    for (const ObservableResult& observable : run.observables) {
        const std::string title = title_of(observable_titles(), observable.name);
        if (observable.measurements.empty() && !observable.reason.empty()) {
            table.row(title, "not measured").numbers[r] = {"", "", clean_text(observable.reason)};
        }
        for (const Measurement& m : observable.measurements) {
            KeyNumberRow& row = table.row(title, m.name, order_symbol(run));
            row.numbers[r] = key_number(m);
            if (row.unit.empty()) row.unit = typeset_text(m.unit, run.source.time_unit);
            const std::string unit = typeset_text(m.unit, run.source.time_unit);
            if (unit != row.unit && !row.numbers[r].value.empty()) {
                row.numbers[r].value += " " + unit;
            }
        }
    }
}

std::string value_text(const KeyNumber& number) {
    return number.value.empty() ? "–" : escape_html(number.value);
}

// Notes below the table, each once.
class Notes {
 public:
    std::string reference(const std::string& note) {
        if (note.empty()) return "";
        const auto known = std::ranges::find(notes_, note);
        const auto place = known - notes_.begin();
        if (known == notes_.end()) notes_.push_back(note);
        return fmt::format("<sup>{}</sup>", place + 1);
    }
    std::string html() const {
        if (notes_.empty()) return "";
        std::string out = "<ol class=\"notes\">\n";
        for (const std::string& note : notes_) out += "<li>" + escape_html(note) + "</li>\n";
        return out + "</ol>\n";
    }

 private:
    std::vector<std::string> notes_;
};

std::string compact_cell(const KeyNumber& number, Notes& notes) {
    std::string out = "<td>" + value_text(number) + notes.reference(number.note);
    if (!number.samples.empty()) {
        out += "<span class=\"samples\">n = " + escape_html(number.samples) + "</span>";
    }
    return out + "</td>";
}

}  // namespace

std::vector<KeyNumberRow> key_numbers(const std::vector<Results>& runs) {
    Table table(runs.size());
    for (std::size_t r = 0; r < runs.size(); ++r) add_run(table, runs[r], r);
    return table.take();
}

std::string quantity_title(const std::string& observable, const std::string& measurement) {
    return title_of(observable_titles(), observable) + ": " + quantity_of(measurement, "|Q₄|");
}

std::string key_numbers_html(const std::vector<KeyNumberRow>& rows,
                             const std::vector<std::string>& labels) {
    const bool one_run = labels.size() == 1;
    Notes notes;
    std::string out = "<div class=\"scroll\"><table class=\"numbers\"><thead><tr><th>Quantity</th>";
    if (one_run) {
        out += "<th>Value</th><th class=\"count\">Samples</th><th>Remark</th>";
    } else {
        for (const std::string& label : labels) out += "<th>" + escape_html(label) + "</th>";
    }
    out += "</tr></thead>\n<tbody>\n";
    const std::string* group = nullptr;
    for (const KeyNumberRow& row : rows) {
        if (group == nullptr || row.observable != *group) {
            group = &row.observable;
            out += fmt::format("<tr class=\"group\"><th colspan=\"{}\">{}</th></tr>\n",
                               one_run ? 4 : labels.size() + 1, escape_html(*group));
        }
        const std::string unit =
            row.unit.empty() ? "" : " <span class=\"unit\">[" + escape_html(row.unit) + "]</span>";
        out += fmt::format("<tr><th title=\"{}\">{}{}</th>", escape_html(row.name),
                           escape_html(row.quantity), unit);
        if (one_run) {
            const KeyNumber& number = row.numbers.front();
            out += fmt::format("<td>{}</td><td>{}</td><td class=\"remark\">{}</td>",
                               value_text(number), escape_html(number.samples),
                               escape_html(number.note));
        } else {
            for (const KeyNumber& number : row.numbers) out += compact_cell(number, notes);
        }
        out += "</tr>\n";
    }
    return out + "</tbody></table></div>\n" + notes.html();
}

}  // namespace grainfield::report
