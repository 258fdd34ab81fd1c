#pragma once

#include <limits>
#include <string>
#include <vector>

namespace grainfield::report {

/// A cell of a table: a number, or a text where the number alone does not say it.
struct TableCell {
    double value = std::numeric_limits<double>::quiet_NaN();
    std::string text;     ///< what people read; empty: the value to four digits, "–" if NaN
    bool failed = false;  ///< stands out: a threshold was missed
};

struct TableColumn {
    std::string name;   ///< in the CSV: "rmse"
    std::string label;  ///< for people: "RMSE"
    std::string unit;   ///< "px"; empty if dimensionless
    bool is_text = false;
};

/// A table of a page; the first column of each row is its name.
struct Table {
    std::string name;                  ///< file name of the CSV, id on the page
    std::string title;                 ///< for people
    std::string note;                  ///< how to read it; may be empty
    std::vector<TableColumn> columns;  ///< without the row names
    struct Row {
        std::string name;
        std::vector<TableCell> cells;  ///< as many as columns
    };
    std::vector<Row> rows;
};

/// The table with its title and note. All text of users is escaped.
std::string table_html(const Table& table);

/// Header: `name` and the columns; six digits a number, empty where there is none. A cell that has
/// only a text is that text.
std::string table_csv(const Table& table);

}  // namespace grainfield::report
