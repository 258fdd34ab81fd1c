#include "app/output_name.h"

#include <cctype>
#include <string>
#include <system_error>

namespace grainfield::app {

bool is_folder_name(const std::filesystem::path& output) {
    std::error_code unreachable;
    if (output.filename().empty() || std::filesystem::is_directory(output, unreachable)) {
        return true;
    }
    const std::string extension = output.extension().string();
    return extension.size() < 2 || std::isalpha(static_cast<unsigned char>(extension[1])) == 0;
}

}  // namespace grainfield::app
