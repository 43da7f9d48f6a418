#include "tests/bench/verify.hpp"

#include <fmt/format.h>
#include <octomap/octomap.h>

#include <cstdio>
#include <string>

#include "host/core/mapping/depth_integrator.hpp"
#include "tests/bench/clouds.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin::bench {

bool verify(const RoomFrames& room, const std::string& resolution, unsigned frames) {
    const MappingConfig config = bench_mapping(resolution, DepthUpdate::paper);
    DepthIntegrator integrator(config, room.camera);
    octomap::OcTree tree(config.map.resolution_m);
    std::size_t keys = 0;
    std::size_t missing = 0;
    std::size_t extra = 0;
    for (unsigned i = 0; i < frames; ++i) {
        const RoomFrame& frame = room.frames[i % room.frames.size()];
        octomap::KeySet free;
        octomap::KeySet occupied;
        tree.computeUpdate(cloud_of(frame, room.camera), origin_of(frame), free, occupied, kRangeMax_m);
        for (const auto& key : occupied) free.erase(key);
        keys += free.size() + occupied.size();
        const auto result = integrator.integrate(frame.image, frame.T_map_camera);
        if (!result) {
            fmt::print(stderr, "{} m: frame {} was refused\n", resolution, i);
            return false;
        }
        for (const VoxelUpdate& update : updates_of(result->terms)) {
            auto& set = update.log_odds < 0.0F ? free : occupied;
            extra += 1 - set.erase({update.key.x, update.key.y, update.key.z});
        }
        missing += free.size() + occupied.size();
    }
    fmt::print("{} m: {} frames, {} keys, {} missing, {} extra\n", resolution, frames, keys, missing, extra);
    std::fflush(stdout);
    return missing + extra == 0;
}

}  // namespace octoskin::bench
