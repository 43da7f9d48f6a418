// Who is on the bus, and whether it is the board that the rig describes. Ranges of a node count only while
// its verdict is `usable`.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "host/core/ingest/node_traffic.hpp"
#include "host/core/ingest/register_reports.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// The worst that holds, in this order.
enum class NodeVerdict : std::uint8_t {
    other_version,  ///< a heartbeat of another protocol version within the last second: nothing else is read
    quarantined,    ///< two unique ids, or two senders' readings, on one node id within the last two seconds
    babbling,       ///< more frames than NodeTraffic allows, within the last second
    absent,         ///< no heartbeat yet
    lost,           ///< no heartbeat for 350 ms
    time_suspect,   ///< says so itself, or sends joint states and did within the last second
    info_incomplete,  ///< pages of NODE_INFO are missing
    info_mismatch,    ///< see NodeRecord::mismatch
    build_refused,    ///< the rig pins another build
    usable,
};
[[nodiscard]] constexpr std::array<const char*, 10> names_of(NodeVerdict) {
    return {"other_version", "quarantined",     "babbling",      "absent",        "lost",
            "time_suspect",  "info_incomplete", "info_mismatch", "build_refused", "usable"};
}

/// Joint states need no NODE_INFO, and their node need not send heartbeats; but what it says must count.
[[nodiscard]] constexpr bool is_refused_for_joints(NodeVerdict verdict) {
    return verdict == NodeVerdict::other_version || verdict == NodeVerdict::quarantined ||
           verdict == NodeVerdict::babbling || verdict == NodeVerdict::time_suspect;
}

/// A claim of a node that differs from the rig.
struct NodeMismatch {
    std::string_view what;  ///< a literal
    std::uint32_t found = 0;
    std::uint32_t expected = 0;
    std::string_view expected_by = "the rig has";  ///< a literal
    /// For a person: "node_hash 1a2b3c4d, the rig has 5e6f7a8b".
    [[nodiscard]] std::string text() const;
    friend bool operator==(const NodeMismatch&, const NodeMismatch&) = default;
};

/// All that is known of one node.
struct NodeRecord {
    HostNode expected;
    /// A node that only sends joint states has no configuration block to compare.
    bool has_block = true;
    std::optional<wire::Heartbeat> heartbeat;
    std::optional<HostTime> heard;  ///< the newest heartbeat while "now" was known
    bool is_heard_since = false;    ///< another one came, and "now" is unknown
    Nanoseconds heard_running{0};   ///< the newest heartbeat, as HostClockEstimate::running counts
    std::array<std::optional<wire::NodeInfo>, wire::kInfoPages> pages;
    RegisterReports registers;         ///< since it started
    std::optional<HostTime> conflict;  ///< the newest sign of a second board
    bool is_in_conflict = false;
    std::optional<HostTime> babbled;        ///< the newest frame that was one too many
    std::optional<HostTime> other_version;  ///< the newest heartbeat of another version
    bool is_other_version = false;
    bool sends_joints = false;
    std::optional<HostTime> suspected;  ///< the newest heartbeat that said `is_time_suspect`
    bool is_suspected = false;
    std::uint8_t version_told = 0;      ///< in that heartbeat
    std::uint64_t restarts = 0;         ///< heartbeats that said `starting` after one that did not
    std::optional<HostTime> restarted;  ///< at the newest of them

    /// The first of the node's claims that differs from the rig. Asked for every reading: allocates nothing.
    [[nodiscard]] std::optional<NodeMismatch> mismatch() const noexcept;
    [[nodiscard]] bool is_info_complete() const;
    template <class Page>
    [[nodiscard]] const Page* page() const {
        for (const auto& entry : pages) {
            if (entry && std::holds_alternative<Page>(*entry)) {
                return std::get_if<Page>(&*entry);
            }
        }
        return nullptr;
    }
};

class NodeRegistry {
  public:
    static constexpr Nanoseconds kLostAfter{350'000'000};
    static constexpr Nanoseconds kConflictHold{2'000'000'000};
    static constexpr Nanoseconds kOtherVersionHold{1'000'000'000};
    static constexpr Nanoseconds kBabbleHold{1'000'000'000};
    /// Of a joint source: else one that has its samples refused could send its own between them, and every
    /// pose would be by those. Readings are compared with refused ones: RangeGate::skip.
    static constexpr Nanoseconds kSuspectHold{1'000'000'000};

    explicit NodeRegistry(const HostRig& rig);

    [[nodiscard]] bool knows(wire::NodeId node) const { return records_.contains(node); }
    [[nodiscard]] const std::map<wire::NodeId, NodeRecord>& records() const noexcept { return records_; }

    /// What a heartbeat tells about the node's past.
    enum class Life : std::uint8_t {
        goes_on,
        restarted,  ///< its clock and its sequences began anew
    };
    /// HostClockEstimate::running at the newest frame. Before anything else is told of that.
    void on_running(Nanoseconds running) noexcept { running_ = running; }
    /// "Now" was unknown and is known again, maybe another host's: of who was heard meanwhile, it tells when.
    void on_time_known(HostTime now);

    // Each of these takes a known node. `now`: empty while unknown; then a node is lost that was not heard
    // while others were.
    /// Before anything else is done with a frame that the node sent.
    void on_frame(wire::NodeId node, std::optional<HostTime> now);
    /// Of a sensor that it has.
    void on_reading(wire::NodeId node, const wire::RangeReading& reading, std::optional<HostTime> now);
    [[nodiscard]] Life on_heartbeat(wire::NodeId node, const wire::Heartbeat& heartbeat,
                                    std::optional<HostTime> now);
    /// A heartbeat with a valid checksum and another version.
    void on_other_version(wire::NodeId node, std::uint8_t version, std::optional<HostTime> now);
    /// False if the page was not taken: the node is quarantined, babbles or speaks another version.
    [[nodiscard]] bool on_info(wire::NodeId node, const wire::NodeInfo& info, std::optional<HostTime> now);

    [[nodiscard]] NodeVerdict verdict(wire::NodeId node, std::optional<HostTime> now) const;
    /// What the node told and what it should have told, where that is what the verdict rests on.
    [[nodiscard]] std::optional<NodeMismatch> reason(wire::NodeId node, std::optional<HostTime> now) const;
    /// For a person: "node 7 'upper ring': info_mismatch (node_hash 1a2b3c4d, the rig has 5e6f7a8b: flash it
    /// with this rig, ...)".
    [[nodiscard]] std::string describe(wire::NodeId node, std::optional<HostTime> now) const;

  private:
    void add(const HostNode& node, const HostJointSource& joints);
    [[nodiscard]] bool is_lost(const NodeRecord& record, std::optional<HostTime> now) const;

    std::map<wire::NodeId, NodeRecord> records_;
    std::map<wire::NodeId, NodeTraffic> traffic_;  ///< of the same nodes
    Nanoseconds running_{0};
};

}  // namespace octoskin
