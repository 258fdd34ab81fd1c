#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <future>
#include <optional>

#include "core/frame.h"
#include "core/snapshot.h"
#include "core/support/output_file.h"

namespace grainfield::pipelines {

/// A picture of the newest frame with what was found in it, renewed once a second: rings coloured
/// by |Q4|, number and time of the frame, count, mean |Q4|, and how many frames were dropped.
///
/// Drawn in a thread of its own: tracking waits only for a copy of the frame. The file is replaced
/// as a whole, so that whoever reads it sees one picture or the next.
class LivePreview {
 public:
    /// `diameter` [px] of a sphere. `has_times`: times are in seconds. `overwrite` is for the first
    /// picture. Throws OptionError unless the name ends in .png or .jpg, OutputError as OutputFile
    /// does.
    LivePreview(std::filesystem::path file, Overwrite overwrite, double diameter, bool has_times);

    /// Whether the last picture is a second old and whole.
    bool is_due() const;
    /// Throws OutputError of the last picture.
    void show(Frame frame, Snapshot found, std::int64_t dropped);
    /// Waits for the last picture. Throws its OutputError.
    void finish();

 private:
    std::filesystem::path file_;
    Overwrite overwrite_;
    double diameter_;
    bool has_times_;
    std::optional<std::chrono::steady_clock::time_point> shown_;
    std::future<void> drawing_;
};

/// Throws OptionError unless the name is one of a picture that LivePreview can write.
void require_preview_name(const std::filesystem::path& file);

}  // namespace grainfield::pipelines
