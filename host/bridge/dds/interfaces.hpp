// Network interfaces of this machine.
#pragma once

#include <set>
#include <string>

namespace octoskin::dds {

/// Names of the interfaces besides loopback that are up, have a carrier and an IPv4 address.
[[nodiscard]] std::set<std::string> running_interfaces();

}  // namespace octoskin::dds
