#include "host/bridge/dds/interfaces.hpp"

#include <ifaddrs.h>
#include <net/if.h>
#include <sys/socket.h>

#include <memory>

namespace octoskin::dds {

std::set<std::string> running_interfaces() {
    std::set<std::string> names;
    ifaddrs* first = nullptr;
    if (::getifaddrs(&first) != 0) return names;
    const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(first, &::freeifaddrs);
    for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
        const bool is_running = (one->ifa_flags & IFF_UP) != 0 && (one->ifa_flags & IFF_RUNNING) != 0;
        const bool is_loopback = (one->ifa_flags & IFF_LOOPBACK) != 0;
        if (is_running && !is_loopback && one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET)
            names.insert(one->ifa_name);
    }
    return names;
}

}  // namespace octoskin::dds
