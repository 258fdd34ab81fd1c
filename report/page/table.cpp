#include "report/page/table.h"

#include <cmath>

#include <fmt/format.h>

#include "report/text.h"

namespace grainfield::report {

namespace {

std::string shown(const TableCell& cell) {
    if (!cell.text.empty()) return escape_html(cell.text);
    return std::isfinite(cell.value) ? escape_html(with_error(cell.value, nullptr)) : "–";
}

}  // namespace

std::string table_html(const Table& table) {
    std::string out = fmt::format("<section id=\"table-{}\"><h3>{}</h3>\n", escape_html(table.name),
                                  escape_html(table.title));
    if (!table.note.empty()) out += "<p class=\"note\">" + escape_html(table.note) + "</p>\n";
    out += "<div class=\"scroll\"><table class=\"numbers scores\"><thead><tr><th></th>";
    for (const TableColumn& column : table.columns) {
        const std::string unit =
            column.unit.empty() ? ""
                                : " <span class=\"unit\">[" + escape_html(column.unit) + "]</span>";
        out += (column.is_text ? "<th class=\"words\">" : "<th>") + escape_html(column.label) +
               unit + "</th>";
    }
    out += "</tr></thead>\n<tbody>\n";
    for (const Table::Row& row : table.rows) {
        out += "<tr><th>" + escape_html(row.name) + "</th>";
        for (std::size_t c = 0; c < row.cells.size(); ++c) {
            const TableCell& cell = row.cells[c];
            const bool words = c < table.columns.size() && table.columns[c].is_text;
            const char* style = cell.failed && words ? " class=\"words failed\""
                                : cell.failed        ? " class=\"failed\""
                                : words              ? " class=\"words\""
                                                     : "";
            out += fmt::format("<td{}>{}</td>", style, shown(cell));
        }
        out += "</tr>\n";
    }
    return out + "</tbody></table></div></section>\n";
}

std::string table_csv(const Table& table) {
    std::string out = "name";
    for (const TableColumn& column : table.columns) out.append(",").append(csv_cell(column.name));
    out += "\n";
    for (const Table::Row& row : table.rows) {
        out += csv_cell(row.name);
        for (const TableCell& cell : row.cells) {
            const bool is_number = std::isfinite(cell.value) || cell.text.empty();
            out.append(",").append(is_number ? csv_cell(cell.value) : csv_cell(cell.text));
        }
        out += "\n";
    }
    return out;
}

}  // namespace grainfield::report
