#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "core/support/output_file.h"

namespace grainfield::io {

/// A text file that appears under its name when it is complete. Throws OutputError.
class TextOutput {
 public:
    TextOutput(std::filesystem::path path, Overwrite overwrite);

    void write(const std::string& text);
    void commit();

 private:
    [[noreturn]] void fail() const;

    OutputFile file_;
    std::ofstream stream_;
};

}  // namespace grainfield::io
