#include "io/h5/detail/h5_storage.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

namespace grainfield::io {

namespace {

constexpr std::size_t checksum_bytes = 4;
constexpr hsize_t most_listed_chunks = 4096;

double product(const H5Extent& extent) {
    return std::accumulate(extent.begin(), extent.end(), 1.0,
                           [](double p, hsize_t n) { return p * static_cast<double>(n); });
}

/// How long `deflated` becomes; nothing if it is damaged or longer than `most`.
std::optional<std::size_t> inflated_bytes(const std::vector<Bytef>& deflated, std::size_t size,
                                          std::size_t most) {
    z_stream stream{};
    if (inflateInit(&stream) != Z_OK) return std::nullopt;
    stream.next_in = const_cast<Bytef*>(deflated.data());
    stream.avail_in = static_cast<uInt>(size);
    std::vector<Bytef> piece(std::size_t{1} << 16U);
    std::size_t bytes = 0;
    int code = Z_OK;
    while (code == Z_OK && bytes <= most) {
        stream.next_out = piece.data();
        stream.avail_out = static_cast<uInt>(piece.size());
        code = inflate(&stream, Z_NO_FLUSH);
        bytes += piece.size() - stream.avail_out;
    }
    inflateEnd(&stream);
    if (code != Z_STREAM_END) return std::nullopt;
    return bytes;
}

class ChunkedStorage {
 public:
    ChunkedStorage(const H5File& file, hid_t dataset, const std::string& path,
                   const H5Handle& properties, std::size_t entry_bytes)
        : file_(file), dataset_(dataset), path_(path) {
        H5Extent chunk(H5S_MAX_RANK);
        const int rank = H5Pget_chunk(properties.get(), H5S_MAX_RANK, chunk.data());
        if (rank < 1) fail();
        chunk_.assign(chunk.begin(), chunk.begin() + rank);
        const double bytes = product(chunk_) * static_cast<double>(entry_bytes);
        file_.require_plausible(bytes, path_);
        chunk_bytes_ = static_cast<std::size_t>(bytes);
        if (chunk_bytes_ == 0) fail();
        read_filters(properties);
    }

    void require_sound(const H5Extent& start, const H5Extent& count) {
        if (chunk_.size() != start.size()) fail();
        if (filters_.empty() && has_many_chunks()) return require_sum();
        H5Extent at = first_chunk(start);
        for (;;) {
            filters_.empty() ? require_plain_chunk(at) : require_filtered_chunk(at);
            std::size_t axis = at.size();
            while (axis-- > 0) {
                at[axis] += chunk_[axis];
                if (at[axis] < start[axis] + count[axis]) break;
                at[axis] = first_chunk(start)[axis];
                if (axis == 0) return;
            }
        }
    }

 private:
    [[noreturn]] void fail() const { file_.fail(fmt::format("{} is damaged", path_)); }

    void read_filters(const H5Handle& properties) {
        const int filters = H5Pget_nfilters(properties.get());
        for (unsigned i = 0; i < static_cast<unsigned>(std::max(filters, 0)); ++i) {
            unsigned flags = 0;
            std::size_t values = 0;
            const H5Z_filter_t filter =
                H5Pget_filter2(properties.get(), i, &flags, &values, nullptr, 0, nullptr, nullptr);
            if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE &&
                filter != H5Z_FILTER_FLETCHER32) {
                file_.fail(fmt::format("{} is packed with the HDF5 filter {}", path_, filter),
                           "gzip, shuffle, fletcher32 or none");
            }
            filters_.push_back(filter);
        }
    }

    H5Extent first_chunk(const H5Extent& start) const {
        H5Extent first(start.size());
        for (std::size_t i = 0; i < start.size(); ++i) first[i] = start[i] / chunk_[i] * chunk_[i];
        return first;
    }

    hsize_t chunks() const {
        const H5Handle space = file_.own(H5Dget_space(dataset_), "a dataset has no extent");
        hsize_t chunks = 0;
        file_.require(H5Dget_num_chunks(dataset_, space.get(), &chunks), "a dataset is damaged");
        return chunks;
    }

    bool has_many_chunks() const { return chunks() > most_listed_chunks; }

    void require_sum() const {
        if (H5Dget_storage_size(dataset_) != chunks() * chunk_bytes_) fail();
    }

    void require_plain_chunk(const H5Extent& at) const {
        unsigned skipped = 0;
        haddr_t address = HADDR_UNDEF;
        hsize_t bytes = 0;
        if (H5Dget_chunk_info_by_coord(dataset_, at.data(), &skipped, &address, &bytes) < 0) fail();
        if (address != HADDR_UNDEF && bytes != chunk_bytes_) fail();
    }

    void require_filtered_chunk(const H5Extent& at) {
        hsize_t bytes = 0;
        // Version 1.10 also fails where a chunk was never written and holds fill values only.
        if (H5Dget_chunk_storage_size(dataset_, at.data(), &bytes) < 0 || bytes == 0) return;
        if (bytes > file_.bytes()) fail();
        raw_.resize(static_cast<std::size_t>(bytes));
        std::uint32_t skipped = 0;
        if (H5Dread_chunk(dataset_, H5P_DEFAULT, at.data(), &skipped, raw_.data()) < 0) fail();
        if (unpacked_bytes(skipped) != chunk_bytes_) fail();
    }

    // The last filter of the list was the last to be applied.
    std::size_t unpacked_bytes(std::uint32_t skipped) const {
        std::size_t size = raw_.size();
        bool inflated = false;
        for (std::size_t i = filters_.size(); i-- > 0;) {
            if (((skipped >> i) & 1U) != 0) continue;
            if (filters_[i] == H5Z_FILTER_FLETCHER32) {
                if (size < checksum_bytes) fail();
                size -= checksum_bytes;
            } else if (filters_[i] == H5Z_FILTER_DEFLATE) {
                // Ours is deflated once; packing what is packed hides its length from this check.
                if (inflated) fail();
                inflated = true;
                const auto bytes = inflated_bytes(raw_, size, chunk_bytes_ + checksum_bytes);
                if (!bytes) fail();
                size = *bytes;
            }
        }
        return size;
    }

    const H5File& file_;
    hid_t dataset_;
    std::string path_;
    H5Extent chunk_;
    std::size_t chunk_bytes_ = 0;
    std::vector<H5Z_filter_t> filters_;
    std::vector<Bytef> raw_;
};

}  // namespace

void require_sound_storage(const H5File& file, hid_t dataset, const std::string& path,
                           const H5Extent& start, const H5Extent& count) {
    if (product(count) == 0) return;
    const H5Handle properties =
        file.own(H5Dget_create_plist(dataset), "a dataset has no properties");
    const H5Handle type = file.own(H5Dget_type(dataset), "a dataset has no type");
    const std::size_t entry_bytes = H5Tget_size(type.get());
    const H5D_layout_t layout = H5Pget_layout(properties.get());
    if (layout == H5D_CHUNKED) {
        ChunkedStorage(file, dataset, path, properties, entry_bytes).require_sound(start, count);
        return;
    }
    const H5Handle space = file.own(H5Dget_space(dataset), "a dataset has no extent");
    const auto entries = static_cast<hsize_t>(H5Sget_simple_extent_npoints(space.get()));
    const hsize_t stored = H5Dget_storage_size(dataset);
    const bool never_written = layout == H5D_CONTIGUOUS && stored == 0;
    if (!never_written && stored != entries * entry_bytes) {
        file.fail(fmt::format("{} is damaged", path));
    }
}

}  // namespace grainfield::io
