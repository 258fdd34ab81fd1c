#include "core/support/snapshot_numbers.h"

namespace grainfield {

void transfer(NumberArchive& archive, Snapshot& snapshot) {
    archive(snapshot.frame);
    archive(snapshot.time);
    archive(snapshot.box.origin);
    archive(snapshot.box.length);
    for (Boundary& boundary : snapshot.box.boundary) archive(boundary);
    archive(snapshot.box.height);
    archive(snapshot.position);
    archive(snapshot.id);
    archive(snapshot.z);
    archive(snapshot.velocity);
    archive(snapshot.spin);
    archive(snapshot.position_error);
    archive(snapshot.z_error);
    archive(snapshot.quality);
    archive(snapshot.layer);
}

}  // namespace grainfield
