#include "host/io/socketcan/can_socket.hpp"

#include <fcntl.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <vector>

#include "common/wall_time.hpp"
#include "common/wire/interface_name.hpp"
#include "common/wire/socketcan_layout.hpp"
#include "host/io/socketcan/passed_descriptors.hpp"
#include "host/io/socketcan/stamped_datagram.hpp"

namespace octoskin::socketcan {
namespace {

WallTime wall_now() {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return wall_time(now.tv_sec, now.tv_nsec);
}

/// True if the other end has closed. An empty packet reads like that end. The difference: the other end has
/// hung up, and no datagram with content is waiting.
bool has_ended(int descriptor) {
    pollfd entry{descriptor, POLLRDHUP, 0};
    if (::poll(&entry, 1, 0) <= 0 || (entry.revents & (POLLRDHUP | POLLHUP)) == 0) return false;
    int waiting = 0;
    return ::ioctl(descriptor, SIOCINQ, &waiting) != 0 || waiting == 0;
}

std::string remedy(int error_number) {
    switch (error_number) {
        case ENODEV:
            return " (is the adapter plugged in? `ip link show type can` lists the interfaces)";
        case ENETDOWN:
            return " (bring it up: `sudo ip link set NAME up type can bitrate 500000`, with your rates)";
        case EAFNOSUPPORT:
            return " (this kernel has no CAN: `sudo modprobe can-raw`)";
        case EPERM:
        case EACCES:
            return " (not permitted here)";
        default:
            return {};
    }
}

std::vector<can_filter> kernel_filters(std::span<const IdFilter> filters) {
    std::vector<can_filter> kernel;
    for (const IdFilter& filter : filters) {
        // Octoskin uses standard data frames only.
        kernel.push_back({filter.can_id, filter.mask | CAN_EFF_FLAG | CAN_RTR_FLAG});
    }
    return kernel;
}

template <class Value>
bool set(int descriptor, int level, int option, const Value& value) {
    return ::setsockopt(descriptor, level, option, &value, sizeof(value)) == 0;
}

bool filter(int descriptor, std::span<const IdFilter> filters) {
    // An empty mask lets everything pass.
    const std::vector<can_filter> kernel =
        filters.empty() ? std::vector<can_filter>{{}} : kernel_filters(filters);
    const auto bytes = static_cast<socklen_t>(kernel.size() * sizeof(can_filter));
    return ::setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_FILTER, kernel.data(), bytes) == 0;
}

bool set_options(int descriptor, const SocketOptions& options) {
    const can_err_mask_t errors = options.wants_error_frames ? CAN_ERR_MASK : 0;
    const bool is_filtered = filter(descriptor, options.filters);
    // As large as the system allows, which may be less than requested.
    (void)set(descriptor, SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes);
    return is_filtered && set(descriptor, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1) &&
           set(descriptor, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors) &&
           set(descriptor, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, options.hears_itself ? 1 : 0) &&
           want_stamps(descriptor) && set(descriptor, SOL_SOCKET, SO_RXQ_OVFL, 1);
}

/// Returns 0, or the error number.
int bind_to(int descriptor, const std::string& interface) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    if (address.can_ifindex == 0) return errno;
    const auto* generic = reinterpret_cast<const sockaddr*>(&address);
    return ::bind(descriptor, generic, sizeof(address)) == 0 ? 0 : errno;
}

}  // namespace

bool SocketFault::is_down() const noexcept {
    return error_number == ENETDOWN;
}

