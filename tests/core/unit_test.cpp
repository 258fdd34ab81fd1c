#include "core/unit.h"

#include <gtest/gtest.h>

namespace grainfield {
namespace {

TEST(Unit, IsAProductOfPowersAndGivesItsTextBack) {
    const Unit diffusion = "a^2/time unit";
    EXPECT_EQ(diffusion.power(BaseUnit::diameter), 2);
    EXPECT_EQ(diffusion.power(BaseUnit::time), -1);
    EXPECT_EQ(diffusion.power(BaseUnit::pixel), 0);
    for (const char* text : {"-", "a", "1/a", "a^2", "1/a^2", "l", "1/l", "px", "time unit",
                             "a^2/time unit", "periods", "1/period", "m g", "m g a", "m g/a^2"}) {
        EXPECT_EQ(Unit(text).text(), text);
        int powers = 0;
        for (int base = 0; base < 7; ++base) powers += std::abs(Unit(text).power(BaseUnit(base)));
        EXPECT_EQ(powers > 0, Unit(text) != Unit()) << text << " is known";
    }
}

TEST(Unit, KeepsATextThatIsNoSuchProduct) {
    for (const char* text : {"1/l^d", "a^2/s", "m^-10", "x^", "a a", "1/", "/a", "a/a", "a^1",
                             "period", "1/periods", "\"><script>", " ", "time unitx", "a  g"}) {
        const Unit unit = text;
        EXPECT_EQ(unit.text(), text);
        EXPECT_FALSE(unit.is_dimensionless()) << text;
        EXPECT_EQ(unit.on_lattice(), unit) << text;
    }
}

TEST(Unit, WithoutATextIsDimensionless) {
    EXPECT_TRUE(Unit().is_dimensionless());
    EXPECT_EQ(Unit(""), Unit());
    EXPECT_EQ(Unit("-"), Unit());
    EXPECT_EQ(Unit().text(), "-");
}

TEST(Unit, OfAFieldHasLatticeLengthsInPlaceOfDiameters) {
    EXPECT_EQ(Unit("a").on_lattice(), Unit("l"));
    EXPECT_EQ(Unit("1/a^2").on_lattice(), Unit("1/l^2"));
    EXPECT_EQ(Unit("time unit").on_lattice(), Unit("time unit"));
}

TEST(UnitText, NamesTheTimeUnitForFilesAndForPeople) {
    const Unit diffusion = "a^2/time unit";
    EXPECT_EQ(plain_text(diffusion, TimeUnit::second), "a^2/s");
    EXPECT_EQ(plain_text(diffusion, TimeUnit::frame), "a^2/frames");
    EXPECT_EQ(plain_text(Unit("time unit"), TimeUnit::sqrt_a_over_g), "sqrt(a/g)");
    EXPECT_EQ(plain_text(Unit(), TimeUnit::second), "-");
    EXPECT_EQ(typeset_text(diffusion, TimeUnit::frame), "a²/frame");
    EXPECT_EQ(typeset_text(Unit("time unit"), TimeUnit::sqrt_a_over_g), "√(a/g)");
    EXPECT_EQ(typeset_text(Unit("1/a^2"), TimeUnit::second), "1/a²");
    EXPECT_EQ(typeset_text(Unit(), TimeUnit::second), "");
}

TEST(UnitText, RaisesThePowersOfUnitsFromElsewhere) {
    EXPECT_EQ(typeset_text(Unit("a^2/s"), TimeUnit::second), "a²/s");
    EXPECT_EQ(typeset_text(Unit("m^-10"), TimeUnit::second), "m⁻¹⁰");
    EXPECT_EQ(typeset_text(Unit("x^"), TimeUnit::second), "x^");
}

}  // namespace
}  // namespace grainfield
