#include "host/apps/flashing/record.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>

#include "common/config/node_config.hpp"

namespace octoskin::flashing {

std::string record(const Order& order, const Prepared& prepared,
                   const std::optional<Programmed>& programmed) {
    std::string text;
    text += "schema: octoskin-flash/1\n";
    text += fmt::format("time_utc: {:%Y-%m-%dT%H:%M:%SZ}\n", fmt::gmtime(std::time(nullptr)));
    text += fmt::format("node: {}\nnode_id: {}\nnode_hash: 0x{:08x}\n", order.node.name,
                        order.node.config.node_id, node_hash(order.node.config));
    text += fmt::format("board: {}\n", order.board.name);
    text += fmt::format("image: {}\n", order.elf.filename().string());
    text +=
        fmt::format("image_bytes: {}\nimage_crc32: 0x{:08x}\n", prepared.image_bytes, prepared.image_crc32);
    text += fmt::format("configuration_bytes: {}\n", prepared.block_bytes);
    text += fmt::format("is_programmed: {}\n", programmed.has_value());
    if (programmed) text += fmt::format("flash_optr: 0x{:08x}\n", programmed->flash_optr);
    return text;
}

}  // namespace octoskin::flashing
