#include <algorithm>
#include <string>
#include <string_view>

#include "common/wire/crc.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {
namespace {

std::uint32_t crc32_of(std::string_view text) {
    return crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// The rig with defaults for every key that does not affect where measurements lie.
Rig placing_part(const Rig& rig) {
    Rig placing;
    placing.base_link = rig.base_link;
    placing.T_map_base = rig.T_map_base;
    placing.joint_sources = {{.joints = rig.joint_names()}};  // not their order: each is known by its name
    std::ranges::sort(placing.joint_sources.front().joints);
    for (const Node& node : rig.nodes) {
        Node& only_sensors = placing.nodes.emplace_back();
        only_sensors.config.node_id = node.config.node_id;
        only_sensors.sensors = node.sensors;
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            const SensorConfig& config = node.config.sensors.at(i);
            only_sensors.sensors[i].name.clear();
            only_sensors.config.sensors.at(i) = {.offset_quarter_mm = config.offset_quarter_mm,
                                                 .has_offset = config.has_offset,
                                                 .applies_gain_factor = config.applies_gain_factor,
                                                 .zone_count = config.zone_count,
                                                 .zones = config.zones};
        }
    }
    for (const Camera& camera : rig.cameras) {
        Camera& placed = placing.cameras.emplace_back(camera);
        placed.rate_hz = 0.0;
        placed.device.clear();
        placed.noise.reset();
    }
    std::ranges::sort(placing.cameras, {}, &Camera::name);
    return placing;
}

}  // namespace

Rig without_devices(Rig rig) {
    for (Camera& camera : rig.cameras) camera.device.clear();
    return rig;
}

std::uint32_t rig_hash(const Rig& rig) {
    return crc32_of(canonical_text(without_devices(rig), "robot.urdf"));
}

std::uint32_t placement_crc32(const Rig& rig, std::string_view robot) {
    return crc32_of(canonical_text(placing_part(rig), "robot.urdf").append(robot));
}

}  // namespace octoskin::rig
