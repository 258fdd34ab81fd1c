#include "report/page/alternatives.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "report/maps/png.h"
#include "report/text.h"

namespace grainfield::report {

std::string alternatives_html(const Alternatives& alternatives) {
    if (alternatives.empty()) return "";
    std::string sliders;
    for (std::size_t a = 0; a < alternatives.axes.size(); ++a) {
        const AlternativeAxis& axis = alternatives.axes[a];
        sliders += fmt::format(
            "<label>{} <input type=\"range\" min=\"0\" max=\"{}\" value=\"{}\" step=\"1\">"
            "<output></output></label>\n",
            escape_html(axis.label), axis.values.size() - 1, axis.chosen);
    }
    return "<section class=\"alternatives\"><h2>" + escape_html(alternatives.title) +
           "</h2>\n<div class=\"try\"><canvas role=\"img\" aria-label=\"Part of the frame with "
           "what "
           "these settings find\"></canvas>\n<div class=\"choices\">" +
           sliders +
           "<p class=\"found\" aria-live=\"polite\"></p>\n<div "
           "class=\"blocks\"><section><h3>Settings"
           "</h3>\n<button type=\"button\" class=\"copy\">Copy</button><pre tabindex=\"0\"></pre>"
           "</section></div></div></div></section>\n";
}

std::string alternatives_json(const Alternatives& alternatives) {
    using nlohmann::json;
    if (alternatives.empty()) return "null";
    json axes = json::array();
    for (const AlternativeAxis& axis : alternatives.axes) {
        json values = json::array();
        for (const std::string& value : axis.values) values.push_back(clean_text(value));
        axes.push_back(values);
    }
    json tried = json::array();
    for (const Alternative& one : alternatives.tried) {
        json tenths = json::array();
        for (const Vec2 p : one.position) {
            tenths.push_back(std::lround(10 * p.x));
            tenths.push_back(std::lround(10 * p.y));
        }
        tried.push_back({{"at", tenths},
                         {"diameter", one.diameter},
                         {"words", clean_text(one.words)},
                         {"settings", one.settings}});
    }
    const json whole{
        {"image", "data:image/png;base64," + base64(encode_png(alternatives.picture, 1))},
        {"size", {alternatives.picture.width(), alternatives.picture.height()}},
        {"axes", axes},
        {"tried", tried}};
    return escape_json_for_script(whole.dump());
}

}  // namespace grainfield::report
