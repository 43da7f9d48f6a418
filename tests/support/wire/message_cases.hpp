// One message of every layout, and for each field its position and meaning by docs/protocol.md.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/wire/messages.hpp"

namespace octoskin::test {

struct FieldCase {
    std::string name;
    unsigned start = 0;
    unsigned bits = 0;
    /// Sets the field of the message to the value of `raw`.
    std::function<void(wire::Message&, std::uint64_t raw)> set;
    /// False for raw values that a decoder must refuse.
    std::function<bool(std::uint64_t raw)> is_valid = [](std::uint64_t) { return true; };
};

struct Bits {
    unsigned start = 0;
    unsigned bits = 0;
};

struct MessageCase {
    std::string name;
    wire::Message message;  ///< every field neither zero nor all ones
    wire::NodeId node_id = 0;
    std::uint32_t can_id = 0;
    bool is_fd = false;
    unsigned payload_len = 0;
    unsigned checksum_len = 0;
    std::vector<FieldCase> fields;
    std::vector<Bits> fixed;  ///< selectors (page, index): constant within this layout; and RANGE_FD's count
    std::vector<Bits> padding;  ///< zero
};

/// All layouts: every message, every page of NODE_INFO, both JOINT_STATEs, RANGE_FD with 1..4 readings.
[[nodiscard]] std::vector<MessageCase> all_message_cases();

}  // namespace octoskin::test
