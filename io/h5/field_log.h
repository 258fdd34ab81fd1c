#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>

#include "core/density_field.h"
#include "io/h5/record_log.h"

namespace grainfield::io {

/// The fields that a run under way has stored so far (RecordLog), one record of little-endian
/// doubles a frame. The fields go to the field file when the run is done.
class FieldLog : public FieldSink, public FieldSource {
 public:
    /// Keeps the first `bytes` of what is there; 0 starts afresh.
    FieldLog(std::filesystem::path path, std::int64_t bytes) : log_(std::move(path), bytes) {}

    void write(const FieldFrame& frame) override;
    std::int64_t bytes() const { return log_.bytes(); }
    /// Brings it to the disk; before the checkpoint that notes its length.
    void sync() { log_.sync(); }
    void remove() { log_.remove(); }

    std::int64_t count() const override { return log_.count(); }
    FieldFrame read(std::int64_t index) override;

 private:
    RecordLog log_;
};

}  // namespace grainfield::io
