#pragma once

#include <stdexcept>
#include <string>

namespace grainfield {

/// The four things a user needs to know about a failure; empty parts are left out.
struct ErrorText {
    std::string problem;     ///< names the file or option: "cannot read 'x.tif'"
    std::string actual;      ///< the value found: "width 640"
    std::string expected;    ///< what was expected: "1600, as in frame 0"
    std::string suggestion;  ///< what to do: "remove the file or start a new run"

    /// "problem: actual; expected …; suggestion."
    std::string message() const;
};

/// Base of everything grainfield throws. Only `main` prints it and maps it to an exit code.
class Error : public std::runtime_error {
 public:
    explicit Error(const ErrorText& text) : std::runtime_error(text.message()) {}
    explicit Error(const std::string& message) : std::runtime_error(message) {}
};

/// Wrong usage or configuration (exit code 2).
class OptionError : public Error {
 public:
    using Error::Error;
};

/// Input that is missing, unreadable or not what it claims to be (exit code 3).
class InputError : public Error {
 public:
    using Error::Error;
};

/// Output that cannot be written: permissions, disk full, file in use (exit code 4).
class OutputError : public Error {
 public:
    using Error::Error;
};

/// A physics check that failed: overlap, stalled clock, validation threshold (exit code 5).
class PhysicsError : public Error {
 public:
    using Error::Error;
};

/// The user asked to stop; what was done is kept (exit code 130 or 143).
class Interrupted : public Error {
 public:
    Interrupted(int signal, const std::string& message) : Error(message), signal_(signal) {}
    int signal() const { return signal_; }

 private:
    int signal_;
};

}  // namespace grainfield
