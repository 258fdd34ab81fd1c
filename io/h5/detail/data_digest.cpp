#include "io/h5/detail/data_digest.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "core/support/interrupt.h"

namespace grainfield::io {

namespace {

using nlohmann::json;

bool is_left_out(const std::string& name) {
    return name == "record" || name == "sources";
}

// Without what runs of the same data may say differently.
void strip(json& text) {
    if (text.is_object()) {
        text.erase("seconds");
        text.erase("threads");
        text.erase("label");
        if (text.contains("source") && text["source"].is_string()) text.erase("source");
    }
    if (!text.is_structured()) return;
    for (json& part : text) strip(part);
}

void add_text(const H5Group& group, const std::string& name, DataDigest& digest) {
    const std::string text = group.text(name);
    json parsed = json::parse(text, nullptr, false);
    if (parsed.is_discarded()) {
        digest.add(text);
        return;
    }
    strip(parsed);
    digest.add(parsed.dump(-1, ' ', false, json::error_handler_t::replace));
}

// What is read at once [B]. Row by row a chunk of many short rows would be read for each of them.
constexpr double read_at_once = 64.0 * 1024 * 1024;

template <class T>
void add_numbers(const H5Dataset& data, DataDigest& digest) {
    const H5Extent extent = data.extent();
    double bytes = sizeof(T);
    for (const hsize_t length : extent) {
        digest.add(std::uint64_t{length});
        bytes *= static_cast<double>(length);
    }
    if (extent.size() < 2 || bytes <= read_at_once) {
        const std::vector<T> values = data.read<T>();
        digest.add(std::as_bytes(std::span(values)));
        return;
    }
    for (hsize_t row = 0; row < extent[0]; ++row) {
        throw_if_interrupted("reading for the fingerprint");
        const std::vector<T> values = data.read_row<T>(row);
        digest.add(std::as_bytes(std::span(values)));
    }
}

void add_group(const H5Group& group, DataDigest& digest) {
    for (const std::string& name : group.names()) {
        if (is_left_out(name)) continue;
        digest.add(name);
        if (group.has_group(name)) {
            add_group(group.group(name), digest);
            continue;
        }
        const H5Dataset data = group.dataset(name);
        switch (data.kind()) {
            case NumberKind::integer:
                add_numbers<std::int64_t>(data, digest);
                break;
            case NumberKind::real:
                add_numbers<double>(data, digest);
                break;
            case NumberKind::none:
                add_text(group, name, digest);
        }
    }
    digest.add(std::string_view("end of group"));
}

}  // namespace

void DataDigest::mix(std::uint64_t word) {
    word *= 0x87c37b91114253d5;
    word = std::rotl(word, 31) * 0x4cf5ad432745937f;
    state_ = std::rotl(state_ ^ word, 27) * 5 + 0x52dce729;
    length_ += 8;
}

void DataDigest::add(std::span<const std::byte> bytes) {
    constexpr std::size_t word_bytes = sizeof(std::uint64_t);
    for (std::size_t i = 0; i < bytes.size(); i += word_bytes) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes.data() + i, std::min(word_bytes, bytes.size() - i));
        mix(word);
    }
    mix(bytes.size());
}

void DataDigest::add(std::string_view text) {
    add(std::as_bytes(std::span(text.data(), text.size())));
}

std::string DataDigest::text() const {
    std::uint64_t h = state_ ^ length_;
    h = (h ^ (h >> 33)) * 0xff51afd7ed558ccd;
    h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53;
    return fmt::format("{:016x}", h ^ (h >> 33));
}

std::string digest_of(const H5Group& group) {
    DataDigest digest;
    add_group(group, digest);
    return digest.text();
}

void store_digest(const H5File& file) {
    if (caught_signal() != 0) return;
    file.flush();
    const H5Group root = H5Group::root(file);
    std::string digest;
    try {
        digest = digest_of(root);
    } catch (const Interrupted&) {
        return;
    }
    root.set_attribute(digest_name, digest);
}

}  // namespace grainfield::io
