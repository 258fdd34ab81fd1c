#include "report/page/copy_block.h"

#include <algorithm>

#include "report/text.h"

namespace grainfield::report {

namespace {

// With its lines, which escape_html joins.
std::string escaped_lines(const std::string& text) {
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        out += escape_html(text.substr(at, end - at)) + "\n";
        at = end + 1;
    }
    return out;
}

}  // namespace

std::string blocks_html(const std::vector<CopyBlock>& blocks) {
    if (blocks.empty()) return "";
    std::string out = "<div class=\"blocks\">\n";
    for (const CopyBlock& block : blocks) {
        out += "<section><h3>" + escape_html(block.title) +
               "</h3>\n<button type=\"button\" class=\"copy\">Copy</button><pre tabindex=\"0\">" +
               escaped_lines(block.text) + "</pre>\n";
        if (!block.note.empty()) out += "<p class=\"note\">" + escape_html(block.note) + "</p>\n";
        out += "</section>\n";
    }
    return out + "</div>\n";
}

}  // namespace grainfield::report
