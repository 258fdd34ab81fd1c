#include "report/page/table_section.h"

#include "report/page/differences.h"
#include "report/page/file_links.h"
#include "report/page/key_numbers.h"

namespace grainfield::report {

namespace {

bool is_of_differences(const Table& table) {
    return table.name == differences_name;
}

// Of the tables that belong there, with the links to their files.
std::string chosen_tables(const PageContent& content, bool (*belongs)(const Table&)) {
    std::string out;
    for (const Table& table : content.tables) {
        if (belongs(table)) out += table_html(table) + file_links(content, table.name);
    }
    return out;
}

}  // namespace

std::string tables_html(const PageContent& content) {
    const std::string tables =
        chosen_tables(content, [](const Table& table) { return !is_of_differences(table); });
    if (tables.empty()) return "";
    return "<section class=\"tables\"><h2>Tables</h2>\n" + tables + "</section>\n";
}

std::string differences_html(const PageContent& content) {
    const std::string tables = chosen_tables(content, is_of_differences);
    if (tables.empty()) return "";
    return "<section class=\"tables\">" + tables + "</section>\n";
}

std::string numbers_html(const PageContent& content) {
    const std::string table =
        key_numbers_html(key_numbers(content.runs, content.titles), content.labels);
    return "<section><h2>All numbers</h2>\n<details><summary>Each with its error and samples"
           "</summary>" +
           table + "</details></section>\n";
}

}  // namespace grainfield::report
