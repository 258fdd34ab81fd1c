#pragma once

#include <cstdint>

#include "core/frame.h"
#include "io/frame_writer.h"
#include "pipelines/resumable.h"

namespace grainfield::pipelines {

/// Frames that are rendered into an output and outlive a kill of the job.
///
/// Pictures of a folder stay as they are. A video that was not closed cannot be continued: its
/// counts are logged beside it (suffix `log_suffix`), as large as the film without compression, and
/// are encoded again by the run that goes on.
class KeptFrames {
 public:
    static constexpr const char* log_suffix = ".frames";

    /// `resumable` was started; with a log of that suffix the output is a video, else a folder. All
    /// three must outlive this. Throws InputError if the log is damaged.
    KeptFrames(Resumable& resumable, io::FrameWriter& writer, const io::FrameWriterOptions& options,
               bool is_video);

    /// Of the frames asked for, so many were done when the interrupted run was saved last; lost
    /// ones count.
    std::int64_t done() const { return done_; }
    /// Puts frame `index` of the output there from what was kept. False: it has to be rendered,
    /// since a picture was removed or damaged. Frames of a video come in order.
    bool restore(std::int64_t index);
    void write(const Frame& frame);
    /// `done` frames of those asked for will not be rendered again.
    void save(std::int64_t done);

 private:
    Resumable& resumable_;
    io::FrameWriter& writer_;
    io::FrameWriterOptions options_;
    bool is_video_;
    std::int64_t done_ = 0;
};

}  // namespace grainfield::pipelines
