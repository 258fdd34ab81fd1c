#include "pipelines/render/kept_frames.h"

#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "core/errors.h"

namespace grainfield::pipelines {

namespace {

constexpr const char* done_key = "frames done";

using Bytes = std::vector<std::uint8_t>;

// The log holds numbers of eight bytes and keeps every bit of them.
std::vector<double> packed(const Bytes& bytes) {
    std::vector<double> numbers((bytes.size() + sizeof(double) - 1) / sizeof(double));
    std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return numbers;
}

Bytes unpacked(const std::vector<double>& numbers, std::size_t size) {
    Bytes bytes(sizeof(double) * numbers.size());
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    // What is left of the last number; a record of another length is refused by image_of.
    if (bytes.size() > size && bytes.size() - size < sizeof(double)) bytes.resize(size);
    return bytes;
}

}  // namespace

KeptFrames::KeptFrames(Resumable& resumable, io::FrameWriter& writer,
                       const io::FrameWriterOptions& options, bool is_video)
    : resumable_(resumable), writer_(writer), options_(options), is_video_(is_video) {
    if (resumable.from() == nullptr) {
        // A folder with pictures in it is only written to by a run that may go on.
        if (!is_video) save(0);
        return;
    }
    const auto found = resumable.from()->integers.find(done_key);
    if (found == resumable.from()->integers.end() || found->second.size() != 1) {
        throw InputError(
            {.problem = "cannot go on from '" + resumable.checkpoint_path().string() + "'",
             .actual = "it does not say how many frames were done",
             .expected = {},
             .suggestion = "start the run anew"});
    }
    done_ = found->second.front();
}

bool KeptFrames::restore(std::int64_t index) {
    if (!is_video_) return writer_.holds(index);
    const auto pixels =
        static_cast<std::size_t>(options_.width) * static_cast<std::size_t>(options_.height);
    const std::size_t size = options_.bit_depth <= 8 ? pixels : 2 * pixels;
    Frame frame;
    frame.index = index;
    frame.bit_depth = options_.bit_depth;
    frame.image = io::image_of(unpacked(resumable_.log().read(index), size), options_);
    writer_.write(frame);
    return true;
}

void KeptFrames::write(const Frame& frame) {
    writer_.write(frame);
    if (is_video_) resumable_.log().append(packed(io::counts_of(frame, options_)));
}

void KeptFrames::save(std::int64_t done) {
    Checkpoint state;
    state.integers[done_key] = {done};
    resumable_.save(std::move(state));
}

}  // namespace grainfield::pipelines
