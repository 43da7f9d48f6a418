// One board's flash, from a rig, a node's name and an image to files that OpenOCD programs; and OpenOCD.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/flashing/openocd_verdict.hpp"
#include "host/apps/recording/app_error.hpp"
#include "hw/image/flash_contents.hpp"
#include "hw/rigfile/board_hardware.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::flashing {

struct Order {
    std::filesystem::path elf;
    rig::Node node;
    rig::BoardHardware board;
    std::filesystem::path folder;  ///< where the files go; made if it is not there
    std::string adapter_serial;    ///< letters and digits; empty: any
    bool writes_option_bytes = false;
};

/// Checked and written: everything but the adapter.
struct Prepared {
    image::FlashContents contents;
    std::size_t image_bytes = 0;
    std::uint32_t image_crc32 = 0;  ///< of the image alone, as `crc32` finds it over objcopy's binary
    std::size_t block_bytes = 0;
};

/// The node of that name or number; if `wanted` is empty, the rig's only one. Error: `usage`.
[[nodiscard]] Result<rig::Node, AppError> choose_node(const rig::Rig& rig, const std::string& wanted);

/// Checks the image, merges the node's configuration block, checks the result, and writes `flash.hex` and
/// `flash.cfg` into the folder. Errors: `no_input`, `bad_data` (the image; every fault is named),
/// `bad_config` (the node is not for this board), `cannot_create`.
[[nodiscard]] Result<Prepared, AppError> prepare(const Order& order);

/// Lets OpenOCD run what `prepare` wrote; its words go to `openocd.log` in the folder. Blocks for some 10 s,
/// at most a minute.
[[nodiscard]] Result<Programmed, AppError> program(const Order& order);

/// Lets OpenOCD read what `prepare` wrote, without an adapter. Blocks for less than a second, at most 20.
[[nodiscard]] Result<Done, AppError> rehearse(const Order& order);

}  // namespace octoskin::flashing
