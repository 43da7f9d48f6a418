// Turns the user's request, by names, into commands for the bus.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/wire/messages.hpp"
#include "host/apps/recording/app_error.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::commanding {

/// As typed.
struct Wish {
    std::string node;    ///< a number; with a rig also a name, or "all" for every sensor board of the rig
    std::string code;    ///< the name in docs/protocol.md
    std::string sensor;  ///< index, or its name if there is a rig; empty: all sensors
    std::optional<std::uint16_t> period_ms;  ///< required by set_rate
    std::optional<std::uint16_t> seconds;    ///< for identify
};

/// The codes that `orders_of` accepts: all except those of a calibration, which has a dialogue of its own.
[[nodiscard]] std::vector<std::string> code_names();

struct Order {
    wire::NodeId node_id = 0;
    wire::Command command{};  ///< its sequence is the first of the 16 of this order
    /// From the rig, if there is one and it contains the node.
    struct Known {
        std::string name;
        std::uint32_t node_hash = 0;
        std::vector<std::string> sensors;
    };
    std::optional<Known> known{};
    bool is_sensor_by_name = false;  ///< requires that the node has the rig's configuration

    /// "node 1 'bench'"
    [[nodiscard]] std::string whom() const;
};

/// One order for each addressed node, in the rig's order. Error, always `usage`: no such node, sensor or
/// code; an option that the code does not take, or a missing one. `rig` may be null.
[[nodiscard]] Result<std::vector<Order>, AppError> orders_of(const rig::Rig* rig, const Wish& wish,
                                                             std::uint8_t sequence);

}  // namespace octoskin::commanding
