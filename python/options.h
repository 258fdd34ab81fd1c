#pragma once

#include <vector>

#include <pybind11/pybind11.h>

#include "core/option_table.h"

namespace grainfield::python {

/// Sets options from keyword arguments.
///
/// A keyword is the name of an option with `_` for `-`. Where two sections share a name it is
/// `section_name`. A keyword that is a section takes a mapping of its options, as a table of a
/// TOML file: grain={"restitution": 0.9}. None leaves an option as it is. Values are checked as
/// those of the command line are: OptionError names the nearest keyword, the range, the unit.
void set_options(const std::vector<OptionTable>& tables, const pybind11::dict& keywords);

/// What set_options takes: a list of dicts with section, keyword, unit, domain, default and
/// meaning.
pybind11::list listed_options(const std::vector<OptionTable>& tables);

}  // namespace grainfield::python