Result<CanSocket, SocketFault> CanSocket::open(const std::string& interface, const SocketOptions& options) {
    if (!wire::is_interface_name(interface))
        return unexpected(SocketFault{interface, EINVAL, std::string(wire::kInterfaceNameRule)});
    CanSocket socket(interface, ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
    if (socket.descriptor_ < 0) return unexpected(socket.fault(errno, "cannot open a CAN socket"));
    if (!set_options(socket.descriptor_, options))
        return unexpected(socket.fault(errno, "cannot set up the CAN socket"));
    if (const int error = bind_to(socket.descriptor_, interface); error != 0)
        return unexpected(socket.fault(error, "cannot use this CAN interface"));
    return socket;
}

bool CanSocket::set_filters(std::span<const IdFilter> filters) {
    return filter(descriptor_, filters);
}

CanSocket::CanSocket(std::string interface, int descriptor, bool hears_itself)
    : interface_(std::move(interface)), descriptor_(descriptor), has_echo_(hears_itself) {
    if (descriptor_ < 0) return;
    (void)::fcntl(descriptor_, F_SETFD, FD_CLOEXEC);  // a helper program must not inherit the socket
    (void)::fcntl(descriptor_, F_SETFL, ::fcntl(descriptor_, F_GETFL) | O_NONBLOCK);
    (void)want_stamps(descriptor_);   // most kernels give Unix sockets time stamps, too
    (void)want_senders(descriptor_);  // which leaves no room for descriptors
    refuse_descriptors(descriptor_);
}

CanSocket::~CanSocket() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

CanSocket::CanSocket(CanSocket&& other) noexcept
    : interface_(std::move(other.interface_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      newest_(other.newest_),
      dropped_(other.dropped_),
      dropped_raw_(other.dropped_raw_),
      malformed_(other.malformed_),
      has_echo_(other.has_echo_),
      waiting_(std::move(other.waiting_)) {}

CanSocket& CanSocket::operator=(CanSocket&& other) noexcept {
    std::swap(interface_, other.interface_);
    std::swap(descriptor_, other.descriptor_);
    newest_ = other.newest_;
    dropped_ = other.dropped_;
    dropped_raw_ = other.dropped_raw_;
    malformed_ = other.malformed_;
    has_echo_ = other.has_echo_;
    waiting_ = std::move(other.waiting_);
    return *this;
}

Result<std::optional<Received>, SocketFault> CanSocket::receive(int& datagrams_left) {
    if (!waiting_.empty()) {
        if (datagrams_left-- <= 0) return std::optional<Received>{};
        Received oldest = std::move(waiting_.front());
        waiting_.pop_front();
        return std::optional(std::move(oldest));
    }
    for (; datagrams_left > 0; --datagrams_left) {
        auto taken = take_one();
        if (!taken) return unexpected(taken.error());
        if (!taken->has_value()) return std::optional<Received>{};
        if (!(*taken)->received) continue;
        --datagrams_left;
        return std::move((*taken)->received);
    }
    return std::optional<Received>{};
}

/// Frames that arrived before an own frame come before its echo; later ones come after it. The time for this
/// is limited, so that a flood cannot delay it. An error appears again at the next read of this socket.
void CanSocket::take_what_came() {
    const WallTime begun = wall_now();
    for (std::size_t i = 0; i < kWaitingMax && waiting_.size() < kWaitingMax; ++i) {
        auto taken = take_one();
        if (!taken || !taken->has_value()) return;
        if ((*taken)->received) waiting_.push_back(std::move(*(*taken)->received));
        if (newest_ > begun) return;
    }
}

Result<std::optional<CanSocket::Taken>, SocketFault> CanSocket::take_one() {
    std::array<std::byte, CANFD_MTU + 1> bytes{};
    const StampedDatagram datagram = receive_stamped(descriptor_, bytes);
    if (datagram.count < 0) {
        if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) return std::optional<Taken>{};
        return unexpected(fault(errno, "cannot receive"));
    }
    if (datagram.count == 0 && has_ended(descriptor_)) return unexpected(fault(ENODEV, "closed"));
    newest_ = datagram.stamp ? *datagram.stamp : wall_now();
    if (datagram.dropped) dropped_ += *datagram.dropped - std::exchange(dropped_raw_, *datagram.dropped);
    const auto frame = wire::from_socketcan(std::span(bytes).first(static_cast<std::size_t>(datagram.count)));
    if (!frame) {
        ++malformed_;
        return std::optional(Taken{});
    }
    const bool is_own = (datagram.flags & MSG_CONFIRM) != 0;
    return std::optional(Taken{Received{.entry = {*newest_, *frame}, .is_own = is_own}});
}

Result<bool, SocketFault> CanSocket::send(const wire::CanFrame& frame) {
    const wire::SocketCanBytes raw = wire::to_socketcan(frame);
    if (has_echo_) take_what_came();
    const WallTime handed_over =
        wall_now();  // before the call, because it wakes the receiver, which may run first
    const ssize_t count = ::send(descriptor_, raw.bytes().data(), raw.size, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count == static_cast<ssize_t>(raw.size)) {
        if (has_echo_) waiting_.push_back({.entry = {handed_over, frame}, .is_own = true});
        return true;
    }
    // ENOBUFS: the queue of the interface is full, for example because no node acknowledges.
    if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS || errno == EINTR) return false;
    return unexpected(fault(errno, "cannot send"));
}

SocketFault CanSocket::fault(int error_number, const std::string& doing) const {
    return {.interface = interface_,
            .error_number = error_number,
            .what = doing + ": " + std::strerror(error_number) + remedy(error_number)};
}

}  // namespace octoskin::socketcan
