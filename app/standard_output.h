#pragma once

#include <filesystem>
#include <string>

#include "app/session.h"

namespace grainfield::app {

/// The file that a command writes where its output is "-". It lies in a folder of its own, which is
/// removed with this object.
class StandardOutputFile {
 public:
    /// `name`: "camera.toml". Throws OutputError if there is no room for temporary files.
    explicit StandardOutputFile(const std::string& name);
    ~StandardOutputFile();
    StandardOutputFile(const StandardOutputFile&) = delete;
    StandardOutputFile& operator=(const StandardOutputFile&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// What was written into it, byte for byte.
    std::string text() const;

 private:
    std::filesystem::path path_;
};

/// Throws OptionError if the summary of `--json` would go to standard output too.
void require_no_json_beside(const Session& session);

}  // namespace grainfield::app
