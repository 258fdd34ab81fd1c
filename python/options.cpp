#include "python/options.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>

#include "core/errors.h"

namespace py = pybind11;

namespace grainfield::python {

namespace {

struct Row {
    const OptionTable* table;
    const Option* option;
};

std::string kebab(std::string word) {
    std::ranges::replace(word, '_', '-');
    return word;
}

std::string snake(std::string word) {
    std::ranges::replace(word, '-', '_');
    return word;
}

std::vector<Row> rows_of(const std::vector<OptionTable>& tables) {
    std::vector<Row> rows;
    for (const OptionTable& table : tables) {
        for (const Option& option : table.rows()) rows.push_back({&table, &option});
    }
    return rows;
}

std::vector<Row> called(const std::vector<Row>& rows, const std::string& word) {
    std::vector<Row> found;
    for (const Row& row : rows) {
        if (row.option->is_called(word)) found.push_back(row);
    }
    return found;
}

std::string with_section(const Row& row) {
    return snake(row.table->section() + "-" + row.option->name);
}

bool is_shared(const std::vector<Row>& rows, const Row& row) {
    return called(rows, row.option->name).size() > 1 && !row.table->section().empty();
}

std::string keyword_of(const std::vector<Row>& rows, const Row& row) {
    return is_shared(rows, row) ? with_section(row) : snake(row.option->name);
}

/// As a command line has it: numbers to the last digit, lists with commas.
std::string text_of(const py::handle& value) {
    if (py::isinstance<py::str>(value)) return value.cast<std::string>();
    if (py::hasattr(value, "__fspath__")) return py::str(value.attr("__fspath__")());
    if (PyIndex_Check(value.ptr()) != 0)
        return py::str(py::int_(py::object(value.attr("__index__")())));
    if (py::hasattr(value, "__float__")) return py::repr(py::float_(value.cast<double>()));
    return py::repr(value);
}

bool is_truth_value(const py::handle& value) {
    return py::isinstance<py::bool_>(value) ||
           std::string(Py_TYPE(value.ptr())->tp_name).starts_with("numpy.bool");
}

bool is_list(const py::handle& value) {
    return !py::isinstance<py::str>(value) && !py::isinstance<py::bytes>(value) &&
           PySequence_Check(value.ptr()) != 0 && PyMapping_Check(value.ptr()) != 0 &&
           !py::isinstance<py::dict>(value);
}

void set(const Option& option, const py::handle& value) {
    if (is_truth_value(value)) return option.set(PyObject_IsTrue(value.ptr()) == 1);
    if (py::isinstance<py::str>(value)) return option.set_from_text(value.cast<std::string>());
    if (is_list(value)) {
        std::string joined;
        for (const py::handle element : value) {
            joined += (joined.empty() ? "" : ",") + text_of(element);
        }
        return option.set(joined);
    }
    if (PyIndex_Check(value.ptr()) != 0) return option.set(value.cast<std::int64_t>());
    if (py::hasattr(value, "__float__")) return option.set(value.cast<double>());
    option.set_from_text(text_of(value));
}

[[noreturn]] void refuse(const std::string& keyword, const std::vector<std::string>& known) {
    const std::string nearest = nearest_name(keyword, known);
    throw OptionError({.problem = "there is no such option",
                       .actual = "'" + keyword + "'",
                       .expected = "a name that grainfield.options() lists",
                       .suggestion = nearest.empty() ? "" : "did you mean '" + nearest + "'?"});
}

void set_section(const OptionTable& table, const py::handle& values) {
    for (const auto& [key, value] : values.cast<py::dict>()) {
        const auto word = key.cast<std::string>();
        const Option* option = table.find(kebab(word));
        if (option == nullptr) {
            std::vector<std::string> known;
            for (const Option& row : table.rows()) known.push_back(snake(row.name));
            refuse(word, known);
        }
        if (!value.is_none()) set(*option, value);
    }
}

/// The option that a keyword means.
const Option& found(const std::vector<Row>& rows, const std::string& keyword) {
    const std::vector<Row> of_name = called(rows, kebab(keyword));
    if (of_name.size() == 1) return *of_name.front().option;
    std::vector<std::string> known;
    for (const Row& row : rows) {
        if (with_section(row) == snake(keyword)) return *row.option;
        known.push_back(keyword_of(rows, row));
    }
    if (of_name.empty()) refuse(keyword, known);
    std::string choices;
    for (const Row& row : of_name) choices += (choices.empty() ? "" : ", ") + with_section(row);
    throw OptionError({.problem = "more than one section has this option",
                       .actual = "'" + keyword + "'",
                       .expected = "one of " + choices,
                       .suggestion = ""});
}

py::object python_value(const OptionValue& value) {
    return std::visit([](const auto& v) -> py::object { return py::cast(v); }, value);
}

}  // namespace

void set_options(const std::vector<OptionTable>& tables, const py::dict& keywords) {
    const std::vector<Row> rows = rows_of(tables);
    for (const auto& [key, value] : keywords) {
        const auto keyword = key.cast<std::string>();
        if (value.is_none()) continue;
        const auto section = std::ranges::find(tables, kebab(keyword), &OptionTable::section);
        if (section != tables.end() && py::isinstance<py::dict>(value)) {
            set_section(*section, value);
        } else {
            set(found(rows, keyword), value);
        }
    }
}

py::list listed_options(const std::vector<OptionTable>& tables) {
    const std::vector<Row> rows = rows_of(tables);
    py::list listed;
    for (const Row& row : rows) {
        py::dict entry;
        entry["section"] = row.table->section();
        entry["keyword"] = keyword_of(rows, row);
        entry["unit"] = row.option->unit;
        entry["domain"] = row.option->domain_text();
        entry["default"] = python_value(row.option->default_value);
        entry["meaning"] = row.option->meaning;
        listed.append(entry);
    }
    return listed;
}

}  // namespace grainfield::python
