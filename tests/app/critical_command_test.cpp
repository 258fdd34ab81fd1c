#include "app/critical_command.h"

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::app {
namespace {

TEST(CriticalCommand, RefusesValuesThatAreNotNumbers) {
    for (const char* values : {"six", "1,", "5.5,nan", "1;2"}) {
        CriticalCommand command;
        std::vector<OptionTable> tables = command.options();
        Session session;
        session.command = "critical";
        session.inputs = {"a.h5"};
        const auto run = [&] {
            tables.front().set("output", OptionValue(std::string("critical.h5")));
            tables.front().set("values", OptionValue(std::string(values)));
            command.run(session);
        };
        EXPECT_THROW(run(), Error) << values;
        EXPECT_TRUE(session.outputs.empty());
    }
}

}  // namespace
}  // namespace grainfield::app
