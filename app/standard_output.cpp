#include "app/standard_output.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "core/errors.h"

namespace grainfield::app {

namespace fs = std::filesystem;

StandardOutputFile::StandardOutputFile(const std::string& name) {
    std::string folder = (fs::temp_directory_path() / "grainfield-XXXXXX").string();
    if (::mkdtemp(folder.data()) == nullptr) {
        throw OutputError({.problem = "cannot make a folder for what goes to standard output",
                           .actual = std::strerror(errno),
                           .expected = "room in the folder for temporary files (TMPDIR)",
                           .suggestion = {}});
    }
    path_ = fs::path(folder) / name;
}

StandardOutputFile::~StandardOutputFile() {
    std::error_code ignored;
    fs::remove_all(path_.parent_path(), ignored);
}

std::string StandardOutputFile::text() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void require_no_json_beside(const Session& session) {
    if (!session.common.json) return;
    throw OptionError({.problem = "--json and -o - both write to standard output",
                       .actual = {},
                       .expected = "one of them",
                       .suggestion = {}});
}

}  // namespace grainfield::app
