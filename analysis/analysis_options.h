#pragma once

#include <any>
#include <map>
#include <string>
#include <typeindex>
#include <vector>

namespace grainfield::analysis {

/// Stands for the names of all observables.
inline constexpr const char* all_observables = "all";

/// What to measure and how. Each observable has an options struct of its own, found by its type:
///
///     options.of<StructureFactorOptions>().k_max = 3;
class AnalysisOptions {
 public:
    std::vector<std::string> observables{all_observables};  ///< their names, or all

    /// The options of one observable, to be changed; defaults until then.
    template <class Options>
    Options& of() {
        std::any& stored = stored_[typeid(Options)];
        if (!stored.has_value()) stored.emplace<Options>();
        return std::any_cast<Options&>(stored);
    }

    template <class Options>
    const Options& of() const {
        static const Options defaults{};
        const auto found = stored_.find(typeid(Options));
        return found == stored_.end() ? defaults : std::any_cast<const Options&>(found->second);
    }

 private:
    std::map<std::type_index, std::any> stored_;
};

}  // namespace grainfield::analysis
