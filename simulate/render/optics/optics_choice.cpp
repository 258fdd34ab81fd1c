#include "simulate/render/optics/optics_choice.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "core/errors.h"
#include "simulate/render/optics/optics_list.h"

namespace grainfield::simulate {

OpticsChoice::OpticsChoice() : kinds_(all_optics()) {}

OpticsChoice::OpticsChoice(const OpticsChoice& other) : chosen_(other.chosen_) {
    for (const auto& kind : other.kinds_) kinds_.push_back(kind->copy());
}

OpticsChoice& OpticsChoice::operator=(const OpticsChoice& other) {
    if (this == &other) return *this;
    const std::size_t shared = std::min(kinds_.size(), other.kinds_.size());
    for (std::size_t i = 0; i < shared; ++i) {
        if (kinds_[i]->name() == other.kinds_[i]->name()) {
            kinds_[i]->assign(*other.kinds_[i]);
        } else {
            kinds_[i] = other.kinds_[i]->copy();
        }
    }
    kinds_.resize(shared);
    for (std::size_t i = shared; i < other.kinds_.size(); ++i) {
        kinds_.push_back(other.kinds_[i]->copy());
    }
    chosen_ = other.chosen_;
    return *this;
}

void OpticsChoice::add(std::unique_ptr<OpticsKind> kind) {
    kinds_.push_back(std::move(kind));
}

void OpticsChoice::select(std::string_view name) {
    std::string names;
    for (std::size_t i = 0; i < kinds_.size(); ++i) {
        if (kinds_[i]->name() == name) {
            chosen_ = i;
            return;
        }
        names += (i > 0 ? ", " : "") + kinds_[i]->name();
    }
    throw OptionError({.problem = "optics: there is none of this name",
                       .actual = std::string(name),
                       .expected = fmt::format("one of {}", names),
                       .suggestion = {}});
}

void OpticsChoice::describe_choice(OptionTable& table) {
    std::vector<std::pair<std::string, std::size_t>> values;
    std::string meaning;
    for (std::size_t i = 0; i < kinds_.size(); ++i) {
        values.emplace_back(kinds_[i]->name(), i);
        if (i > 0) meaning += i + 1 == kinds_.size() ? ", or " : ", ";
        meaning += kinds_[i]->meaning();
    }
    table.choice("optics", chosen_, values, meaning);
}

std::vector<OptionTable> OpticsChoice::describe() {
    std::vector<OptionTable> tables;
    for (const auto& kind : kinds_) tables.push_back(kind->describe());
    return tables;
}

}  // namespace grainfield::simulate
