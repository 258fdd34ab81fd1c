#include "app/exit_code.h"

#include "core/errors.h"

namespace grainfield::app {

namespace {

template <class Kind>
bool is(const std::exception& failure) {
    return dynamic_cast<const Kind*>(&failure) != nullptr;
}

ExitCode cause(const std::exception& failure) {
    if (is<OptionError>(failure)) return ExitCode::wrong_usage;
    if (is<InputError>(failure)) return ExitCode::bad_input;
    if (is<OutputError>(failure)) return ExitCode::output_failed;
    if (is<PhysicsError>(failure)) return ExitCode::physics_failed;
    return ExitCode::failed;
}

}  // namespace

int exit_code(const std::exception& failure) {
    if (const auto* stop = dynamic_cast<const Interrupted*>(&failure)) {
        return exit_code(stop->signal());
    }
    return static_cast<int>(cause(failure));
}

int exit_code(int signal) {
    return 128 + signal;
}

}  // namespace grainfield::app
