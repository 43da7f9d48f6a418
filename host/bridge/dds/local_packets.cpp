#include "host/bridge/dds/local_packets.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/filter.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

namespace octoskin::dds {
namespace {

std::vector<std::uint32_t> own_addresses() {
    std::vector<std::uint32_t> addresses;
    ifaddrs* first = nullptr;
    if (::getifaddrs(&first) != 0) return addresses;
    const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(first, &::freeifaddrs);
    for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
        if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
        sockaddr_in address{};
        std::memcpy(&address, one->ifa_addr, sizeof(address));
        addresses.push_back(ntohl(address.sin_addr.s_addr));
    }
    return addresses;
}

/// A program for the kernel's packet filter: accepts a packet whose IPv4 source is one of these or 127.x.x.x.
std::vector<sock_filter> filter_of(const std::vector<std::uint32_t>& addresses) {
    constexpr std::uint32_t kSourceOfIp = 12;
    constexpr std::uint32_t kAll = 0xFFFF'FFFF;
    std::vector<sock_filter> program = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(SKF_NET_OFF) + kSourceOfIp)};
    for (const std::uint32_t address : addresses) {
        program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, address, 0, 1));
        program.push_back(BPF_STMT(BPF_RET | BPF_K, kAll));
    }
    program.push_back(BPF_STMT(BPF_ALU | BPF_AND | BPF_K, 0xFF00'0000));
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0x7F00'0000, 0, 1));
    program.push_back(BPF_STMT(BPF_RET | BPF_K, kAll));
    program.push_back(BPF_STMT(BPF_RET | BPF_K, 0));
    return program;
}

bool is_udp(int descriptor) {
    int domain = 0;
    int type = 0;
    socklen_t size = sizeof(int);
    return ::getsockopt(descriptor, SOL_SOCKET, SO_DOMAIN, &domain, &size) == 0 && domain == AF_INET &&
           ::getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_DGRAM;
}

std::vector<int> udp_sockets() {
    std::vector<int> sockets;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
        const std::string name = entry.path().filename();
        int descriptor = -1;
        const auto parsed = std::from_chars(name.data(), name.data() + name.size(), descriptor);
        if (parsed.ec == std::errc{} && is_udp(descriptor)) sockets.push_back(descriptor);
    }
    return sockets;
}

}  // namespace

bool receive_from_this_machine_only() {
    auto filter = filter_of(own_addresses());
    const sock_fprog program{.len = static_cast<unsigned short>(filter.size()), .filter = filter.data()};
    bool is_done = true;
    for (const int socket : udp_sockets())
        is_done &= ::setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof(program)) == 0;
    return is_done;
}

}  // namespace octoskin::dds
