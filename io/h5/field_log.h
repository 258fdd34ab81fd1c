#pragma once

#include <cstdint>

#include "core/density_field.h"
#include "io/h5/record_log.h"

namespace grainfield::io {

/// The fields that a run under way has stored so far, one record of little-endian doubles a frame.
/// They go to the field file when the run is done.
class FieldLog : public FieldSink, public FieldSource {
 public:
    /// `log` must outlive this.
    explicit FieldLog(RecordLog& log) : log_(log) {}

    void write(const FieldFrame& frame) override;
    std::int64_t count() const override { return log_.count(); }
    FieldFrame read(std::int64_t index) override;

 private:
    RecordLog& log_;
};

}  // namespace grainfield::io
