// Command line of the Linux node: the configuration block, and the device of this machine for each bus and
// line.
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
    std::filesystem::path config;             ///< the node's configuration block
    std::string can = "can0";                 ///< interface
    std::vector<std::string> i2c;             ///< device of each bus, indexed by the rig's `bus`
    std::vector<linux_port::LineName> xshut;  ///< line of each sensor, indexed by the rig's `xshut_line`
    std::vector<linux_port::LineName>
        data_ready;          ///< line of each bus, indexed by the rig's `bus`; may be empty
    std::optional<Uid> uid;  ///< replaces the id derived from the machine's id
    Microseconds i2c_lateness{20'000};
};

/// The arguments, or the exit code if the program must end. In that case the text (--help, --version or the
/// error) has been printed.
[[nodiscard]] std::variant<Arguments, linux_port::ExitCode> parse_arguments(int argc, const char* const* argv,
                                                                            std::uint32_t build_id);

}  // namespace octoskin::linux_node
