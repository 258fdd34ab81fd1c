#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/warning.h"

namespace grainfield {

/// One stage that a command will run or leave out.
struct PlannedStage {
    std::string stage;  ///< "background fit"
    bool runs = true;
    std::string reason;  ///< "skipped, illumination uniform to 0.3 %"
    std::string saved;   ///< what skipping saves: "about 12 ms a frame"; empty if it runs
};

/// What a command is going to do and what it leaves out, and why. `--explain` prints it and
/// stops; the summary of a run repeats the skipped stages. Warnings gathered on the way ride along.
class RunPlan {
 public:
    /// Puts a text into the words of whoever called: libraries name options "section.name" and
    /// "option 'name'", a program may have flags for them.
    using Wording = std::function<std::string(std::string)>;

    RunPlan() = default;
    explicit RunPlan(Wording wording) : wording_(std::move(wording)) {}
    const Wording& wording() const { return wording_; }

    void run(std::string stage, std::string reason);
    void skip(std::string stage, std::string reason, std::string saved);
    /// Keeps each distinct text once, in the order of first appearance.
    void warn(Warning warning);
    void warn(WarningCode code, std::string text) { warn(Warning{code, std::move(text)}); }
    void warn(std::string text) { warn(WarningCode::other, std::move(text)); }

    /// Takes over all that another one holds, in its order.
    void take(const RunPlan& other);

    const std::vector<PlannedStage>& stages() const { return stages_; }
    const std::vector<Warning>& warnings() const { return warnings_; }
    std::vector<PlannedStage> skipped() const;

    /// One line a stage, for `--explain`.
    std::string text() const;

 private:
    std::string worded(std::string text) const;

    Wording wording_;
    std::vector<PlannedStage> stages_;
    std::vector<Warning> warnings_;
};

}  // namespace grainfield
