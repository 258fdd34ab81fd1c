#pragma once

#include "app/command.h"

namespace grainfield::app {

/// `grainfield info`: what a file holds, in words.
class InfoCommand : public Command {
 public:
    std::string name() const override { return "info"; }
    std::string purpose() const override;
    Inputs inputs() const override;
    std::vector<OptionTable> options() override;
    Summary run(Session& session) override;

 private:
    bool fingerprint_ = false;
};

}  // namespace grainfield::app
