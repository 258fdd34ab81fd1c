#include "io/h5/fingerprint.h"

#include "io/h5/detail/data_digest.h"
#include "io/h5/detail/h5_group.h"

namespace grainfield::io {

Fingerprint fingerprint_of(const std::filesystem::path& path) {
    const H5File file = H5File::open(path);
    const H5Group root = H5Group::root(file);
    Fingerprint fingerprint;
    fingerprint.data = digest_of(root);
    if (root.has_attribute(digest_name)) {
        fingerprint.stored = root.texts_attribute(digest_name).at(0);
    }
    return fingerprint;
}

}  // namespace grainfield::io
