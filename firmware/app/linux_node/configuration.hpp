// The configuration block of a Linux node: read, checked, and held against what the command line offers.
#pragma once

#include "common/config/node_config.hpp"
#include "common/result.hpp"
#include "firmware/app/linux_node/arguments.hpp"
#include "firmware/port/linux/start_failure.hpp"

namespace octoskin::linux_node {

inline constexpr std::uint8_t kBoardType = 2;  // hw/boards/linux_board.yaml

/// Refused: a file that is not there; no whole block; one for another type of board; a bus, an XSHUT line or
/// a data-ready line that the command line does not name.
[[nodiscard]] Result<NodeConfig, linux_port::StartFailure> load_configuration(const Arguments& arguments);

}  // namespace octoskin::linux_node
