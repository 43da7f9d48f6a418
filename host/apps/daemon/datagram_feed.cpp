#include "host/apps/daemon/datagram_feed.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <new>
#include <span>
#include <system_error>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/io/socketcan/passed_descriptors.hpp"
#include "host/io/socketcan/short_waits.hpp"
#include "host/io/socketcan/stamped_datagram.hpp"

namespace octoskin {
namespace {

/// For a program with a visible process the addresses do not count: it cannot flood under many names.
SenderKey key_of(const socketcan::StampedDatagram& received, const std::string& address) {
    const pid_t pid = received.sender ? received.sender->pid : 0;
    return {pid, pid > 0 ? std::string() : address};
}

JointSender sender_of(const socketcan::StampedDatagram& received, std::string address) {
    const auto seen = received.sender.value_or(socketcan::StampedDatagram::Sender{});
    return {seen.pid, seen.pid > 0 ? seen.uid : 0, std::move(address)};
}

/// Does not block on descriptors that may come along.
socketcan::StampedDatagram receive_one(int socket, std::span<char> room, std::string& address) {
    std::optional<socketcan::ShortWaits> none_long;
    if (socketcan::has_descriptors_beside(socket)) none_long.emplace();
    return socketcan::receive_stamped(socket, std::as_writable_bytes(room), &address);
}

}  // namespace

class DatagramFeed::Turn {
  public:
    explicit Turn(const DatagramFeed& feed) {
        ++feed.callers_;
        lock_ = std::unique_lock(feed.mutex_);
        --feed.callers_;
    }

  private:
    std::unique_lock<std::mutex> lock_;
};

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
    socketcan::close_socket(socket_);  // with the datagrams not taken
    for (const int descriptor : {event_, end_}) ::close(descriptor);
}

std::optional<Datagram> DatagramFeed::take() {
    const Turn turn(*this);
    if (waiting_.empty()) return receive();
    Datagram oldest = std::move(waiting_.front());
    waiting_.pop_front();
    std::uint64_t puts = 0;
    if (waiting_.empty()) (void)!::read(event_, &puts, sizeof(puts));
    return oldest;
}

void DatagramFeed::keep(const Datagram& useful) {
    const Turn turn(*this);
    shares_.keep(useful.from, useful.read);
}

std::uint64_t DatagramFeed::displaced() const {
    const Turn turn(*this);
    return displaced_;
}

std::uint64_t DatagramFeed::surplus() const {
    const Turn turn(*this);
    return surplus_;
}

void DatagramFeed::work() {
    std::array<pollfd, 2> watched{pollfd{socket_, POLLIN, 0}, pollfd{end_, POLLIN, 0}};
    while (true) {
        (void)::poll(watched.data(), watched.size(), -1);
        if (watched[1].revents != 0) return;
        // In a flood this thread would get the lock again before a waiting thread wakes up.
        while (callers_ > 0) std::this_thread::yield();
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
    if (!datagram) return;  // `take` was faster
    // First the step that may fail: a wake-up without a datagram would stay set, because no `take` would
    // clear it.
    waiting_.push_back(std::move(*datagram));
    const std::uint64_t one = 1;
    if (waiting_.size() == 1) (void)!::write(event_, &one, sizeof(one));
    if (waiting_.size() > kWaitingMax) displace();
}

/// A sender that sends more than others has more datagrams waiting, and loses them first. O(kWaitingMax), and
/// as rare as shares are small.
void DatagramFeed::displace() {
    std::vector<std::pair<SenderKey, std::size_t>> counts;  // of few senders: each has a share
    for (const Datagram& datagram : waiting_) {
        const auto found =
            std::ranges::find(counts, datagram.from, &std::pair<SenderKey, std::size_t>::first);
        if (found == counts.end()) {
            counts.emplace_back(datagram.from, 1);
        } else {
            ++found->second;
        }
    }
    const SenderKey most =
        std::ranges::max_element(counts, {}, &std::pair<SenderKey, std::size_t>::second)->first;
    waiting_.erase(
        std::ranges::find_if(waiting_, [&most](const Datagram& datagram) { return datagram.from == most; }));
    ++displaced_;
}

/// Called with the lock, because two receivers would mix up the order. In a flood it may return empty
/// although more has arrived: datagrams beyond their sender's share are not skipped without end.
std::optional<Datagram> DatagramFeed::receive() {
    constexpr int kSurplusAtOnce = 64;
    for (int i = 0; i < kSurplusAtOnce; ++i) {
        std::string address;
        const auto received = receive_one(socket_, room_, address);
        if (received.count < 0) return std::nullopt;
        Datagram datagram;
        datagram.from = key_of(received, address);
        if (!shares_.take(datagram.from, monotonic_now())) {
            ++surplus_;
            continue;
        }
        datagram.sender = sender_of(received, std::move(address));
        datagram.bytes.assign(room_.data(), static_cast<std::size_t>(received.count));
        // It may have waited: the kernel's time stamp is its arrival.
        datagram.came = received.stamp.value_or(wall_now());
        datagram.came_at = monotonic_of(datagram.came);
        datagram.read = monotonic_now();
        return datagram;
    }
    return std::nullopt;
}

}  // namespace octoskin
