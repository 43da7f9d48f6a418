// The can.log of an imported bag: frames of its bus, and its joint states as the frames of the rig's joint
// sources. A bag without a bus, or without the SYNC of its host, gets an exchange ten times a second.
#pragma once

#include <cstdint>
#include <optional>
#include <queue>
#include <variant>
#include <vector>

#include "common/result.hpp"
#include "host/bridge/recorded/bus_clock.hpp"
#include "host/core/ingest/local_joints.hpp"
#include "host/core/time/sync_master.hpp"
#include "host/io/candump/log_writer.hpp"

namespace octoskin::bridge {

class BagLog {
  public:
    /// Entries may come this much later than others with a later time.
    static constexpr Nanoseconds kWindow{1'000'000'000};
    /// Entries that wait for earlier ones; beyond this the oldest is written.
    static constexpr std::size_t kWaitingMax = std::size_t{1} << 18U;

    /// `sources`: for each source of the rig its converter, or empty if its node is on the bus.
    BagLog(candump::LogWriter log, const BusClock& clock, bool makes_sync,
           std::vector<std::optional<LocalJoints>> sources)
        : log_(std::move(log)), clock_(clock), makes_sync_(makes_sync), sources_(std::move(sources)) {}

    /// False, as of the other two: the log or its bus cannot hold that time, and nothing is added.
    bool add(WallTime stamp, const wire::CanFrame& frame);
    /// A sample of a source that has a converter.
    bool add(WallTime stamp, std::size_t source, std::vector<double> position);
    /// Time passes without an entry: an image came. An exchange may be due.
    bool add(WallTime stamp) { return push(stamp, std::monostate()); }
    /// The bag has been read to this time.
    void advance(WallTime now);
    /// Writes what waits and closes the file. Error: the file could not be written.
    [[nodiscard]] Status<Error> close();

    [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }
    /// Samples left out because they follow the one before too soon for the rig's rate.
    [[nodiscard]] std::uint64_t thinned() const noexcept { return thinned_; }
    [[nodiscard]] const std::optional<WallTime>& first() const noexcept { return first_; }
    [[nodiscard]] const std::optional<WallTime>& last() const noexcept { return last_; }

  private:
    struct Joints {
        std::size_t source = 0;
        std::vector<double> position;
    };
    using Content = std::variant<std::monostate, wire::CanFrame, Joints>;
    struct Entry {
        WallTime stamp;
        std::uint64_t number = 0;
        Content content;
    };
    struct IsLater {
        bool operator()(const Entry& a, const Entry& b) const noexcept {
            return a.stamp != b.stamp ? a.stamp > b.stamp : a.number > b.number;
        }
    };

    [[nodiscard]] bool can_hold(WallTime stamp, const Content& content) const;
    [[nodiscard]] bool push(WallTime stamp, Content content);
    void write_oldest();
    void write(WallTime stamp, const wire::CanFrame& frame);
    /// Returns the stamp with which it was written.
    WallTime write_made(WallTime stamp, const wire::CanFrame& frame);
    void write_joints(WallTime stamp, const Joints& joints);
    void write_reports(WallTime stamp, std::uint8_t sequence);
    void exchange_until(WallTime stamp);

    candump::LogWriter log_;
    BusClock clock_;
    bool makes_sync_;
    std::vector<std::optional<LocalJoints>> sources_;
    SyncMaster sync_{kSyncPeriod};
    static constexpr Nanoseconds kSyncPeriod{100'000'000};
    std::optional<WallTime> exchanged_;
    std::priority_queue<Entry, std::vector<Entry>, IsLater> waiting_;
    std::uint64_t number_ = 0;
    std::uint64_t frames_ = 0;
    std::uint64_t thinned_ = 0;
    std::optional<WallTime> first_;
    std::optional<WallTime> last_;
    std::optional<Error> error_;
};

}  // namespace octoskin::bridge
