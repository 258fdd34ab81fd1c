#include "app/figures_folder.h"

#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::app {

namespace {

bool is_there(const std::filesystem::path& path) {
    std::error_code unreachable;
    return std::filesystem::exists(path, unreachable);
}

}  // namespace

std::filesystem::path figures_folder(const std::filesystem::path& html) {
    return html.parent_path() / (html.stem().string() + "_files");
}

FiguresFolder::FiguresFolder(std::filesystem::path path, io::Overwrite overwrite)
    : path_(std::move(path)), is_new_(!is_there(path_)) {
    if (is_new_ || overwrite == io::Overwrite::force) return;
    throw OutputError({.problem = fmt::format("output folder '{}' exists", path_.string()),
                       .actual = {},
                       .expected = {},
                       .suggestion = "give --force to write into it, or --no-figures"});
}

FiguresFolder::~FiguresFolder() {
    std::error_code ignored;
    if (is_new_ && !kept_) std::filesystem::remove_all(path_, ignored);
}

}  // namespace grainfield::app
