#include "firmware/port/linux/can_interface.hpp"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "common/wall_time.hpp"
#include "common/wire/frame_type.hpp"
#include "common/wire/socketcan_layout.hpp"
#include "firmware/port/linux/can_errors.hpp"
#include "firmware/port/linux/node_clock.hpp"

namespace octoskin::linux_port {
namespace {

constexpr Microseconds kLookEvery{100'000};
/// A bus without errors confirms within milliseconds. After this time the confirmation counts as lost.
constexpr Microseconds kConfirmedWithin{1'000'000};

struct Datagram {
    ssize_t count = 0;
    bool is_own = false;
    std::optional<WallTime> stamp;
};

/// If `count` is negative, errno holds the reason.
Datagram receive_datagram(int socket, std::span<std::byte> bytes) {
    alignas(cmsghdr) std::array<char, 128> control{};
    iovec part{bytes.data(), bytes.size()};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    Datagram datagram;
    datagram.count = ::recvmsg(socket, &message, MSG_DONTWAIT);
    if (datagram.count < 0) return datagram;
    datagram.is_own = (message.msg_flags & MSG_CONFIRM) != 0;
    for (cmsghdr* beside = CMSG_FIRSTHDR(&message); beside != nullptr;
         beside = CMSG_NXTHDR(&message, beside)) {
        if (beside->cmsg_level != SOL_SOCKET || beside->cmsg_type != SO_TIMESTAMPNS) continue;
        timespec time{};
        std::memcpy(&time, CMSG_DATA(beside), sizeof(time));
        datagram.stamp = wall_time(time.tv_sec, time.tv_nsec);
    }
    return datagram;
}

/// The frames that the core handles: SYNC, commands for this node or for all, and frames of any sender with
/// the node's own id. The filter for the own id also passes the confirmations of the node's own frames.
std::array<can_filter, 3> filters_for(wire::NodeId node_id) {
    constexpr std::uint32_t kNodeBits = 63;
    constexpr std::uint32_t kStandardData = CAN_EFF_FLAG | CAN_RTR_FLAG;
    const auto exactly = [](wire::FrameType type, wire::NodeId id) {
        return can_filter{wire::can_id(type, id), CAN_SFF_MASK | kStandardData};
    };
    return {can_filter{node_id, kNodeBits | kStandardData}, exactly(wire::FrameType::sync, wire::kHostId),
            exactly(wire::FrameType::command, wire::kBroadcastId)};
}

template <class Value>
bool set(int socket, int level, int option, const Value& value) {
    return ::setsockopt(socket, level, option, &value, sizeof(value)) == 0;
}

ifreq request_for(const std::string& name) {
    ifreq request{};
    name.copy(request.ifr_name, sizeof(request.ifr_name) - 1);
    return request;
}

std::string can_remedy(int error_number) {
    switch (error_number) {
        case ENODEV:
            return " (`ip link show type can` lists the interfaces)";
        case ENETDOWN:
            return " (bring it up: `sudo ip link set NAME up type can bitrate ... restart-ms 100`)";
        case EAFNOSUPPORT:
            return " (this kernel has no CAN: `sudo modprobe can-raw`)";
        default:
            return {};
    }
}

}  // namespace

CanInterface::CanInterface(std::string name, wire::NodeId node_id, bool uses_can_fd, NodeTime now)
    : name_(std::move(name)), node_id_(node_id), uses_can_fd_(uses_can_fd), now_(now), look_at_(now) {
    poll(now);
}

CanInterface::~CanInterface() {
    if (socket_ >= 0) ::close(socket_);
}

void CanInterface::open() {
    const auto index = static_cast<int>(::if_nametoindex(name_.c_str()));
    if (index == 0) return fail(ENODEV, "no such interface");
    socket_ = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (socket_ < 0) return fail(errno, "cannot open a CAN socket");
    if (const int error_number = set_up(index); error_number != 0)
        return close(error_number, "cannot use this interface");
}

/// Returns 0 or the kernel's error number.
int CanInterface::set_up(int index) {
    const auto filters = filters_for(node_id_);
    const can_err_mask_t errors = CAN_ERR_BUSOFF | CAN_ERR_RESTARTED | CAN_ERR_CRTL;
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = index;
    const bool is_done = set(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, filters) &&
                         set(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors) &&
                         set(socket_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1) &&
                         set(socket_, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, 1) &&
                         set(socket_, SOL_SOCKET, SO_TIMESTAMPNS, 1) &&
                         ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    return is_done ? 0 : errno;
}

void CanInterface::close(int error_number, const char* doing) {
    ::close(std::exchange(socket_, -1));
    fail(error_number, doing);
}

void CanInterface::fail(int error_number, const char* doing) {
    trouble_ = name_ + ": " + doing + ": " + std::strerror(error_number) + can_remedy(error_number);
}

bool CanInterface::can_carry_frames() const {
    ifreq request = request_for(name_);
    return !uses_can_fd_ ||
           (::ioctl(socket_, SIOCGIFMTU, &request) == 0 && request.ifr_mtu >= static_cast<int>(CANFD_MTU));
}

bool CanInterface::is_up() const {
    ifreq request = request_for(name_);
    return ::ioctl(socket_, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

/// The kernel removes the carrier of a controller that is bus-off. A failed read counts as no carrier; the
/// next error frame then gives the state.
bool CanInterface::has_carrier() const {
    char carrier = '0';
    std::ifstream("/sys/class/net/" + name_ + "/carrier") >> carrier;
    return carrier == '1';
}

bool CanInterface::send(const wire::CanFrame& frame) {
    if (state() == node::CanState::bus_off || !in_flight_.has_room()) return false;
    const wire::SocketCanBytes raw = wire::to_socketcan(frame);
    const ssize_t count = ::send(socket_, raw.bytes().data(), raw.size, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count == static_cast<ssize_t>(raw.size)) {
        in_flight_.add(frame, now_);
        return true;
    }
    // ENOBUFS: the interface's queue is full, for example with frames of other programs.
    if (errno == ENETDOWN) {
        fail(errno, "link down");
    } else if (errno == ENXIO || errno == ENODEV) {
        close(ENODEV, "gone");
    }
    return false;
}

node::CanState CanInterface::state() const {
    return socket_ >= 0 && trouble_.empty() ? errors_ : node::CanState::bus_off;
}

std::optional<CanInterface::Received> CanInterface::receive() {
    // Each iteration takes one datagram, or the socket's error. The limit keeps frames that are not for the
    // node from delaying it. At the limit the result is empty and the descriptor stays readable.
    constexpr int kDatagramsMax = 64;
    for (int i = 0; i < kDatagramsMax && socket_ >= 0; ++i) {
        std::array<std::byte, CANFD_MTU> bytes{};
        const Datagram datagram = receive_datagram(socket_, bytes);
        if (datagram.count < 0) {
            if (errno == ENETDOWN) {
                fail(errno, "link down");
                continue;
            }
            if (errno == ENODEV) close(errno, "gone");
            return std::nullopt;
        }
        const auto frame =
            wire::from_socketcan(std::span(bytes).first(static_cast<std::size_t>(datagram.count)));
        if (!frame) continue;
        if (frame->is_error) {
            errors_ = state_after(*frame, errors_);
        } else if (datagram.is_own) {
            in_flight_.confirm(*frame);
        } else {
            const ClockPair now = read_clocks();
            return Received{*frame, datagram.stamp ? node_time_of(*datagram.stamp, now) : now.node};
        }
    }
    return std::nullopt;
}

void CanInterface::poll(NodeTime now) {
    now_ = now;
    const auto oldest = in_flight_.oldest();
    if (oldest && errors_ == node::CanState::active && elapsed(*oldest, now) >= kConfirmedWithin)
        unconfirmed_ += in_flight_.forget_all();
    if (state() != node::CanState::bus_off || !is_reached(look_at_, now)) return;
    look_at_ = now + kLookEvery;
    if (socket_ < 0) {
        trouble_.clear();
        open();
    }
    if (socket_ < 0) return;
    if (!is_up()) return fail(ENETDOWN, "link down");
    if (!can_carry_frames()) {  // can only change while the interface is down
        return fail(EPROTONOSUPPORT,
                    "the configuration asks for CAN FD, but the interface is not set to it "
                    "(`ip link set NAME type can ... dbitrate ... fd on`)");
    }
    if (!trouble_.empty() || has_carrier()) errors_ = node::CanState::active;
    trouble_.clear();
}

std::optional<NodeTime> CanInterface::wake_time() const {
    if (state() == node::CanState::bus_off) return look_at_;
    const auto oldest = in_flight_.oldest();
    if (oldest && errors_ == node::CanState::active) return *oldest + kConfirmedWithin;
    return std::nullopt;
}

}  // namespace octoskin::linux_port
