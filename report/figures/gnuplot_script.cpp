#include "report/figures/gnuplot_script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "report/text.h"

namespace grainfield::report {

namespace {

constexpr std::array<int, 4> point_types{7, 5, 13, 9};  // filled circle, square, diamond, triangle

std::array<double, 2> padded(const std::array<double, 2>& range, const Axis& axis) {
    auto [low, high] = range;
    if (axis.scale == Scale::log) {
        if (!(low > 0)) return {0.1, 1};
        const double factor = std::max(1.05, std::pow(high / low, 0.04));
        return {low / factor, high * factor};
    }
    const double margin = high > low ? 0.04 * (high - low) : 0.5;
    return {axis.from_zero && low >= 0 ? 0 : low - margin, high + margin};
}

// Decades, with 2 and 5 between them where the axis spans few.
std::string log_ticks(const std::array<double, 2>& range) {
    const int first = static_cast<int>(std::floor(std::log10(range[0])));
    const int last = static_cast<int>(std::ceil(std::log10(range[1])));
    const double decades = std::log10(range[1] / range[0]);
    const int every = std::max(1, (last - first) / 8);
    std::string ticks;
    const auto add = [&](double value, const std::string& label) {
        if (value < range[0] * (1 - 1e-9) || value > range[1] * (1 + 1e-9)) return;
        ticks +=
            fmt::format("{}{} {:.9g}", ticks.empty() ? "" : ", ", gnuplot_string(label), value);
    };
    for (int e = first; e <= last; ++e) {
        const double decade = std::pow(10.0, e);
        const bool plain = e >= -2 && e <= 3;
        const auto label = [&](int digit) {
            return plain ? fmt::format("{:g}", digit * decade)
                         : (digit == 1 ? "" : fmt::format("{} × ", digit)) + power_of_ten(e);
        };
        if ((e - first) % every == 0) add(decade, label(1));
        if (decades > 2) continue;
        for (int digit : {2, 5}) add(digit * decade, label(digit));
    }
    return "(" + ticks + ")";
}

// Of a linear axis, few enough that their labels stay apart in a picture of one column.
double tick_step(const std::array<double, 2>& range) {
    constexpr double most = 6;
    const double least = (range[1] - range[0]) / most;
    const double decade = std::pow(10.0, std::floor(std::log10(least)));
    for (const double digit : {1.0, 2.0, 5.0}) {
        if (digit * decade >= least) return digit * decade;
    }
    return 10 * decade;
}

std::string axis_commands(const char* which, const Axis& axis, const std::array<double, 2>& range) {
    std::string out = fmt::format("set {0}label {1} noenhanced\nset {0}range [{2:.9g}:{3:.9g}]\n",
                                  which, gnuplot_string(axis.title()), range[0], range[1]);
    if (which[0] == 'x') out += "set xlabel offset 0,0.4\n";
    if (axis.scale == Scale::log) {
        out += fmt::format("set logscale {0}\nset {0}tics {1}\n", which, log_ticks(range));
    }
    return out;
}

// x, y and the ends of the error bar; a bar that would reach zero on a logarithmic axis ends far
// below the picture.
std::string data_block(const Figure& figure, const Series& series, std::size_t number) {
    std::string out = fmt::format("$data{} << GRAINFIELD_END\n", number);
    const bool is_log = figure.y.scale == Scale::log;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        if (is_log && !(series.y[i] > 0)) continue;
        const double known = series.error.empty() ? 0 : series.error[i];
        const double error = std::isfinite(known) ? known : 0;
        const double low =
            is_log ? std::max(series.y[i] - error, series.y[i] * 1e-6) : series.y[i] - error;
        fmt::format_to(std::back_inserter(out), "{:.6g} {:.6g} {:.6g} {:.6g}\n", series.x[i],
                       series.y[i], low, series.y[i] + error);
    }
    out += "GRAINFIELD_END\n";
    const std::vector<std::size_t> open = points_without_error(figure, series);
    if (open.empty()) return out;
    fmt::format_to(std::back_inserter(out), "$open{} << GRAINFIELD_END\n", number);
    for (const std::size_t i : open) {
        if (is_log && !(series.y[i] > 0)) continue;
        fmt::format_to(std::back_inserter(out), "{:.6g} {:.6g}\n", series.x[i], series.y[i]);
    }
    return out + "GRAINFIELD_END\n";
}

// Whether runs and kinds get entries of their own in the key, as on the page: an entry for each
// pair would fill the picture.
bool has_split_key(const Figure& figure) {
    const auto shown = std::ranges::count_if(
        figure.kinds, [](const Kind& k) { return k.mark == Mark::line && k.shown; });
    return figure.runs.size() > 1 && shown > 1;
}

std::string title_clause(const std::string& title) {
    return title.empty() ? "notitle" : "title " + gnuplot_string(title) + " noenhanced";
}

constexpr double point_size(bool crowded) {
    return crowded ? 0.3 : 0.6;
}

std::string line_clause(const Kind& kind, const Style& style, bool crowded) {
    return fmt::format("with {} lc rgb '{}' dt {} lw {} pt {} ps {}",
                       kind.is_joined ? "linespoints" : "points", hex(style.colour), style.dash + 1,
                       crowded ? 0.6 : 1.2, point_types[style.symbol], point_size(crowded));
}

std::string plot_clause(const Figure& figure, const Series& series, std::size_t number,
                        const std::string& label) {
    const Kind& kind = figure.kinds[series.kind];
    const Style style = style_of(figure, series.run, series.kind);
    const std::string title = title_clause(label);
    const std::string line = fmt::format("lc rgb '{}' dt {}", hex(style.colour), style.dash + 1);
    const std::string data = fmt::format("$data{} using 1:2", number);
    if (kind.mark == Mark::guide) return data + " with lines " + line + " lw 1.2 " + title;
    if (kind.mark == Mark::curve) return data + " with lines " + line + " lw 2 " + title;
    // Plain strokes: gnuplot's own error bars wipe out what lies under their points.
    std::string bars;
    if (!series.error.empty()) {
        bars = fmt::format(
            "$data{} using 1:3:(0):($4-$3) with vectors nohead lc rgb '{}' lw 0.8 notitle, ",
            number, hex(style.colour));
    }
    if (kind.mark == Mark::steps) return bars + data + " with histeps " + line + " lw 2 " + title;
    const bool crowded = series.x.size() > 120;
    std::string points = bars + data + " " + line_clause(kind, style, crowded) + " " + title;
    if (!points_without_error(figure, series).empty()) {
        // White within the symbol leaves its rim.
        points +=
            fmt::format(", $open{} using 1:2 with points lc rgb '#ffffff' pt {} ps {} notitle",
                        number, point_types[style.symbol], 0.55 * point_size(crowded));
    }
    return points;
}

// Fits in print: lines through the points of their run, as which they need no name.
enum class Fits { named, unnamed };

bool is_named(const Figure& figure, const Kind& kind, Fits fits) {
    return fits == Fits::named || kind.mark != Mark::curve || figure.runs.size() == 1;
}

// The shown series and, for a split key, one entry without data for each kind.
std::string plot_clauses(const Figure& figure, Fits fits = Fits::named) {
    const bool split = has_split_key(figure);
    std::vector<bool> named(figure.runs.size(), false);
    std::string out;
    const auto add = [&](const std::string& clause) {
        out += (out.empty() ? "plot " : ", \\\n  ") + clause;
    };
    for (std::size_t s = 0; s < figure.series.size(); ++s) {
        const Series& series = figure.series[s];
        const Kind& kind = figure.kinds[series.kind];
        if (!kind.shown) continue;
        std::string label = series_label(figure, series);
        if (split && kind.mark != Mark::guide) {
            label = named[series.run] ? "" : figure.runs[series.run];
            named[series.run] = true;
        } else if (!is_named(figure, kind, fits)) {
            label.clear();
        } else if (fits == Fits::unnamed && figure.runs.size() > 1 && kind.mark == Mark::line) {
            label = figure.runs[series.run];
        }
        add(plot_clause(figure, series, s, label));
    }
    for (std::size_t k = 0; split && k < figure.kinds.size(); ++k) {
        const Kind& kind = figure.kinds[k];
        if (!kind.shown || kind.mark == Mark::guide || !is_named(figure, kind, fits)) continue;
        Style style = style_of(figure, 0, k);
        style.colour = {0x33, 0x33, 0x33};
        // The symbols of lines are those of their runs, which have entries of their own.
        const std::string look = kind.is_joined ? fmt::format("with lines lc rgb '{}' dt {} lw 1.2",
                                                              hex(style.colour), style.dash + 1)
                                                : line_clause(kind, style, false);
        add("NaN " + look + " " + title_clause(kind.label));
    }
    return out + "\n";
}

std::size_t key_entries(const Figure& figure) {
    std::size_t series = 0;
    for (const Series& s : figure.series) series += figure.kinds[s.kind].shown;
    return has_split_key(figure) ? figure.runs.size() + figure.kinds.size() : series;
}

// Of the key of these clauses.
std::size_t entries_in(std::string_view clauses) {
    std::size_t entries = 0;
    constexpr std::string_view entry = " title '";
    for (auto at = clauses.find(entry); at != std::string_view::npos;
         at = clauses.find(entry, at + entry.size())) {
        ++entries;
    }
    return entries;
}

}  // namespace

