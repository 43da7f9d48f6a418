// One sensor with two zones, and what passes on its bus: so that a fault can hit every byte of each transfer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/sim/reliability/oracles.hpp"

namespace octoskin::test {

inline NodeConfig two_zones_config(std::uint8_t sensors) {
    NodeConfig config = fleet_config(sensors, 1);
    for (auto& sensor : config.sensors) {
        sensor.zone_count = 2;
        sensor.zones[0] = {.centre_spad = 167, .width = 8, .height = 16};
        sensor.zones[1] = {.centre_spad = 231, .width = 8, .height = 8};
    }
    return config;
}

struct TransferSize {
    std::size_t written = 0;
    std::size_t read = 0;
};

/// Of a sensor alone on its bus, from the first transfer to the reading with this number; one that nobody
/// acknowledged has no bytes.
inline std::vector<TransferSize> transfers_until_reading(std::size_t reading) {
    NodeRig rig(two_zones_config(1), std::vector<SensorSetup>(1));
    std::vector<TransferSize> sizes;
    std::uint64_t bits_before = 0;
    while (rig.readings_of(0).size() < reading) {
        rig.run_for(Microseconds{20});  // no transfer is so short
        if (rig.bus(0).transfer_count() == sizes.size()) continue;
        EXPECT_EQ(rig.bus(0).transfer_count(), sizes.size() + 1);
        // START and address 10, a byte 9, STOP 1. A write is 11 + 9 w, a read with its index 39 + 9 r: never
        // the same.
        const std::uint64_t bits = rig.bus(0).bit_count() - bits_before;
        bits_before += bits;
        const bool is_read = bits >= 48 && (bits - 39) % 9 == 0;
        sizes.push_back(is_read ? TransferSize{.written = 2, .read = (bits - 39) / 9}
                                : TransferSize{.written = (bits - 11) / 9});
    }
    return sizes;
}

}  // namespace octoskin::test
