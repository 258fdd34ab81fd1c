#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace grainfield::io {

/// What a stream of frames that are not compressed looks like.
struct RawFormat {
    int width = 0;                 ///< [px]
    int height = 0;                ///< [px]
    int bit_depth = 8;             ///< above 8 a count has two bytes, the low one first
    std::optional<double> fps;     ///< [1/s]; empty: not known
    std::size_t chroma_bytes = 0;  ///< of a frame, after the counts: skipped

    std::size_t count_bytes() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
               (bit_depth > 8 ? 2 : 1);
    }
};

/// How reading one frame ended.
enum class RawRead {
    frame,    ///< the counts are there
    ended,    ///< no more will come
    damaged,  ///< no more can be made out; damage() says why
    stopped,  ///< because the caller wanted it
};

/// How long nothing may come.
struct SilenceLimit {
    double longest = 0;            ///< [s], then it is damage; 0: waits for ever
    double noted = 0;              ///< [s], then `note` is called, once; 0: never
    std::function<void()> note{};  ///< in the thread that reads
};

/// Frames that are not compressed, one after the other: on standard input, in a FIFO, or from a
/// program that writes them.
///
/// The stream says itself what it holds (YUV4MPEG2 of mono, mono9 … mono16, or planar YUV, whose Y
/// plane is taken), or the format is given and frames follow one another without a header. Waiting
/// ends within a tenth of a second when `is_stopped` says so; it is called in the thread that
/// reads.
class RawStream {
 public:
    using IsStopped = std::function<bool()>;

    /// `source`: "-" or the path of a FIFO. Waits for the header where no format is given. Throws
    /// InputError if the source is neither, or what it says of itself is no such format, or a frame
    /// would have more than `max_pixels`, or the header does not come in time; Interrupted if it is
    /// stopped. `silence` counts from now: a FIFO that nobody opens is silent.
    RawStream(const std::string& source, const std::optional<RawFormat>& given,
              std::int64_t max_pixels, const IsStopped& is_stopped, SilenceLimit silence = {});
    /// From the standard output of a program, by its words; `source` is its name in messages. A
    /// line "ERROR text" in the place of the header becomes an InputError, in the place of a frame
    /// damage; so does the end of a program that failed. Signals of the terminal do not reach it.
    RawStream(const std::vector<std::string>& program, const std::string& source,
              std::int64_t max_pixels, const IsStopped& is_stopped, SilenceLimit silence = {});
    /// Ends the program.
    ~RawStream();
    RawStream(const RawStream&) = delete;
    RawStream& operator=(const RawStream&) = delete;

    bool is_silent() const { return is_silent_; }

    const RawFormat& format() const { return format_; }
    const std::string& name() const { return name_; }
    /// Replaces `counts` by the bytes of the next frame.
    RawRead next(std::vector<std::uint8_t>& counts, const IsStopped& is_stopped);
    /// "byte 8192: 17 bytes of a frame that has 4096"
    const std::string& damage() const { return damage_; }

 private:
    void begin(const std::optional<RawFormat>& given, std::int64_t max_pixels,
               const IsStopped& is_stopped);
    std::size_t read_some(std::uint8_t* to, std::size_t count, const IsStopped& is_stopped);
    bool read_line(std::string& line, const IsStopped& is_stopped);
    RawRead frame_line(const IsStopped& is_stopped);
    std::string failure_at_end();
    RawRead damaged(std::string why);
    RawRead ended();
    std::string silence() const;

    std::string name_;
    int descriptor_ = -1;
    pid_t program_ = -1;
    bool has_header_ = false;
    bool was_stopped_ = false;
    SilenceLimit limit_;
    bool is_silent_ = false;
    bool is_noted_ = false;
    std::uint64_t offset_ = 0;  ///< bytes read so far
    std::vector<std::uint8_t> skipped_;
    RawFormat format_;
    std::string damage_;
    std::string read_failure_;
};

/// The format that the first line of a YUV4MPEG2 stream declares, without its line end. Throws
/// InputError, naming `source`, if there is none.
RawFormat yuv4mpeg_format(const std::string& line, const std::string& source);

}  // namespace grainfield::io
