// From a rig, a node's name and an image to the files that OpenOCD programs, and the OpenOCD run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/flashing/openocd_outcome.hpp"
#include "host/apps/recording/app_error.hpp"
#include "hw/image/flash_contents.hpp"
#include "hw/rigfile/board_hardware.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::flashing {

struct Order {
    std::filesystem::path elf;
    rig::Node node;
    rig::BoardHardware board;
    std::filesystem::path folder;  ///< folder of the files; created if it does not exist
    std::string adapter_serial;    ///< letters and digits; empty: any adapter
    bool writes_option_bytes = false;
};

/// The checked and written files; nothing here depends on the adapter.
struct Prepared {
    image::FlashContents contents;
    std::size_t image_bytes = 0;
    std::uint32_t image_crc32 =
        0;  ///< of the image alone, as `crc32` computes it over objcopy's binary output
    std::size_t block_bytes = 0;
};

/// The node with that name or number; if `wanted` is empty, the rig's only node. Error: `usage`.
[[nodiscard]] Result<rig::Node, AppError> choose_node(const rig::Rig& rig, const std::string& wanted);

/// Checks the image, merges the node's configuration block, checks the result, and writes `flash.hex` and
/// `flash.cfg` into the folder. Errors: `no_input`, `bad_data` (the image; the message names every fault),
/// `bad_config` (the node is not for this board), `cannot_create`.
[[nodiscard]] Result<Prepared, AppError> prepare(const Order& order);

/// Runs OpenOCD on the files of `prepare`; its output goes to `openocd.log` in the folder. Blocks for about
/// 10 s, at most a minute.
[[nodiscard]] Result<Programmed, AppError> program(const Order& order);

/// Makes OpenOCD read the files of `prepare` without an adapter. Blocks for less than a second, at most 20 s.
[[nodiscard]] Result<Done, AppError> rehearse(const Order& order);

}  // namespace octoskin::flashing
