// What the person who starts a Linux node says: which block, and which device of this machine is what.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/time.hpp"
#include "firmware/port/linux/gpio_lines.hpp"
#include "firmware/port/linux/start_failure.hpp"

namespace octoskin::linux_node {

using Uid = std::array<std::uint8_t, 12>;

struct Arguments {
    std::filesystem::path config;                  ///< the node's configuration block
    std::string can = "can0";                      ///< interface
    std::vector<std::string> i2c;                  ///< device of each bus, by the rig's `bus`
    std::vector<linux_port::LineName> xshut;       ///< line of each sensor, by the rig's `xshut_line`
    std::vector<linux_port::LineName> data_ready;  ///< line of each bus; empty: none
    std::optional<Uid> uid;                        ///< instead of one from the machine's id
    Microseconds i2c_lateness{20'000};
};

/// Arguments, or the exit code of a program that has already said all there is to say (--help, --version, or
/// what is wrong).
[[nodiscard]] std::variant<Arguments, linux_port::ExitCode> parse_arguments(int argc, const char* const* argv,
                                                                            std::uint32_t build_id);

}  // namespace octoskin::linux_node
