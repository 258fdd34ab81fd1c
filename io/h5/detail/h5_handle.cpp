#include "io/h5/detail/h5_handle.h"

#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;

void set_up_library() {
    static const bool done = [] {
        H5dont_atexit();
        H5open();
        H5PLset_loading_state(0);
        H5Lunregister(H5L_TYPE_EXTERNAL);
        return true;
    }();
    static_cast<void>(done);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

// Keeps the text of a failed system call, which HDF5 writes as "error message = '…'".
herr_t find_system_message(unsigned, const H5E_error2_t* error, void* found) {
    constexpr std::string_view mark = "error message = '";
    const std::string_view text = error->desc != nullptr ? error->desc : "";
    const auto begin = text.find(mark);
    if (begin == std::string_view::npos) return 0;
    const auto end = text.find('\'', begin + mark.size());
    if (end == std::string_view::npos) return 0;
    *static_cast<std::string*>(found) = text.substr(begin + mark.size(), end - begin - mark.size());
    return 0;
}

std::string system_message() {
    std::string text;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, find_system_message, &text);
    return text;
}

H5Handle access_properties() {
    H5Handle properties(H5Pcreate(H5P_FILE_ACCESS));
    H5Pset_file_locking(properties.get(), false, true);
    // Any object left open must not keep the file open behind a close that seems to succeed.
    H5Pset_fclose_degree(properties.get(), H5F_CLOSE_STRONG);
    return properties;
}

H5Handle properties_to_create() {
    H5Handle properties = access_properties();
    // From this version on, headers carry checksums. The next would mark files of killed runs as
    // still open, which keeps readers out.
    H5Pset_libver_bounds(properties.get(), H5F_LIBVER_V18, H5F_LIBVER_V18);
    return properties;
}

}  // namespace

H5Handle::H5Handle(H5Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}

H5Handle& H5Handle::operator=(H5Handle&& other) noexcept {
    if (this != &other) {
        close();
        id_ = std::exchange(other.id_, H5I_INVALID_HID);
    }
    return *this;
}

bool H5Handle::close() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    // A file that is closed closes what is in it: such identifiers are no longer valid.
    if (id < 0 || H5Iis_valid(id) <= 0) return true;
    if (H5Iget_type(id) == H5I_FILE) return H5Fclose(id) >= 0;
    return H5Idec_ref(id) >= 0;
}

H5File::H5File(H5Handle handle, std::string name, bool writing, std::uint64_t bytes)
    : handle_(std::move(handle)), name_(std::move(name)), writing_(writing), bytes_(bytes) {}

H5File H5File::open(const fs::path& path) {
    set_up_library();
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::is_regular_file(status)) {
        throw InputError({.problem = fmt::format("cannot read '{}'", path.string()),
                          .actual = fs::is_directory(status) ? "a folder"
                                    : fs::exists(status)     ? "not a regular file"
                                                             : "no such file",
                          .expected = "an HDF5 file",
                          .suggestion = {}});
    }
    const std::uint64_t bytes = fs::file_size(path, error);
    H5Handle handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access_properties().get()));
    H5File file(std::move(handle), path.string(), false, error ? 0 : bytes);
    if (!file.handle_) file.fail("not an HDF5 file, or one that is cut off or damaged");
    return file;
}

H5File H5File::create(const fs::path& path, const std::string& name) {
    set_up_library();
    // The root without the time of its making, as all objects (h5_group.cpp).
    const H5Handle creation(H5Pcreate(H5P_FILE_CREATE));
    H5Pset_obj_track_times(creation.get(), false);
    H5Handle handle(
        H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), properties_to_create().get()));
    // What is read back while it is made has no size to be held against.
    constexpr std::uint64_t unbounded = std::uint64_t{1} << 62;
    H5File file(std::move(handle), name, true, unbounded);
    if (!file.handle_) file.fail("the file cannot be created");
    return file;
}

void H5File::fail(const std::string& what, const std::string& expected) const {
    const std::string system = system_message();
    H5Eclear2(H5E_DEFAULT);
    const std::string actual = system.empty() ? what : fmt::format("{} ({})", what, system);
    if (writing_) {
        throw OutputError({.problem = fmt::format("cannot write '{}'", name_),
                           .actual = actual,
                           .expected = expected,
                           .suggestion = system.empty()
                                             ? std::string()
                                             : "check the free space and quota of that disk"});
    }
    throw InputError({.problem = fmt::format("cannot read '{}'", name_),
                      .actual = actual,
                      .expected = expected,
                      .suggestion = {}});
}

H5Handle H5File::own(hid_t id, const char* what) const {
    if (id < 0) fail(what);
    return H5Handle(id);
}

void H5File::require(herr_t status, const char* what) const {
    if (status < 0) fail(what);
}

void H5File::require_plausible(double bytes, const std::string& what) const {
    constexpr double fill_allowance = 64.0 * 1024 * 1024;
    constexpr double best_compression = 1032;
    if (bytes <= fill_allowance + best_compression * static_cast<double>(bytes_)) return;
    fail(fmt::format("{} claims {:.3g} bytes in a file of {}", what, bytes, bytes_));
}

void H5File::flush() const {
    require(H5Fflush(id(), H5F_SCOPE_LOCAL), "the data cannot be flushed");
}

void H5File::close() {
    if (!handle_.close()) fail("the file cannot be closed");
}

}  // namespace grainfield::io
