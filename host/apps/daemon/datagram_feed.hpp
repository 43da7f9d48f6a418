// Datagrams of a socket, read by its own thread, so that the receiver may be busy while they arrive. A Unix
// socket alone keeps only a few (net.unix.max_dgram_qlen).
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
    WallTime came;                    ///< when the kernel received it
    std::optional<HostTime> came_at;  ///< the same on the clock that never steps, if it can be converted
    HostTime read;
    SenderKey from;
    JointSender sender;  ///< its sender, with the address
};

class DatagramFeed {
  public:
    /// Datagrams that wait; beyond this, the oldest of the program with the most waiting is displaced. One
    /// second of an arm that sends 1000 samples a second.
    static constexpr std::size_t kWaitingMax = 1024;

    /// `socket`: a non-blocking Unix socket with time stamps and senders enabled (stamped_datagram.hpp),
    /// which is closed here. Of each datagram the first `bytes_max` bytes are kept. Throws std::system_error
    /// if the system lacks resources; the socket then still belongs to the caller. Refuses descriptors that
    /// are passed along (passed_descriptors.hpp).
    DatagramFeed(int socket, std::size_t bytes_max);
    /// Does not wait.
    ~DatagramFeed();
    DatagramFeed(const DatagramFeed&) = delete;
    DatagramFeed& operator=(const DatagramFeed&) = delete;

    /// Readable while a datagram waits.
    [[nodiscard]] int descriptor() const noexcept { return event_; }
    /// The oldest, in the order of arrival; empty: none that arrived before this call is left, whether or not
    /// the thread has run.
    [[nodiscard]] std::optional<Datagram> take();
    /// Marks a taken datagram as useful: its sender is one of those that have a share (SenderShares::keep).
    void keep(const Datagram& useful);
    /// Number of datagrams displaced before they were taken.
    [[nodiscard]] std::uint64_t displaced() const;
    /// Number of datagrams beyond the share of one program (SenderShares), which are dropped on arrival.
    [[nodiscard]] std::uint64_t surplus() const;

  private:
    /// Holds the lock. The thread waits for those that wait for it.
    class Turn;

    void work();
    void put_next();
    [[nodiscard]] std::optional<Datagram> receive();
    void displace();

    int socket_;
    std::vector<char> room_;  ///< for one datagram
    int event_ = -1;
    int end_ = -1;  ///< readable when the thread is to end
    mutable std::mutex mutex_;
    std::deque<Datagram> waiting_;
    std::uint64_t displaced_ = 0;
    std::uint64_t surplus_ = 0;
    SenderShares shares_;
    mutable std::atomic<int> callers_ = 0;  ///< that wait for the lock: the thread lets them have it first
    std::thread thread_;
};

}  // namespace octoskin
