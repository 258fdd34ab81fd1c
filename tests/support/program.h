#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/scratch_folder.h"

extern char** environ;

namespace grainfield::testing {

using Words = std::vector<std::string>;

inline std::string read_all(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// How a process ended and what it said.
struct Outcome {
    int code = -1;  ///< exit code; 128 + signal if it was killed
    std::string out;
    std::string err;
};

/// A process with captured output; the first word is the program.
class Process {
 public:
    explicit Process(Words words) {
        posix_spawn_file_actions_t files;
        posix_spawn_file_actions_init(&files);
        const int flags = O_WRONLY | O_CREAT | O_TRUNC;
        posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, (out_ / "out").c_str(), flags,
                                         0600);
        posix_spawn_file_actions_addopen(&files, STDERR_FILENO, (out_ / "err").c_str(), flags,
                                         0600);
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        const int failure = posix_spawnp(&pid_, argv[0], &files, nullptr, argv.data(), environ);
        posix_spawn_file_actions_destroy(&files);
        if (failure != 0) throw std::runtime_error("cannot start " + words.front());
    }

    void send(int signal) const { ::kill(pid_, signal); }

    /// Lets the program work for `time` once it handles `signal`, which would just end it before
    /// (a loaded machine may take seconds to start a program). A minute at most.
    void let_work(std::chrono::milliseconds time, int signal) const {
        for (int i = 0; i < 6000 && !handles(signal); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        std::this_thread::sleep_for(time);
    }

    /// Lets the program work until the condition is met, which is asked each millisecond. A minute
    /// at most.
    template <class Condition>
    void let_work_until(const Condition& is_met) const {
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
        while (!is_met() && std::chrono::steady_clock::now() < end) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }

    /// Lets the program work until there is such a file. A minute at most.
    void let_write(const std::filesystem::path& file) const {
        let_work_until([&] { return std::filesystem::exists(file); });
    }

    Outcome wait() const {
        int status = 0;
        ::waitpid(pid_, &status, 0);
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        return {code, read_all(out_ / "out"), read_all(out_ / "err")};
    }

 private:
    /// As Linux says it: the mask "SigCgt" in /proc/PID/status.
    bool handles(int signal) const {
        std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
        for (std::string word; status >> word;) {
            unsigned long long mask = 0;
            if (word == "SigCgt:" && status >> std::hex >> mask) {
                return ((mask >> (signal - 1)) & 1) != 0;
            }
        }
        return false;
    }

    ScratchFolder out_;
    pid_t pid_ = -1;
};

inline Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// The grainfield program of this build with these words.
inline Words program(Words words) {
    words.insert(words.begin(), GRAINFIELD_PROGRAM);
    return words;
}

/// Runs it to its end.
inline Outcome run_grainfield(Words words) {
    return Process(program(std::move(words))).wait();
}

/// Runs a line of shell; `$GRAINFIELD` is the program of this build.
inline Outcome shell(const std::string& line) {
    return Process(
               {"/bin/sh", "-c", std::string("GRAINFIELD='") + GRAINFIELD_PROGRAM + "'; " + line})
        .wait();
}

}  // namespace grainfield::testing
