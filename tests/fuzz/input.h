#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace grainfield::fuzz {

/// A file with the bytes of one input. Each process has one name for each suffix, and removes the
/// file at the end of its scope.
class Input {
 public:
    Input(std::string_view bytes, std::string_view suffix);
    ~Input();
    Input(const Input&) = delete;
    Input& operator=(const Input&) = delete;

    const std::filesystem::path& path() const { return path_; }

 private:
    std::filesystem::path path_;
};

/// Whether `work` ends without an Error. Throws std::logic_error if the Error does not say `name`.
bool is_taken(const std::string& name, const std::function<void()>& work);
inline bool is_taken(const Input& input, const std::function<void()>& work) {
    return is_taken(input.path().string(), work);
}

/// Throws std::logic_error with the promise that was broken.
void promise(bool is_kept, const char* what);

}  // namespace grainfield::fuzz
