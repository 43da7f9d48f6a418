// Registry of the nodes on the bus. Decides whether each is the board that the rig describes. Ranges of a
// node count only while its decision is `usable`.
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

/// The decision about a node: the first of these conditions that holds.
enum class NodeCondition : std::uint8_t {
    other_version,  ///< a heartbeat of another protocol version within the last second; nothing else is read
    quarantined,  ///< two unique ids, or two senders' readings, under one node id within the last two seconds
    babbling,     ///< more frames than NodeTraffic allows, within the last second
    absent,       ///< no heartbeat yet
    lost,         ///< no heartbeat for 350 ms
    time_suspect,     ///< reports it itself, or sends joint states and reported it within the last second
    info_incomplete,  ///< pages of NODE_INFO are missing
    info_mismatch,    ///< see NodeRecord::mismatch
    build_refused,    ///< the rig pins another build
    usable,
};
[[nodiscard]] constexpr std::array<const char*, 10> names_of(NodeCondition) {
    return {"other_version", "quarantined",     "babbling",      "absent",        "lost",
            "time_suspect",  "info_incomplete", "info_mismatch", "build_refused", "usable"};
}

/// Joint states need no NODE_INFO, and their node need not send heartbeats. True if the node's messages must
/// not be used.
[[nodiscard]] constexpr bool is_refused_for_joints(NodeCondition verdict) {
    return verdict == NodeCondition::other_version || verdict == NodeCondition::quarantined ||
           verdict == NodeCondition::babbling || verdict == NodeCondition::time_suspect;
}

/// A value that a node reports and that differs from the rig.
struct NodeMismatch {
    std::string_view what;  ///< a string literal
    std::uint32_t found = 0;
    std::uint32_t expected = 0;
    std::string_view expected_by = "the rig has";  ///< a string literal
    /// Text for people: "node_hash 1a2b3c4d, the rig has 5e6f7a8b".
    [[nodiscard]] std::string text() const;
    friend bool operator==(const NodeMismatch&, const NodeMismatch&) = default;
};

/// Everything that is known about one node.
struct NodeRecord {
    HostNode expected;
    /// A node that sends only joint states has no configuration block to compare.
    bool has_block = true;
    std::optional<wire::Heartbeat> heartbeat;
    std::optional<HostTime> heard;  ///< the newest heartbeat while the host time was known
    bool is_heard_since = false;    ///< a later heartbeat came while the host time was unknown
    Nanoseconds heard_running{0};   ///< the newest heartbeat, in HostClockEstimate::running
    std::array<std::optional<wire::NodeInfo>, wire::kInfoPages> pages;
    RegisterReports registers;         ///< since the node started
    std::optional<HostTime> conflict;  ///< the newest sign of a second board
    bool is_in_conflict = false;
    std::optional<HostTime> babbled;        ///< the newest frame beyond the limit
    std::optional<HostTime> other_version;  ///< the newest heartbeat of another version
    bool is_other_version = false;
    bool sends_joints = false;
    std::optional<HostTime> suspected;  ///< the newest heartbeat with `is_time_suspect`
    bool is_suspected = false;
    std::uint8_t version_reported = 0;  ///< version in that heartbeat
    std::uint64_t restarts = 0;         ///< heartbeats with `starting` after one without
    std::optional<HostTime> restarted;  ///< time of the newest of them

    /// The first reported value that differs from the rig. Called for every reading: does not allocate.
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
    /// For a joint source. Without this hold, another sender that makes the source's samples refused could
    /// send its own between them, and every pose would come from those. Readings are compared even when
    /// refused: RangeGate::skip.
    static constexpr Nanoseconds kSuspectHold{1'000'000'000};

    explicit NodeRegistry(const HostRig& rig);

    [[nodiscard]] bool knows(wire::NodeId node) const { return records_.contains(node); }
    [[nodiscard]] const std::map<wire::NodeId, NodeRecord>& records() const noexcept { return records_; }

    /// What a heartbeat shows about the node's past.
    enum class Life : std::uint8_t {
        goes_on,
        restarted,  ///< its clock and its sequence numbers restarted
    };
    /// HostClockEstimate::running at the newest frame. Call before the other functions.
    void on_running(Nanoseconds running) noexcept { running_ = running; }
    /// The host time was unknown and is known again, perhaps from another host's clock. Computes when the
    /// nodes that were heard meanwhile were heard.
    void on_time_known(HostTime now);

    // Each of these functions takes a known node. `now`: empty while the host time is unknown; a node is then
    // lost if it was not heard while others were.
    /// Call before any other use of a frame that the node sent.
    void on_frame(wire::NodeId node, std::optional<HostTime> now);
    /// For a reading of a sensor that the node has.
    void on_reading(wire::NodeId node, const wire::RangeReading& reading, std::optional<HostTime> now);
    [[nodiscard]] Life on_heartbeat(wire::NodeId node, const wire::Heartbeat& heartbeat,
                                    std::optional<HostTime> now);
    /// A heartbeat with a valid checksum and another protocol version.
    void on_other_version(wire::NodeId node, std::uint8_t version, std::optional<HostTime> now);
    /// False if the page was refused: the node is quarantined, babbling or uses another protocol version.
    [[nodiscard]] bool on_info(wire::NodeId node, const wire::NodeInfo& info, std::optional<HostTime> now);

    [[nodiscard]] NodeCondition verdict(wire::NodeId node, std::optional<HostTime> now) const;
    /// The reported and the expected value, if the decision rests on such a difference.
    [[nodiscard]] std::optional<NodeMismatch> reason(wire::NodeId node, std::optional<HostTime> now) const;
    /// Text for people: "node 7 'upper ring': info_mismatch (node_hash 1a2b3c4d, the rig has 5e6f7a8b: flash
    /// it with this rig, ...)".
    [[nodiscard]] std::string describe(wire::NodeId node, std::optional<HostTime> now) const;

  private:
    /// `joints`: the source of joint states with its id; null: it is none.
    void add(const HostNode& node, const HostJointSource* joints);
    [[nodiscard]] bool is_lost(const NodeRecord& record, std::optional<HostTime> now) const;

    std::map<wire::NodeId, NodeRecord> records_;
    std::map<wire::NodeId, NodeTraffic> traffic_;  ///< for the same nodes
    Nanoseconds running_{0};
};

}  // namespace octoskin
