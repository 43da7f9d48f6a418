// Datagrams of a socket, read by a thread of its own: whoever takes them may be busy with other things while
// they come. A Unix socket alone keeps but a few (net.unix.max_dgram_qlen).
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/time.hpp"
#include "host/apps/daemon/joint_senders.hpp"
#include "host/apps/daemon/sender_shares.hpp"

namespace octoskin {

struct Datagram {
    std::string bytes;
    WallTime came;                    ///< when the kernel had it
    std::optional<HostTime> came_at;  ///< the same on the clock that never steps, if that can be told
    HostTime read;
    SenderKey from;
    JointSender sender;  ///< the same, and whose it is
};

class DatagramFeed {
  public:
    /// Datagrams that wait; beyond, the oldest of the program that has most waiting gives way. A second of an
    /// arm that tells 1000 samples.
    static constexpr std::size_t kWaitingMax = 1024;

    /// `socket` is a Unix socket that does not block and wants stamps and senders (stamped_datagram.hpp); it
    /// is closed here. Of each datagram the first `bytes_max` bytes are kept. Throws std::system_error if the
    /// system has no room for it; the socket is then still the caller's. Takes no descriptors that come along
    /// (passed_descriptors.hpp).
    DatagramFeed(int socket, std::size_t bytes_max);
    /// At once.
    ~DatagramFeed();
    DatagramFeed(const DatagramFeed&) = delete;
    DatagramFeed& operator=(const DatagramFeed&) = delete;

    /// Readable while a datagram waits.
    [[nodiscard]] int descriptor() const noexcept { return event_; }
    /// The oldest, in the order in which they came; empty: none came before this call that is not taken yet,
    /// whether or not the thread had its turn.
    [[nodiscard]] std::optional<Datagram> take();
    /// One that was taken was of use: its sender is one of those that have a share (SenderShares::keep).
    void keep(const Datagram& useful);
    /// So many gave way untaken.
    [[nodiscard]] std::uint64_t displaced() const;
    /// So many were beyond what one program may send (SenderShares), and are dropped as they come.
    [[nodiscard]] std::uint64_t surplus() const;

  private:
    void work();
    void put_next();
    [[nodiscard]] std::optional<Datagram> receive();
    void displace();

    int socket_;
    std::vector<char> room_;  ///< for one
    int event_ = -1;
    int end_ = -1;  ///< readable when the thread is to end
    mutable std::mutex mutex_;
    std::deque<Datagram> waiting_;
    std::uint64_t displaced_ = 0;
    std::uint64_t surplus_ = 0;
    SenderShares shares_;
    std::atomic<int> takers_ = 0;  ///< that want the lock: the thread lets them have it first
    std::thread thread_;
};

}  // namespace octoskin
