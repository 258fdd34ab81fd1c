#include "io/h5/detail/run_record_json.h"

#include <bit>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/io/file_samples.h"

namespace grainfield::io {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

double through_text(double number) {
    return number_from_json(json::parse(text_of(to_json(number))));
}

TEST(RunRecordJson, KeepsEveryBitOfANumber) {
    RandomStream random(1, "json numbers");
    for (int i = 0; i < 5000; ++i) {
        const auto bits = std::uint64_t{random.bits()} << 32U | random.bits();
        const auto number = std::bit_cast<double>(bits);
        if (std::isnan(number)) continue;
        ASSERT_EQ(std::bit_cast<std::uint64_t>(through_text(number)), bits);
    }
    EXPECT_TRUE(std::isnan(through_text(std::nan(""))));
    EXPECT_TRUE(std::signbit(through_text(-0.0)));
}

TEST(RunRecordJson, TellsMissingFromNotANumber) {
    EXPECT_FALSE(optional_from_json(to_json(std::optional<double>())));
    EXPECT_TRUE(std::isnan(*optional_from_json(to_json(std::optional<double>(std::nan(""))))));
}

TEST(RunRecordJson, GivesBackRecordInfoAndBox) {
    expect_same(record_from_json(to_json(sample_record()), "x"), sample_record());
    expect_same(info_from_json(to_json(sample_info()), "x"), sample_info());
    for (const Origin origin : {Origin::video, Origin::md, Origin::rendered, Origin::points}) {
        for (const TimeUnit unit : {TimeUnit::frame, TimeUnit::second, TimeUnit::sqrt_a_over_g}) {
            TrajectoryInfo info = sample_info();
            info.origin = origin;
            info.time_unit = unit;
            info.length_unit = LengthUnit::diameter;
            expect_same(info_from_json(to_json(info), "x"), info);
        }
    }
    for (const DiameterOrigin origin : {DiameterOrigin::stated, DiameterOrigin::simulated,
                                        DiameterOrigin::given, DiameterOrigin::apparent}) {
        TrajectoryInfo info = sample_info();
        info.diameter_origin = origin;
        info.control = std::nullopt;
        expect_same(info_from_json(to_json(info), "x"), info);
        EXPECT_TRUE(names_identity(to_json(info))) << "that it is not known is known";
    }
    const Box box = full_snapshot(0, 1).box;
    EXPECT_EQ(box_from_json(to_json(box), "x"), box);
}

TEST(RunRecordJson, GivesBackIdentities) {
    for (const RunIdentity& identity :
         {RunIdentity{},
          RunIdentity{.origin = Origin::md,
          .control = ControlValue{.parameter = ControlParameter::acceleration, .value = 1.0 / 3}},
          RunIdentity{.origin = Origin::field,
          .role = RunRole::critical_point,
          .control = sample_info().control,
          .dimension = 1,
          .gradient_order = 4}}) {
        EXPECT_EQ(identity_from_json(to_json(identity), "x"), identity);
    }
}

TEST(RunRecordJson, OfVersion01HasNoIdentityButIsRead) {
    nlohmann::json info = to_json(sample_info());
    info.erase("control");
    info.erase("diameter_origin");
    EXPECT_FALSE(names_identity(info));
    EXPECT_EQ(info_from_json(info, "x").diameter, sample_info().diameter);
    nlohmann::json record = to_json(sample_record());
    record.erase("warning_codes");
    EXPECT_EQ(record_from_json(record, "x").warnings.at(0).text, "frame 3 is missing");
}

TEST(RunRecordJson, NamesTheFileOfADamagedText) {
    const auto refused = ThrowsMessage<InputError>(HasSubstr("x.h5"));
    EXPECT_THAT([] { parse_json("{\"a\":", "x.h5"); }, refused);
    EXPECT_THAT([] { record_from_json(json::object(), "x.h5"); }, refused);
    EXPECT_THAT([] { record_from_json(json(3), "x.h5"); }, refused);
    json info = to_json(sample_info());
    info["origin"] = "microscope";
    EXPECT_THAT([&] { info_from_json(info, "x.h5"); }, refused);
    json record = to_json(sample_record());
    record["warning_codes"] = json::array({"other"});
    EXPECT_THAT([&] { record_from_json(record, "x.h5"); }, refused) << "one code for two warnings";
    json identity = to_json(RunIdentity{});
    identity["role"] = "walk-on";
    EXPECT_THAT([&] { identity_from_json(identity, "x.h5"); }, refused);
    json box = to_json(Box{{0, 0}, {1, 1}});
    box["boundary"] = json::array({"walls"});
    EXPECT_THAT([&] { box_from_json(box, "x.h5"); }, refused);
    box["boundary"] = "walls";
    EXPECT_THAT([&] { box_from_json(box, "x.h5"); }, refused);
}

TEST(RunRecordJson, ReplacesBytesThatAreNoText) {
    EXPECT_EQ(text_of(json("a\xFF")), "\"a\xEF\xBF\xBD\"");
}

TEST(RunRecordJson, RefusesNumbersThatAreNotWhole) {
    const auto expect_refused = [](const char* key, const json& value) {
        json text = to_json(sample_record());
        text[key] = value;
        EXPECT_THAT([&] { record_from_json(text, "a.h5"); },
                    ThrowsMessage<InputError>(HasSubstr("a.h5")))
            << key << value;
    };
    for (const json& value : {json(1.5), json(1e300), json(-1), json("7")}) {
        expect_refused("seed", value);
    }
    expect_refused("threads", 1.5);
    expect_refused("threads", std::int64_t{1} << 40);
    expect_refused("threads", std::numeric_limits<std::uint64_t>::max());
}

}  // namespace
}  // namespace grainfield::io
