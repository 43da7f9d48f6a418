#include "host/apps/daemon/datagram_feed.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <new>
#include <span>
#include <system_error>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/io/socketcan/stamped_datagram.hpp"

namespace octoskin {

DatagramFeed::DatagramFeed(int socket, std::size_t bytes_max)
    : socket_(socket),
      room_(bytes_max),
      event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      end_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    try {
        if (event_ < 0 || end_ < 0)
            throw std::system_error(errno, std::generic_category(), "cannot make an eventfd");
        thread_ = start_without_signals([this] { work(); });
    } catch (...) {
        for (const int descriptor : {event_, end_}) {
            if (descriptor >= 0) ::close(descriptor);
        }
        throw;
    }
}

DatagramFeed::~DatagramFeed() {
    const std::uint64_t one = 1;
    (void)!::write(end_, &one, sizeof(one));
    thread_.join();
    for (const int descriptor : {socket_, event_, end_}) ::close(descriptor);
}

std::optional<Datagram> DatagramFeed::take() {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return receive();
    Datagram oldest = std::move(waiting_.front());
    waiting_.pop_front();
    std::uint64_t puts = 0;
    if (waiting_.empty()) (void)!::read(event_, &puts, sizeof(puts));
    return oldest;
}

std::uint64_t DatagramFeed::displaced() const {
    const std::lock_guard lock(mutex_);
    return displaced_;
}

void DatagramFeed::work() {
    std::array<pollfd, 2> watched{pollfd{socket_, POLLIN, 0}, pollfd{end_, POLLIN, 0}};
    while (true) {
        (void)::poll(watched.data(), watched.size(), -1);
        if (watched[1].revents != 0) return;
        // Not all that is there under one lock: whoever takes has a turn between two of a flood.
        try {
            put_next();
        } catch (const std::bad_alloc&) {
            const std::lock_guard lock(mutex_);
            ++displaced_;
        }
    }
}

void DatagramFeed::put_next() {
    const std::lock_guard lock(mutex_);
    auto datagram = receive();
    if (!datagram) return;  // `take` was quicker
    // First what may fail: an event for nothing would stay, since nothing would ever be taken for it.
    waiting_.push_back(std::move(*datagram));
    const std::uint64_t one = 1;
    if (waiting_.size() == 1) (void)!::write(event_, &one, sizeof(one));
    if (waiting_.size() <= kWaitingMax) return;
    waiting_.pop_front();
    ++displaced_;
}

/// Under the lock: what is received by two at once would be put in disorder.
std::optional<Datagram> DatagramFeed::receive() {
    const auto received = socketcan::receive_stamped(socket_, std::as_writable_bytes(std::span(room_)));
    if (received.count < 0) return std::nullopt;
    Datagram datagram;
    datagram.bytes.assign(room_.data(), static_cast<std::size_t>(received.count));
    // It may have waited: it came when the kernel says.
    datagram.came = received.stamp.value_or(wall_now());
    datagram.came_at = monotonic_of(datagram.came);
    datagram.read = monotonic_now();
    return datagram;
}

}  // namespace octoskin
