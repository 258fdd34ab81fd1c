#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace grainfield::io {

/// What a run under way has stored so far: an append-only file of records beside its checkpoint. A
/// checkpoint notes the length; taking up the run again cuts off what came after it.
///
/// A record: u64 length, bytes, u32 CRC-32. Throws OutputError if the disk is full or the file
/// cannot be made, InputError if what is there is shorter than the checkpoint says or damaged.
class RecordLog {
 public:
    /// Keeps the first `bytes` of what is there; 0 starts afresh.
    RecordLog(std::filesystem::path path, std::int64_t bytes);
    ~RecordLog();
    RecordLog(const RecordLog&) = delete;
    RecordLog& operator=(const RecordLog&) = delete;

    void append(const std::vector<double>& numbers);
    std::int64_t count() const { return static_cast<std::int64_t>(starts_.size()); }
    std::vector<double> read(std::int64_t index) const;

    std::int64_t bytes() const { return bytes_; }
    /// Of the first `records`, which are at most count().
    std::int64_t bytes_of(std::int64_t records) const {
        return records < count() ? starts_.at(static_cast<std::size_t>(records)) : bytes_;
    }
    /// Brings it to the disk; before the checkpoint that notes its length.
    void sync();
    void remove();
    [[noreturn]] void fail_reading(const char* what) const;

 private:
    void find_records();
    void begin_sync();
    std::vector<char> bytes_at(std::int64_t start, std::size_t count) const;

    std::filesystem::path path_;
    int descriptor_ = -1;
    std::int64_t bytes_ = 0;
    std::int64_t begun_ = 0;  ///< those before are on their way to the disk
    std::vector<std::int64_t> starts_;
};

}  // namespace grainfield::io
