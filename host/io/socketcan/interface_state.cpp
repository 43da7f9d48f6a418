#include "host/io/socketcan/interface_state.hpp"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace octoskin::socketcan {
namespace {

using Bytes = std::span<const std::byte>;

template <class Value>
std::optional<Value> read(Bytes bytes) {
    Value value{};
    if (bytes.size() < sizeof(value)) return std::nullopt;
    std::memcpy(&value, bytes.data(), sizeof(value));
    return value;
}

Bytes after(Bytes bytes, std::size_t count) {
    return bytes.subspan(std::min(bytes.size(), count));
}

/// The content of the first attribute of this type; empty if there is none.
Bytes attribute(Bytes attributes, unsigned type) {
    while (true) {  // each iteration removes one attribute
        const auto header = read<rtattr>(attributes);
        if (!header || header->rta_len < sizeof(rtattr) || header->rta_len > attributes.size()) return {};
        if ((header->rta_type & NLA_TYPE_MASK) == type)
            return attributes.first(header->rta_len).subspan(sizeof(rtattr));
        attributes = after(attributes, RTA_ALIGN(header->rta_len));
    }
}

struct Request {
    nlmsghdr header{};
    ifinfomsg link{};
};

std::optional<ControllerState> controller_state_of(Bytes attributes) {
    const Bytes info = attribute(attributes, IFLA_LINKINFO);
    const Bytes kind = attribute(info, IFLA_INFO_KIND);
    const bool is_can = kind.size() >= 4 && std::memcmp(kind.data(), "can", 4) == 0;
    const auto state = read<std::uint32_t>(attribute(attribute(info, IFLA_INFO_DATA), IFLA_CAN_STATE));
    if (!is_can || !state || *state > CAN_STATE_SLEEPING) return std::nullopt;
    return static_cast<ControllerState>(*state);
}

}  // namespace

std::optional<InterfaceState> interface_state_of(Bytes answer) {
    const auto header = read<nlmsghdr>(answer);
    if (!header || header->nlmsg_type != RTM_NEWLINK || header->nlmsg_len > answer.size())
        return std::nullopt;
    const Bytes message = answer.first(header->nlmsg_len);
    const auto link = read<ifinfomsg>(after(message, NLMSG_HDRLEN));
    if (!link) return std::nullopt;
    return InterfaceState{.is_up = (link->ifi_flags & IFF_UP) != 0,
                          .controller = controller_state_of(after(message, NLMSG_SPACE(sizeof(ifinfomsg))))};
}

std::optional<InterfaceState> read_interface_state(const std::string& interface) {
    Request request;
    request.header = {.nlmsg_len = sizeof(request),
                      .nlmsg_type = RTM_GETLINK,
                      .nlmsg_flags = NLM_F_REQUEST,
                      .nlmsg_seq = 1,
                      .nlmsg_pid = 0};
    request.link.ifi_index = static_cast<int>(::if_nametoindex(interface.c_str()));
    if (request.link.ifi_index == 0) return std::nullopt;
    const int descriptor = ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE);
    if (descriptor < 0) return std::nullopt;
    // The kernel has answered when `send` returns.
    std::array<std::byte, 16'384> answer{};
    const bool is_asked = ::send(descriptor, &request, sizeof(request), 0) == ssize_t{sizeof(request)};
    const ssize_t count = is_asked ? ::recv(descriptor, answer.data(), answer.size(), 0) : -1;
    ::close(descriptor);
    if (count <= 0) return std::nullopt;
    return interface_state_of(Bytes(answer).first(static_cast<std::size_t>(count)));
}

}  // namespace octoskin::socketcan