std::string gnuplot_string(std::string_view text) {
    std::string out = "'";
    for (char c : clean_text(text)) {
        out += c == '\'' || c == '`' ? "’" : std::string(1, c);
    }
    return out + "'";
}

std::string publication_script(const Figure& figure, const std::string& file, PlotForm form) {
    constexpr double width = 8.6;  // [cm]
    constexpr double inch = 2.54;  // [cm]
    const std::string clauses = plot_clauses(figure, Fits::unnamed);
    const std::size_t entries = entries_in(clauses);
    const std::size_t key_rows = (entries + 2) / 3;
    const double height = 6.2 + 0.4 * static_cast<double>(key_rows);  // [cm]
    std::string out = "reset\nset encoding utf8\nset minussign\n";
    switch (form) {
        case PlotForm::svg:
            out += fmt::format(
                "set terminal svg size {:.0f},{:.0f} noenhanced font 'sans-serif,11' background "
                "'#ffffff'\n",
                width / inch * 96, height / inch * 96);
            break;
        case PlotForm::pdf:
            out +=
                fmt::format("set terminal pdfcairo size {}cm,{}cm noenhanced font 'sans-serif,8'\n",
                            width, height);
            break;
        case PlotForm::png:
            // The SVG at 600 dpi: this terminal has points of 96 dpi, and smaller marks.
            out += fmt::format(
                "set terminal pngcairo size {:.0f},{:.0f} noenhanced font 'sans-serif,8.25' "
                "fontscale 6.25 linewidth 6.25 pointscale 8.3 dashlength 0.6\n",
                width / inch * 600, height / inch * 600);
            break;
    }
    out += fmt::format("set output {}\n", gnuplot_string(file));
    out +=
        "set border 15 lc rgb '#000000'\nset xtics in mirror\nset ytics in mirror\n"
        "set key outside below center horizontal maxcols 3 samplen 2 height 1 noenhanced\n";
    if (entries < 2) out += "set key off\n";
    const auto add_axis = [&](const char* which, const Axis& axis, auto values) {
        const auto range = padded(extent(figure, axis, values), axis);
        out += axis_commands(which, axis, range);
        if (axis.scale == Scale::linear) {
            out += fmt::format("set {}tics {:.9g}\n", which, tick_step(range));
        }
    };
    add_axis("x", figure.x, &Series::x);
    add_axis("y", figure.y, &Series::y);
    for (std::size_t i = 0; i < figure.series.size(); ++i) {
        if (figure.kinds[figure.series[i].kind].shown) {
            out += data_block(figure, figure.series[i], i);
        }
    }
    return out + clauses + "unset output\n";
}

