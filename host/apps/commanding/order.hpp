// What a person wants of a node, by name, as a command for the bus.
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
    std::string node;    ///< a number; with a rig also a name, or "all" for each of its sensor boards
    std::string code;    ///< as protocol.md has it
    std::string sensor;  ///< index, or with a rig its name; empty: all
    std::optional<std::uint16_t> period_ms;  ///< of set_rate, which needs it
    std::optional<std::uint16_t> seconds;    ///< of identify
};

/// The codes that `orders_of` takes: all but those of a calibration, which is a dialogue of its own.
[[nodiscard]] std::vector<std::string> code_names();

struct Order {
    wire::NodeId node_id = 0;
    wire::Command command{};  ///< its sequence is the first of 16 that are this order's
    /// Of the rig, if there is one and it has the node.
    struct Known {
        std::string name;
        std::uint32_t node_hash = 0;
        std::vector<std::string> sensors;
    };
    std::optional<Known> known{};
    bool is_sensor_by_name = false;  ///< then the node must have the rig's configuration

    /// "node 1 'bench'"
    [[nodiscard]] std::string whom() const;
};

/// One order for each node that is meant, in the rig's order. Errors, all `usage`: no such node, sensor or
/// code, and an option that the code does not take or lacks. `rig` may be null.
[[nodiscard]] Result<std::vector<Order>, AppError> orders_of(const rig::Rig* rig, const Wish& wish,
                                                             std::uint8_t sequence);

}  // namespace octoskin::commanding
