#include "tests/fuzz/readers.h"

#include <array>

namespace grainfield::fuzz {

std::span<const Reader> readers() {
    static constexpr std::array list{Reader{"images", read_images, 2000},
                                     Reader{"videos", read_videos, 500},
                                     Reader{"photron", read_photron, 1000},
                                     Reader{"streams", read_streams, 300},
                                     Reader{"trajectories", read_trajectories, 500},
                                     Reader{"results", read_results, 500},
                                     Reader{"fields", read_fields, 500},
                                     Reader{"records", read_records, 2000},
                                     Reader{"points", read_points, 2000},
                                     Reader{"wavevectors", read_wavevectors, 2000},
                                     Reader{"configurations", read_configurations, 2000},
                                     Reader{"calibrations", read_calibrations, 2000},
                                     Reader{"cameras", read_cameras, 2000},
                                     Reader{"checkpoints", read_checkpoints, 2000},
                                     Reader{"states", read_states, 2000},
                                     Reader{"logs", read_logs, 2000}};
    return list;
}

}  // namespace grainfield::fuzz
