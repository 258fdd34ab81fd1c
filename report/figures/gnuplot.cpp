#include "report/figures/gnuplot.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace grainfield::report {

namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// An unlinked temporary file: no pipe, so no deadlock and no SIGPIPE.
File temporary_file() {
    File file(std::tmpfile());
    if (file) fcntl(fileno(file.get()), F_SETFD, FD_CLOEXEC);
    return file;
}

std::string read_back(std::FILE* file) {
    std::array<char, 500> text{};
    std::rewind(file);
    return {text.data(), std::fread(text.data(), 1, text.size(), file)};
}

}  // namespace

Gnuplot::Outcome Gnuplot::run(const std::string& script,
                              const std::filesystem::path& folder) const {
    const File input = temporary_file();
    const File errors = temporary_file();
    if (!input || !errors ||
        std::fwrite(script.data(), 1, script.size(), input.get()) != script.size() ||
        std::fflush(input.get()) != 0) {
        return {true, false, std::string("cannot write a temporary file: ") + std::strerror(errno)};
    }
    std::rewind(input.get());

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, fileno(input.get()), STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, fileno(errors.get()), STDERR_FILENO);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    std::string no_user_files = "--default-settings";
    std::string standard_input = "-";
    std::array<char*, 4> arguments{const_cast<char*>(program_.c_str()), no_user_files.data(),
                                   standard_input.data(), nullptr};
    pid_t child = 0;
    const int problem =
        posix_spawnp(&child, program_.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (problem != 0) return {false, false, std::strerror(problem)};

    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    const bool ended_well = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    return {true, ended_well, read_back(errors.get())};
}

}  // namespace grainfield::report
