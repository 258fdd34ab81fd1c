#pragma once

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace grainfield::testing {

/// A FIFO, and what writes to it as a camera's program would.
class Fifo {
 public:
    explicit Fifo(std::string path) : path_(std::move(path)) { ::mkfifo(path_.c_str(), 0600); }
    ~Fifo() { close(); }
    Fifo(const Fifo&) = delete;
    Fifo& operator=(const Fifo&) = delete;

    const std::string& path() const { return path_; }

    /// Waits until it is read. False: nobody reads any more, or nobody began to within a minute.
    bool write(const std::string& bytes) {
        if (end_ < 0 && !open_end()) return false;
        std::size_t done = 0;
        while (done < bytes.size()) {
            const ssize_t count = ::write(end_, bytes.data() + done, bytes.size() - done);
            if (count <= 0) return false;
            done += static_cast<std::size_t>(count);
        }
        return true;
    }
    void close() {
        if (end_ >= 0) ::close(end_);
        end_ = -1;
    }

 private:
    bool open_end() {
        for (int i = 0; i < 6000; ++i) {
            end_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
            if (end_ >= 0) return ::fcntl(end_, F_SETFL, 0) == 0;  // from now on it waits
            if (errno != ENXIO) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }

    std::string path_;
    int end_ = -1;
};

inline std::string yuv4mpeg_header(int width, int height, const std::string& space,
                                   const std::string& rate = "25:1") {
    return fmt::format("YUV4MPEG2 W{} H{} F{} Ip A1:1 C{}\n", width, height, rate, space);
}

/// Counts as bytes; two a count above 8 bit, the low one first.
inline std::string raw_bytes(const std::vector<std::uint16_t>& counts, int bit_depth) {
    std::string bytes;
    for (const std::uint16_t count : counts) {
        bytes.push_back(static_cast<char>(count & 0xffU));
        if (bit_depth > 8) bytes.push_back(static_cast<char>(count >> 8U));
    }
    return bytes;
}

}  // namespace grainfield::testing
