#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <hdf5.h>

namespace grainfield::io {

/// Owns one HDF5 identifier of any kind (file, group, dataset, space, type, property list).
class H5Handle {
 public:
    H5Handle() = default;
    explicit H5Handle(hid_t id) : id_(id) {}
    ~H5Handle() { close(); }
    H5Handle(H5Handle&& other) noexcept;
    H5Handle& operator=(H5Handle&& other) noexcept;

    hid_t get() const { return id_; }
    explicit operator bool() const { return id_ >= 0; }

    /// Gives the identifier back; false if the library says that this failed.
    bool close();

 private:
    hid_t id_ = H5I_INVALID_HID;
};

/// An HDF5 file that is open, and what every failure in it becomes: InputError for a file that is
/// read, OutputError for one that is written, naming the file.
///
/// Opening a file sets up the library for this process: it prints nothing, runs nothing at exit
/// (version 1.10 crashes there after a full disk), loads no filter plugins, and does not follow
/// links to other files.
class H5File {
 public:
    /// Throws InputError if the file is missing or not a complete HDF5 file.
    static H5File open(const std::filesystem::path& path);
    /// Makes an empty file at `path`, called `name` in messages; HDF5's own file lock is not used.
    static H5File create(const std::filesystem::path& path, const std::string& name);

    hid_t id() const { return handle_.get(); }
    const std::string& name() const { return name_; }
    std::uint64_t bytes() const { return bytes_; }  ///< on opening; all there can be if made

    /// `what` completes the sentence "cannot read|write 'file': …"; a failed system call that is
    /// behind it ("No space left on device") is added.
    [[noreturn]] void fail(const std::string& what, const std::string& expected = {}) const;
    /// Takes ownership of `id`; fails if it is not valid.
    H5Handle own(hid_t id, const char* what) const;
    void require(herr_t status, const char* what) const;

    /// Fails if `bytes` is more than a file of this size can hold, whatever it claims: deflate
    /// packs at most 1032:1, and 64 MiB of fill values are allowed on top.
    void require_plausible(double bytes, const std::string& what) const;

    void flush() const;
    void close();

 private:
    H5File(H5Handle handle, std::string name, bool writing, std::uint64_t bytes);

    H5Handle handle_;
    std::string name_;
    bool writing_;
    std::uint64_t bytes_;
};

}  // namespace grainfield::io
