// Unique id of a Linux node, from the machine and its buses. Two nodes on one machine with different buses
// differ; the same node started again keeps its id.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace octoskin::linux_port {

/// Hashed (FNV-1a), since machine-id(5) must not be published on a network. Empty if there is no machine id.
[[nodiscard]] std::optional<std::array<std::uint8_t, 12>> unique_id(
    std::span<const std::string> buses, const std::filesystem::path& machine_id_file = "/etc/machine-id");

}  // namespace octoskin::linux_port
