#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/density_field.h"

namespace grainfield::io {

/// The fields that a run under way has stored so far: an append-only file beside its checkpoint.
/// A checkpoint notes the length; taking up the run again cuts off what came after it. The fields
/// go to the field file when the run is done.
///
/// One record a frame: u64 length, numbers (little-endian doubles), u32 CRC-32. Throws OutputError
/// if the disk is full or the file cannot be made, InputError if what is there is shorter than the
/// checkpoint says or damaged.
class FieldLog : public FieldSink, public FieldSource {
 public:
    /// Keeps the first `bytes` of what is there; 0 starts afresh.
    FieldLog(std::filesystem::path path, std::int64_t bytes);
    ~FieldLog() override;
    FieldLog(const FieldLog&) = delete;
    FieldLog& operator=(const FieldLog&) = delete;

    void write(const FieldFrame& frame) override;
    std::int64_t bytes() const { return bytes_; }
    /// Brings it to the disk; before the checkpoint that notes its length.
    void sync();
    void remove();

    std::int64_t count() const override { return static_cast<std::int64_t>(starts_.size()); }
    FieldFrame read(std::int64_t index) override;

 private:
    void find_records();
    [[noreturn]] void fail_reading(const char* what) const;
    std::vector<char> bytes_at(std::int64_t start, std::size_t count) const;

    std::filesystem::path path_;
    int descriptor_ = -1;
    std::int64_t bytes_ = 0;
    std::vector<std::int64_t> starts_;
};

}  // namespace grainfield::io
