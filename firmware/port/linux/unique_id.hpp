// Which board a Linux node is: by this machine and by the buses that it works on, so that two nodes on one
// machine are two boards, and a node started twice is one.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace octoskin::linux_port {

/// Hashed (FNV-1a), since machine-id(5) is not to be told on a network as it is. Empty: there is no machine
/// id.
[[nodiscard]] std::optional<std::array<std::uint8_t, 12>> unique_id(
    std::span<const std::string> buses, const std::filesystem::path& machine_id_file = "/etc/machine-id");

}  // namespace octoskin::linux_port
