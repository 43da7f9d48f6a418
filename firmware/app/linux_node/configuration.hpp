// Reads the configuration block of a Linux node and checks it, also against the command line.
#pragma once

#include "common/config/node_config.hpp"
#include "common/result.hpp"
#include "firmware/app/linux_node/arguments.hpp"
#include "firmware/port/linux/start_failure.hpp"

namespace octoskin::linux_node {

inline constexpr std::uint8_t kBoardType = 2;  // hw/boards/linux_board.yaml

/// Errors: the file does not exist; it is not a complete valid block; the block is for another type of board;
/// the block uses a bus, an XSHUT line or a data-ready line that the command line does not name.
[[nodiscard]] Result<NodeConfig, linux_port::StartFailure> load_configuration(const Arguments& arguments);

}  // namespace octoskin::linux_node
