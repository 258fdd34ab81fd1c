#pragma once

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "core/errors.h"
#include "core/option_table.h"
#include "simulate/render/optics/optics.h"

namespace grainfield::simulate {

/// The optics to choose from, each with its options, and the one that is chosen. A value: copies
/// have options of their own. Assignment keeps what tables of options are bound to.
class OpticsChoice {
 public:
    /// All optics of the program, with default options; the first is chosen.
    OpticsChoice();
    OpticsChoice(const OpticsChoice& other);
    OpticsChoice& operator=(const OpticsChoice& other);
    ~OpticsChoice() = default;

    /// One more to choose from.
    void add(std::unique_ptr<OpticsKind> kind);
    /// Throws OptionError if there is none of that name.
    void select(std::string_view name);

    OpticsKind& chosen() { return *kinds_[chosen_]; }
    const OpticsKind& chosen() const { return *kinds_[chosen_]; }
    bool is(std::string_view name) const { return chosen().name() == name; }

    /// The optics of one kind with its options, chosen or not. Throws Error if it is not there.
    template <class Kind>
    Kind& of() {
        return const_cast<Kind&>(std::as_const(*this).template of<Kind>());
    }
    template <class Kind>
    const Kind& of() const {
        for (const auto& kind : kinds_) {
            if (const auto* found = dynamic_cast<const Kind*>(kind.get())) return *found;
        }
        throw Error("no such optics to choose from.");
    }

    /// Adds the choice itself to a table.
    void describe_choice(OptionTable& table);
    /// A table for each.
    std::vector<OptionTable> describe();

 private:
    std::vector<std::unique_ptr<OpticsKind>> kinds_;
    std::size_t chosen_ = 0;
};

}  // namespace grainfield::simulate
