// A live bus: plays the frames of a log at their own times into one end of a socketpair; its nodes answer the
// SYNC of the other end. After the log's STOP the motion is repeated.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "common/wire/messages.hpp"
#include "host/core/pipeline/can_source.hpp"
#include "host/io/socketcan/can_socket.hpp"
#include "tests/support/live/endless_log.hpp"

namespace octoskin::test {

class LiveBus {
  public:
    /// `descriptor`: the bus's end; the bus owns it. Frames of the log's host are left out: the host at the
    /// other end sends SYNC, FOLLOW_UP and MARK. The log must hold SYNC and the nodes' reports, START and
    /// STOP.
    LiveBus(int descriptor, const std::vector<StampedFrame>& log);
    ~LiveBus();
    LiveBus(const LiveBus&) = delete;
    LiveBus& operator=(const LiveBus&) = delete;

    /// From now on another host sends SYNC and FOLLOW_UP once a second; its clock is ahead of this machine's
    /// monotonic one by this time.
    void speak_as_host(Nanoseconds ahead);
    /// The other host's next FOLLOW_UP has this error, once.
    void lie_once(Nanoseconds by);
    /// A node that is switched off: it sends and answers nothing.
    void silence(wire::NodeId node, bool is_silent);
    /// A node that repeats its newest heartbeat a dozen times with each of its frames. Empty: none.
    void let_babble(std::optional<wire::NodeId> node);
    /// A broken line: frames of both directions are lost. The nodes and their robot continue.
    void cut(bool is_cut) noexcept { is_cut_ = is_cut; }
    [[nodiscard]] std::uint64_t syncs_heard() const noexcept { return syncs_heard_; }
    /// Frames of the other end.
    [[nodiscard]] std::uint64_t frames_heard() const noexcept { return frames_heard_; }

  private:
    /// A node's clock by its reports in the log.
    struct Clock {
        std::int64_t stamp_ns = 0;
        std::uint32_t heard_us = 0;
        double us_per_us = 1.0;
    };
    void learn_clocks(const std::vector<StampedFrame>& log);
    [[nodiscard]] std::map<wire::NodeId, double> clock_rates() const;
    void play(EndlessLog& log);
    /// Waits until `due_ns` on the log's time scale, and answers frames meanwhile.
    void listen_until(std::int64_t due_ns);
    /// False if the other end is gone.
    bool hear_one();
    void answer(const wire::CanFrame& frame, std::int64_t heard_ns);
    void report(std::uint8_t sequence, std::int64_t heard_ns);
    void be_host();
    void put(const wire::CanFrame& frame);
    void babble_with(const wire::CanFrame& frame);
    [[nodiscard]] std::int64_t log_time_ns(std::int64_t steady_ns) const;
    [[nodiscard]] std::int64_t log_now_ns() const;
    [[nodiscard]] bool is_silent(wire::NodeId node) const;

    socketcan::CanSocket socket_;
    std::map<wire::NodeId, Clock> clocks_;
    std::int64_t begin_ns_ = 0;         ///< the log's first stamp
    std::int64_t begin_steady_ns_ = 0;  ///< when that was played
    std::atomic<bool> is_ending_ = false;
    std::atomic<bool> is_cut_ = false;
    std::atomic<std::uint64_t> syncs_heard_ = 0;
    std::atomic<std::uint64_t> frames_heard_ = 0;
    mutable std::mutex mutex_;
    std::map<wire::NodeId, bool> silent_;
    std::optional<wire::NodeId> babbling_;
    std::map<wire::NodeId, wire::CanFrame> heartbeats_;  ///< the newest of each node; used by the thread only
    std::optional<Nanoseconds> host_ahead_;              ///< of another host; empty while there is none
    Nanoseconds lie_{0};                                 ///< of its next FOLLOW_UP
    std::int64_t host_due_ns_ = 0;                       ///< its next SYNC, on the log's time scale
    std::uint8_t host_sequence_ = 0;
    std::thread thread_;
};

}  // namespace octoskin::test
