#include "io/h5/detail/curve_group.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace grainfield::io {

using nlohmann::json;

namespace {

bool has_equal_columns(const Curve& curve) {
    std::vector<std::size_t> sizes;
    for (const Column& column : curve.columns) sizes.push_back(column.values.size());
    for (const auto& [name, words] : curve.text_columns) sizes.push_back(words.size());
    return std::ranges::adjacent_find(sizes, std::not_equal_to<>()) == sizes.end();
}

}  // namespace

void write_curves(const H5Group& group, const std::vector<Curve>& curves) {
    json index = json::array();
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const std::string name = std::to_string(i);
        const H5Group own = group.make_group(name);
        json columns = json::array();
        for (std::size_t c = 0; c < curves[i].columns.size(); ++c) {
            const Column& column = curves[i].columns[c];
            own.write<double>(std::to_string(c), column.values, {column.values.size()});
            columns.push_back(
                {{"name", column.name}, {"unit", column.unit.text()}, {"meaning", column.meaning}});
        }
        json entry{{"name", curves[i].name}, {"title", curves[i].title}, {"columns", columns}};
        if (!curves[i].text_columns.empty()) entry["text_columns"] = curves[i].text_columns;
        index.push_back(std::move(entry));
    }
    group.write_text("index", index.dump());
}

std::vector<Curve> read_curves(const H5Group& group) {
    std::vector<Curve> curves;
    try {
        const json index = json::parse(group.text("index"));
        for (std::size_t i = 0; i < index.size(); ++i) {
            const H5Group own = group.group(std::to_string(i));
            Curve curve;
            curve.name = index[i].at("name").get<std::string>();
            curve.title = index[i].at("title").get<std::string>();
            std::size_t c = 0;
            for (const json& entry : index[i].at("columns")) {
                curve.columns.push_back(
                    {.name = entry.at("name").get<std::string>(),
                     .unit = entry.at("unit").get<std::string>(),
                     .meaning = entry.at("meaning").get<std::string>(),
                     .values = own.dataset(std::to_string(c++)).read<double>()});
            }
            if (index[i].contains("text_columns")) {
                index[i].at("text_columns").get_to(curve.text_columns);
            }
            if (!has_equal_columns(curve)) {
                group.file().fail(
                    fmt::format("the columns of curve '{}' have different lengths", curve.name));
            }
            curves.push_back(std::move(curve));
        }
    } catch (const json::exception&) {
        group.file().fail("the index of its curves is damaged");
    }
    return curves;
}

}  // namespace grainfield::io
