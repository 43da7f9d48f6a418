#include "hw/rigfile/can_load.hpp"

#include "common/wire/bus_load.hpp"

namespace octoskin::rig {

double can_load(const Rig& rig) {
    wire::BusUse use;
    use.nodes = static_cast<std::uint32_t>(rig.nodes.size());
    for (const JointSource& source : rig.joint_sources) {
        if (source.way == JointWay::socket) continue;
        ++use.nodes;
        use.joint_samples_per_s += source.rate_hz;
    }
    use.uses_can_fd = rig.bus.uses_can_fd;
    for (const Node& node : rig.nodes) {
        use.sensors += node.config.sensor_count;
        for (std::size_t i = 0; i < node.config.sensor_count; ++i) {
            const double readings_per_s = 1000.0 / node.config.sensors[i].inter_measurement_ms;
            use.readings_per_s += readings_per_s;
            const bool has_aux = !rig.bus.uses_can_fd && node.config.aux_every > 0;
            if (has_aux) use.aux_per_s += readings_per_s / node.config.aux_every;
        }
    }
    return wire::bus_load(wire::traffic_of(use), {rig.bus.nominal_bitrate, rig.bus.data_bitrate});
}

}  // namespace octoskin::rig
