#include "core/support/printable.h"

#include <gtest/gtest.h>

namespace grainfield {

TEST(Printable, SpellsOutWhatWouldCommandATerminal) {
    EXPECT_EQ(printable("a\x1b[31mb\r\x07"), "a\\x1b[31mb\\x0d\\x07");
    EXPECT_EQ(printable("\xc2\x9b"
                        "31m"),
              "\\x9b31m")
        << "the control sequence in one character";
    EXPECT_EQ(printable("\x7f"), "\\x7f");
}

TEST(Printable, LeavesWordsOfAnyLanguageAndLines) {
    const char* const text = "Γ = 4.5 …\n\tÜ 粒 ± é";
    EXPECT_EQ(printable(text), text);
    EXPECT_EQ(printable("\xc2"), "\xc2") << "cut short";
}

}  // namespace grainfield
