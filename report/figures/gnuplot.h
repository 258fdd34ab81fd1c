#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace grainfield::report {

/// The plotting program gnuplot, run as a child process without a shell and without the user's
/// start-up files.
class Gnuplot {
 public:
    explicit Gnuplot(std::string program = "gnuplot") : program_(std::move(program)) {}

    struct Outcome {
        bool started = false;    ///< false: there is no such program
        bool succeeded = false;  ///< ended with exit code 0
        std::string message;     ///< what it wrote to standard error, first 500 characters
    };

    /// Runs the script in the folder and waits for its end.
    Outcome run(const std::string& script, const std::filesystem::path& folder) const;

 private:
    std::string program_;
};

}  // namespace grainfield::report
