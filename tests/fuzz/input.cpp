#include "tests/fuzz/input.h"

#include <fstream>
#include <stdexcept>
#include <system_error>

#include <unistd.h>

#include "core/errors.h"

namespace grainfield::fuzz {

namespace fs = std::filesystem;

Input::Input(std::string_view bytes, std::string_view suffix)
    : path_(fs::temp_directory_path() /
            ("grainfield-fuzz-" + std::to_string(getpid()) + std::string(suffix))) {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path_.string());
}

Input::~Input() {
    std::error_code ignored;
    fs::remove(path_, ignored);
}

bool is_taken(const std::string& name, const std::function<void()>& work) {
    try {
        work();
        return true;
    } catch (const Error& error) {
        if (std::string_view(error.what()).find(name) != std::string_view::npos) return false;
        throw std::logic_error(std::string("refused without the name of the file: ") +
                               error.what());
    }
}

void promise(bool is_kept, const char* what) {
    if (!is_kept) throw std::logic_error(std::string("a promise is broken: ") + what);
}

}  // namespace grainfield::fuzz
