// On which network a program of ROS 2 takes part: what a ROS node with the same environment does.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/errors/error.hpp"

namespace octoskin::dds {

struct Network {
    std::uint32_t domain = 0;
    /// Cyclone DDS's configuration as XML; empty: that of CYCLONEDDS_URI alone.
    std::string configuration;
    /// Packets of other machines are dropped, and none is sent to them.
    bool is_local_only = false;
    /// In words, for the start message: "domain 0, this subnet".
    std::string description;
};

/// The value of an environment variable; empty if it is not set.
using Environment = std::function<std::optional<std::string>(const char* name)>;
[[nodiscard]] std::optional<std::string> process_environment(const char* name);

/// From ROS_DOMAIN_ID, CYCLONEDDS_URI, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and
/// ROS_LOCALHOST_ONLY. CYCLONEDDS_URI wins over all but the domain. `this_machine_only`: the option of that
/// name, which wins over all but the domain. An error names the variable and what it may be.
[[nodiscard]] Result<Network, Error> network_of(const Environment& environment, bool this_machine_only);

}  // namespace octoskin::dds
