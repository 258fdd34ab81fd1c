#include "core/snapshot.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield {
namespace {

using testing::HasSubstr;

Snapshot two_particles() {
    Snapshot s;
    s.frame = 17;
    s.position = {{1, 2}, {3, 4}};
    return s;
}

std::string refusal(const Snapshot& snapshot) {
    try {
        require_consistent(snapshot);
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was thrown";
}

TEST(Snapshot, ColumnsMayBeAbsentOrComplete) {
    Snapshot s = two_particles();
    EXPECT_NO_THROW(require_consistent(s));
    s.id = {0, 1};
    s.z = {0.5, 0.5};
    s.velocity.resize(2);
    s.spin.resize(2);
    s.position_error.resize(2);
    s.z_error.resize(2);
    s.quality.resize(2);
    s.layer = {Layer::top, Layer::unknown};
    EXPECT_NO_THROW(require_consistent(s));
    EXPECT_NO_THROW(require_consistent(Snapshot{}));
}

TEST(Snapshot, AnIncompleteColumnIsNamedWithItsFrameAndLength) {
    const auto with = [](auto change) {
        Snapshot s = two_particles();
        change(s);
        return refusal(s);
    };
    EXPECT_EQ(with([](Snapshot& s) { s.id = {1}; }),
              "frame 17: column 'id' is incomplete: 1 entries; expected 2, one per particle, or "
              "none.");
    EXPECT_THAT(with([](Snapshot& s) { s.z.resize(3); }), HasSubstr("'z'"));
    EXPECT_THAT(with([](Snapshot& s) { s.velocity.resize(1); }), HasSubstr("'velocity'"));
    EXPECT_THAT(with([](Snapshot& s) { s.spin.resize(1); }), HasSubstr("'spin'"));
    EXPECT_THAT(with([](Snapshot& s) { s.position_error.resize(1); }),
                HasSubstr("'position_error'"));
    EXPECT_THAT(with([](Snapshot& s) { s.z_error.resize(1); }), HasSubstr("'z_error'"));
    EXPECT_THAT(with([](Snapshot& s) { s.quality.resize(1); }), HasSubstr("'quality'"));
    EXPECT_THAT(with([](Snapshot& s) { s.layer.resize(1); }), HasSubstr("'layer'"));
}

TEST(Snapshot, ANonFinitePositionIsNamedWithItsParticle) {
    Snapshot s = two_particles();
    s.position[1].y = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(s), HasSubstr("frame 17: position of particle 1"));
    s.position[1].y = std::numeric_limits<double>::infinity();
    EXPECT_THAT(refusal(s), HasSubstr("particle 1"));
}

}  // namespace
}  // namespace grainfield
