#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/results.h"
#include "core/support/random.h"
#include "core/trajectory.h"

namespace grainfield {

inline std::string read_bytes(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// n particles with every column, numbers that use all bits of a double.
inline Snapshot full_snapshot(std::int64_t frame, std::size_t n) {
    RandomStream random(7, "file sample", static_cast<std::uint64_t>(frame));
    Snapshot s;
    s.frame = frame;
    s.time = static_cast<double>(frame) / 30;
    s.box = {
        {-0.5, -0.5}, {100 + random.uniform(), 80}, {Boundary::walls, Boundary::periodic}, 1.7};
    for (std::size_t i = 0; i < n; ++i) {
        s.position.push_back({random.uniform(0, 100), random.uniform(0, 80)});
        s.id.push_back(static_cast<std::int64_t>(3 * i + 5));
        s.z.push_back(random.uniform());
        s.velocity.push_back({random.normal(), random.normal(), random.normal()});
        s.spin.push_back({random.normal(), random.normal(), random.normal()});
        s.position_error.push_back({random.uniform(), random.uniform()});
        s.z_error.push_back(i % 4 == 0 ? std::numeric_limits<double>::quiet_NaN()
                                       : random.uniform());
        s.quality.push_back(i % 3 == 0 ? std::numeric_limits<double>::quiet_NaN()
                                       : random.uniform());
        s.layer.push_back(static_cast<Layer>(static_cast<int>(i % 3) - 1));
    }
    return s;
}

/// Positions and identities only.
inline Snapshot plain_snapshot(std::int64_t frame, std::size_t n) {
    const Snapshot full = full_snapshot(frame, n);
    Snapshot s;
    s.frame = full.frame;
    s.time = full.time;
    s.box = full.box;
    s.position = full.position;
    s.id = full.id;
    return s;
}

inline TrajectoryInfo sample_info() {
    return {.origin = Origin::video,
            .length_unit = LengthUnit::pixel,
            .time_unit = TimeUnit::second,
            .diameter = 8.9 + 1.0 / 3,
            .diameter_origin = DiameterOrigin::given,
            .control = ControlValue{.parameter = ControlParameter::critical_distance,
                                    .value = 1.0 / 3,
                                    .unit = "1/a"},
            .vibration_frequency = std::nullopt,
            .frame_rate = 30,
            .source = "frames \"ä\" <b>"};
}

inline TrajectoryInfo with_frame_rate(double rate) {
    TrajectoryInfo info;
    info.frame_rate = rate;
    return info;
}

inline TrajectoryInfo with_diameter(double diameter) {
    TrajectoryInfo info;
    info.diameter = diameter;
    return info;
}

inline RunRecord sample_record() {
    RunRecord record;
    record.command = "track";
    record.version = "0.1.0";
    record.seed = 0xFFFFFFFFFFFFFFFF;
    record.threads = 2;
    record.seconds = 1.0 / 3;
    record.configuration = {{"detection.threshold", "0.1"}, {"link.memory", "3"}};
    record.inputs = {{"a.tif", 1024192, "crc32:9ae0daaf"}};
    record.skipped = {"background fit: uniform"};
    record.warnings = {{.text = "frame 3 is missing"},
                       {WarningCode::apparent_diameter, "lengths are in D"}};
    return record;
}

/// An image of whole counts in 0 … 255, which 8 bits hold exactly.
inline Preview sample_preview() {
    Preview preview;
    preview.frame.image = Image(17, 9);
    for (std::size_t i = 0; i < preview.frame.image.size(); ++i) {
        preview.frame.image.pixels()[i] = static_cast<float>((i * 37) % 256);
    }
    preview.frame.index = 4;
    preview.frame.time = 0.1;
    preview.frame.message = "as it was";
    preview.snapshot = full_snapshot(4, 5);
    preview.abs_q4 = {0.1, 1, std::numeric_limits<double>::quiet_NaN(), 0.5, 1.0 / 3};
    return preview;
}

inline void expect_same_numbers(const std::vector<double>& a, const std::vector<double>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i]))) << a[i] << " " << b[i];
    }
}

inline void expect_same(const Snapshot& a, const Snapshot& b) {
    EXPECT_EQ(a.frame, b.frame);
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.box, b.box);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.z, b.z);
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_EQ(a.spin, b.spin);
    EXPECT_EQ(a.position_error, b.position_error);
    expect_same_numbers(a.z_error, b.z_error);
    expect_same_numbers(a.quality, b.quality);
    EXPECT_EQ(a.layer, b.layer);
}

inline void expect_same(const TrajectoryInfo& a, const TrajectoryInfo& b) {
    EXPECT_EQ(a.origin, b.origin);
    EXPECT_EQ(a.length_unit, b.length_unit);
    EXPECT_EQ(a.time_unit, b.time_unit);
    EXPECT_EQ(a.diameter, b.diameter);
    EXPECT_EQ(a.diameter_origin, b.diameter_origin);
    EXPECT_EQ(a.control, b.control);
    EXPECT_EQ(a.vibration_frequency, b.vibration_frequency);
    EXPECT_EQ(a.frame_rate, b.frame_rate);
    EXPECT_EQ(a.source, b.source);
}

inline void expect_same(const RunRecord& a, const RunRecord& b) {
    EXPECT_EQ(a.command, b.command);
    EXPECT_EQ(a.version, b.version);
    EXPECT_EQ(a.seed, b.seed);
    EXPECT_EQ(a.threads, b.threads);
    EXPECT_EQ(a.seconds, b.seconds);
    EXPECT_EQ(a.configuration, b.configuration);
    ASSERT_EQ(a.inputs.size(), b.inputs.size());
    for (std::size_t i = 0; i < a.inputs.size(); ++i) {
        EXPECT_EQ(a.inputs[i].name, b.inputs[i].name);
        EXPECT_EQ(a.inputs[i].bytes, b.inputs[i].bytes);
        EXPECT_EQ(a.inputs[i].checksum, b.inputs[i].checksum);
    }
    EXPECT_EQ(a.skipped, b.skipped);
    EXPECT_EQ(a.warnings, b.warnings);
}

inline void expect_same(const Preview& a, const Preview& b) {
    EXPECT_EQ(a.frame.image, b.frame.image);
    EXPECT_EQ(a.frame.index, b.frame.index);
    EXPECT_EQ(a.frame.time, b.frame.time);
    EXPECT_EQ(a.frame.bit_depth, b.frame.bit_depth);
    EXPECT_EQ(a.frame.status, b.frame.status);
    EXPECT_EQ(a.frame.message, b.frame.message);
    expect_same(a.snapshot, b.snapshot);
    expect_same_numbers(a.abs_q4, b.abs_q4);
}

}  // namespace grainfield
