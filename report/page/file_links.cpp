#include "report/page/file_links.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

namespace grainfield::report {

namespace {

std::string percent_encoded(std::string_view path) {
    std::string out;
    for (char c : path) {
        const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
                           (c >= 'a' && c <= 'z') ||
                           std::string_view("-._~/").find(c) != std::string_view::npos;
        out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return out;
}

}  // namespace

std::string file_links(const PageContent& content, const std::string& name) {
    std::string links;
    for (const char* kind : {"svg", "pdf", "csv"}) {
        const std::string file = name + "." + kind;
        if (std::ranges::find(content.files, file) == content.files.end()) continue;
        links += fmt::format("{}<a href=\"{}\">{}</a>", links.empty() ? "" : " · ",
                             percent_encoded("./" + content.files_folder + "/" + file), file);
    }
    return links.empty() ? "" : "<p class=\"files\">" + links + "</p>\n";
}

}  // namespace grainfield::report
