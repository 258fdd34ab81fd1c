#include "io/text/text_output.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::io {

TextOutput::TextOutput(std::filesystem::path path, Overwrite overwrite)
    : file_(std::move(path), overwrite),
      stream_(file_.temporary(), std::ios::binary | std::ios::trunc) {
    if (!stream_) fail();
}

void TextOutput::fail() const {
    throw OutputError({.problem = fmt::format("cannot write '{}'", file_.target().string()),
                       .actual = std::generic_category().message(errno),
                       .expected = {},
                       .suggestion = "check the free space and quota of that disk"});
}

void TextOutput::write(const std::string& text) {
    if (!stream_.write(text.data(), static_cast<std::streamsize>(text.size()))) fail();
}

void TextOutput::commit() {
    stream_.close();
    if (!stream_) fail();
    file_.commit();
}

}  // namespace grainfield::io