std::string gnuplot_script(const Figure& figure, const std::string& svg, const std::string& pdf) {
    const std::size_t entries = key_entries(figure);
    const std::size_t key_rows = (entries + 2) / 3;
    std::string out = fmt::format(
        "reset\nset encoding utf8\nset minussign\n"
        "set terminal svg size 720,{} noenhanced font 'sans-serif,15' background '#ffffff'\n"
        "set output {}\n"
        "set border 3 lc rgb '#444444'\nset tics nomirror out\nset grid lt 1 lc rgb '#e4e4e4' lw "
        "0.6\n"
        "set key outside below center horizontal maxcols 3 noenhanced\n",
        480 + 20 * key_rows, gnuplot_string(svg));
    const auto x = padded(extent(figure, figure.x, &Series::x), figure.x);
    const auto y = padded(extent(figure, figure.y, &Series::y), figure.y);
    if (entries == 1) out += "set key off\n";
    out += axis_commands("x", figure.x, x) + axis_commands("y", figure.y, y);
    for (std::size_t s = 0; s < figure.series.size(); ++s) {
        if (figure.kinds[figure.series[s].kind].shown) {
            out += data_block(figure, figure.series[s], s);
        }
    }
    out += plot_clauses(figure) + "unset output\n";
    if (pdf.empty()) return out;
    return out + fmt::format(
                     "set terminal pdfcairo size {:.2f}cm,{:.2f}cm noenhanced font 'sans-serif,9' "
                     "linewidth 0.8\nset output {}\nreplot\nunset output\n",
                     15.0, 15.0 * (480 + 20 * static_cast<double>(key_rows)) / 720,
                     gnuplot_string(pdf));
}

}  // namespace grainfield::report
