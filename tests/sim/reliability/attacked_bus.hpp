// Real node cores and the host's core on one virtual clock, and between them somebody who forges readings, or
// a bus that hurts frames. Oracle: the simulated sensors' own windows, and the map without the attacker.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/core/ingest/local_joints.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/core/time/sync_master.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::test {

inline constexpr std::uint16_t kTruthMm = 500;  ///< what every sensor truly ranges

/// One frame on its way to the host.
struct OnTheWay {
    std::int64_t arrives_us = 0;
    wire::CanFrame frame;
};

/// What becomes of a node's reading on its way, and what else comes: `said` arrives at `arrives_us` if
/// nothing happens to it. Put into `way` what arrives, in any order; nothing: it is lost.
using Reader = std::function<void(wire::NodeId node, const wire::RangeReading& said, std::int64_t arrives_us,
                                  std::vector<OnTheWay>& way)>;

/// The same of its answer to a SYNC.
using Answerer = std::function<void(wire::NodeId node, const wire::SyncReport& said, std::int64_t arrives_us,
                                    std::vector<OnTheWay>& way)>;

/// Told of all else that a node says.
using Listener = std::function<void(const wire::Decoded& said)>;

struct BusSetup {
    std::uint8_t nodes = 1;  ///< ids 5 and 6
    std::uint8_t sensors = 4;
    std::uint16_t budget_ms = 15;
    std::uint16_t period_ms = 20;
    Release release = Release::once_placed;
    bool holds_phases = false;
    double run_s = 9.0;
    Reader on_reading = {};   ///< empty: all arrives as it was said
    Answerer on_answer = {};  ///< likewise
    Listener on_other = {};
    double loss = 0.0;                       ///< of all frames of the nodes, readings among them
    std::optional<double> resets_at_s = {};  ///< the first node's controller
    std::optional<double> clock_jumps_at_s = {};
    std::int64_t clock_jump_us = 0;
    std::uint32_t seed = 1;
};

inline constexpr wire::NodeId kFirst = 5;
inline constexpr wire::NodeId kOther = 6;
/// The nodes' clocks are known, every sensor is in the map many times.
inline constexpr double kSettled_s = 4.0;

struct SensorCount {
    std::uint64_t sent = 0;  ///< and not lost, from kSettled_s on, until half a second before the end
    std::uint64_t used = 0;  ///< of those, each as it was ranged
    [[nodiscard]] double share() const { return static_cast<double>(used) / static_cast<double>(sent); }
};

class AttackedBus final : private CommitListener {
  public:
    using SensorKey = std::pair<wire::NodeId, std::uint8_t>;
    explicit AttackedBus(const BusSetup& setup);

    /// Used, and not what a sensor truly ranged at that time.
    [[nodiscard]] std::uint64_t untrue() const noexcept { return untrue_; }
    [[nodiscard]] const std::map<SensorKey, SensorCount>& counts() const noexcept { return counts_; }
    /// When a sensor was named first: for its senders.
    [[nodiscard]] std::optional<double> named_s(SensorKey sensor) const;
    [[nodiscard]] const std::map<SensorKey, double>& named() const noexcept { return named_; }
    /// When a node was named first: for what it answers to SYNC.
    [[nodiscard]] const std::map<wire::NodeId, double>& named_clocks() const noexcept {
        return named_clocks_;
    }
    /// When a node was named first: for what it tells about itself.
    [[nodiscard]] const std::map<wire::NodeId, double>& named_words() const noexcept { return named_words_; }
    [[nodiscard]] const std::map<wire::NodeId, NodeLosses::Loss>& losses() const noexcept { return losses_; }
    [[nodiscard]] const std::map<wire::NodeId, double>& losing_s() const noexcept { return losing_s_; }
    /// Nodes that were not usable at some time after kSettled_s.
    [[nodiscard]] const std::map<wire::NodeId, NodeCondition>& refused() const noexcept { return refused_; }
    /// Voxels that differ from those of a bus without attacker, but for those of one untrue reading.
    [[nodiscard]] std::uint64_t wrong_voxels(const AttackedBus& clean) const;
    /// The map that a replay of what went into this one, in its order, makes: byte for byte as a file.
    [[nodiscard]] std::string replayed_map() const;
    [[nodiscard]] std::string map() const;
    [[nodiscard]] const Pipeline& pipeline() const noexcept { return *pipeline_; }
    [[nodiscard]] std::uint64_t syncs() const noexcept { return syncs_; }

  private:
    void run();
    void poll_host();
    void hear(NodeRig& rig, std::size_t& heard);
    void hear_sync(const wire::Sync& sync, std::int64_t ended_us);
    void pass_on(const wire::CanFrame& frame, std::int64_t end_us);
    [[nodiscard]] wire::CanFrame as_on_a_jumped_clock(const wire::CanFrame& frame, std::int64_t end_us) const;
    void deliver();
    void give(const wire::CanFrame& frame, std::int64_t arrived_us);
    void look();
    [[nodiscard]] double now_s() const { return 1e-6 * static_cast<double>(now_us_); }
    [[nodiscard]] bool is_counted(HostTime captured) const;
    [[nodiscard]] bool is_true(const RangeMeasurement& measurement) const;
    void on_joints(const JointMeasurement& joints) override { commits_.emplace_back(joints); }
    void on_depth(const DepthFrame&, const Evidence&) override {}
    void on_reading(const RangeMeasurement& measurement, const Beam& beam,
                    std::span<const VoxelUpdate> updates) override;

    BusSetup setup_;
    std::vector<std::unique_ptr<NodeRig>> rigs_;
    std::vector<std::size_t> heard_;
    std::unique_ptr<Pipeline> pipeline_;
    SyncMaster sync_;
    LocalJoints joints_;
    std::mt19937 random_;
    std::multimap<std::int64_t, wire::CanFrame> way_;
    std::int64_t now_us_ = 0;
    std::int64_t joints_due_us_ = 500'000;
    std::uint64_t syncs_ = 0;
    std::uint64_t untrue_ = 0;
    std::vector<Commit> commits_;
    std::set<VoxelKey> untrue_voxels_;  ///< of the first untrue reading
    std::map<SensorKey, SensorCount> counts_;
    std::map<SensorKey, double> named_;
    std::map<wire::NodeId, double> named_clocks_;
    std::map<wire::NodeId, double> named_words_;
    std::map<wire::NodeId, NodeLosses::Loss> losses_;
    std::map<wire::NodeId, double> losing_s_;
    std::map<wire::NodeId, NodeCondition> refused_;
};

/// A RANGE frame of this reading, with a right checksum.
[[nodiscard]] wire::CanFrame range_frame(wire::NodeId node, const wire::RangeReading& reading);

}  // namespace octoskin::test
