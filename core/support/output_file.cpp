#include "core/support/output_file.h"

#include <cerrno>
#include <cstdio>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/errors.h"
#include "core/support/left_output.h"

namespace grainfield {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& target, const std::string& actual,
                         const std::string& suggestion) {
    throw OutputError({.problem = fmt::format("cannot write '{}'", target.string()),
                       .actual = actual,
                       .expected = {},
                       .suggestion = suggestion});
}

[[noreturn]] void refuse_existing(const fs::path& target) {
    refuse(target, "the file exists already", "give another name, or option 'force' to replace it");
}

std::string system_text(int error) {
    return std::generic_category().message(error);
}

fs::path folder_of(const fs::path& target) {
    return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

[[noreturn]] void refuse_unopened(const fs::path& target, int error) {
    const std::string folder = folder_of(target).string();
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) {
        refuse(target, fmt::format("there is no folder '{}'", folder),
               fmt::format("make it with: mkdir -p '{}'", folder));
    }
    if (error == ELOOP) {
        refuse(target, "a symbolic link stands in the place of its temporary file",
               "remove the link, or give another name");
    }
    // As in /proc: the folder is there, but the system makes no files in it.
    refuse(target,
           fmt::format("folder '{}': {}", folder,
                       error == ENOENT ? "files cannot be made in it" : system_text(error)),
           "choose a folder in which you may write");
}

bool is_same_file(int descriptor, const fs::path& path) {
    struct stat open_file {};
    struct stat named_file {};
    return ::fstat(descriptor, &open_file) == 0 && ::stat(path.c_str(), &named_file) == 0 &&
           open_file.st_dev == named_file.st_dev && open_file.st_ino == named_file.st_ino;
}

// Between opening and locking, another run may have renamed or removed the file: then try again.
int open_and_lock(const fs::path& target, const fs::path& temporary) {
    for (;;) {
        constexpr int flags = O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW;
        const int descriptor = ::open(temporary.c_str(), flags, 0666);
        if (descriptor < 0) refuse_unopened(target, errno);
        if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            ::close(descriptor);
            refuse(target, fmt::format("another run is writing it ('{}')", temporary.string()),
                   "wait until it is done, or give another name");
        }
        if (is_same_file(descriptor, temporary)) return descriptor;
        ::close(descriptor);
    }
}

void sync_folder(const fs::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

// 0, or the error number; never replaces an existing file if that is refused.
int rename_to(const fs::path& from, const fs::path& to, Overwrite overwrite) {
    if (overwrite == Overwrite::refuse) {
        if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) {
            return 0;
        }
        if (errno != EINVAL && errno != ENOSYS) return errno;
        std::error_code ignored;
        if (fs::exists(fs::symlink_status(to, ignored))) return EEXIST;
    }
    return std::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

/// The temporaries of this process. Never destroyed: outputs may be closed while it exits.
struct Unfinished {
    std::recursive_mutex mutex;
    std::set<fs::path> temporaries;
};

Unfinished& unfinished() {
    static auto* const outputs = new Unfinished;
    return *outputs;
}

}  // namespace

OutputFile::OutputFile(fs::path target, Overwrite overwrite)
    : target_(std::move(target)), temporary_(target_), overwrite_(overwrite) {
    temporary_ += ".partial";
    std::error_code error;
    const fs::file_status status = fs::symlink_status(target_, error);
    if (target_.filename().empty() || fs::is_directory(fs::status(target_, error))) {
        refuse(target_, "this is a folder", "give the name of a file in it");
    }
    if (fs::exists(status) && overwrite_ == Overwrite::refuse) refuse_existing(target_);
    if (fs::exists(fs::status(target_, error)) && !fs::is_regular_file(target_, error)) {
        refuse(target_, "this is a device or a pipe", "give the name of a file");
    }
    descriptor_ = open_and_lock(target_, temporary_);
    if (::ftruncate(descriptor_, 0) != 0) {
        const int reason = errno;
        ::close(descriptor_);
        refuse(target_, system_text(reason), "check the disk");
    }
    const std::lock_guard lock(unfinished().mutex);
    unfinished().temporaries.insert(temporary_);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::move(other.temporary_)),
      overwrite_(other.overwrite_),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

OutputFile::~OutputFile() {
    if (descriptor_ < 0) return;
    const std::lock_guard lock(unfinished().mutex);
    if (unfinished().temporaries.erase(temporary_) > 0) ::unlink(temporary_.c_str());
    ::close(descriptor_);
}

void OutputFile::commit() {
    if (::fsync(descriptor_) != 0) {
        refuse(target_, system_text(errno), "check the free space and quota of that disk");
    }
    int error = 0;
    {
        const std::lock_guard lock(unfinished().mutex);
        error = rename_to(temporary_, target_, overwrite_);
        if (error == 0) unfinished().temporaries.erase(temporary_);
    }
    if (error == EEXIST) refuse_existing(target_);
    if (error != 0) refuse(target_, system_text(error), "check the folder's permissions");
    sync_folder(folder_of(target_));
    ::close(std::exchange(descriptor_, -1));
}

void write_file(const fs::path& target, std::string_view content, Overwrite overwrite) {
    OutputFile output(target, overwrite);
    std::FILE* file = std::fopen(output.temporary().c_str(), "wb");
    int error = file == nullptr ? errno : 0;
    if (file != nullptr) {
        if (std::fwrite(content.data(), 1, content.size(), file) != content.size()) error = errno;
        if (std::fclose(file) != 0 && error == 0) error = errno;
    }
    if (error != 0) {
        refuse(target, system_text(error), "check the free space and quota of that disk");
    }
    output.commit();
}

void leave_temporary(const fs::path& temporary) {
    const std::lock_guard lock(unfinished().mutex);
    unfinished().temporaries.erase(temporary);
}

std::size_t abandon_outputs() {
    Unfinished& outputs = unfinished();
    // Kept until the process ends: nothing may be renamed after this.
    outputs.mutex.lock();
    for (const fs::path& temporary : outputs.temporaries) ::unlink(temporary.c_str());
    return outputs.temporaries.size();
}

}  // namespace grainfield
