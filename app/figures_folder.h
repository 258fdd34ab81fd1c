#pragma once

#include <filesystem>

#include "io/output_file.h"

namespace grainfield::app {

/// Where the figures of a page go: NAME_files beside NAME.html.
std::filesystem::path figures_folder(const std::filesystem::path& html);

/// The folder of the figures: refused if it is there already, and removed again, unless it was
/// there before, when the report does not come about.
class FiguresFolder {
 public:
    /// Throws OutputError if the folder exists and may not be overwritten.
    FiguresFolder(std::filesystem::path path, io::Overwrite overwrite);
    ~FiguresFolder();
    FiguresFolder(const FiguresFolder&) = delete;
    FiguresFolder& operator=(const FiguresFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    void keep() { kept_ = true; }

 private:
    std::filesystem::path path_;
    bool is_new_;
    bool kept_ = false;
};

}  // namespace grainfield::app
