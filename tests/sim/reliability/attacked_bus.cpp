#include "tests/sim/reliability/attacked_bus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/wire/codec.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

constexpr std::int64_t kHostNs = 100'000'000'000;  ///< the host's clock at the start
constexpr std::int64_t kStepUs = 1'000;
constexpr double kJointHz = 100.0;

HostTime host_of(std::int64_t us) {
    return {kHostNs + 1'000 * us};
}
WallTime wall_of(std::int64_t us) {
    return {kWallOffsetNs + 1'000 * us};
}

NodeConfig config_of(const BusSetup& setup, wire::NodeId node) {
    NodeConfig config = fleet_config(setup.sensors, 2);
    config.node_id = node;
    config.uses_can_fd = false;
    config.holds_phases = setup.holds_phases;
    for (std::uint8_t i = 0; i < setup.sensors; ++i) {
        SensorConfig& sensor = config.sensors.at(i);
        sensor.distance_mode = setup.budget_ms < 20 ? DistanceMode::short_range : DistanceMode::long_range;
        sensor.timing_budget_ms = setup.budget_ms;
        sensor.inter_measurement_ms = setup.period_ms;
        sensor.phase_us =
            static_cast<std::uint16_t>(std::min(60'000, 1'000 * setup.period_ms / setup.sensors * i));
    }
    return config;
}

/// About the arm's axis, each its own way: no two see the same voxels.
HostSensor host_sensor(const BusSetup& setup, std::size_t index) {
    HostSensor sensor = one_joint_rig().nodes[0].sensors[kGood];
    sensor.name = std::to_string(index);
    sensor.timing_budget = Microseconds{1'000 * setup.budget_ms};
    sensor.period = Microseconds{1'000 * setup.period_ms};
    sensor.zones = {HostZone{}, HostZone{}};
    const double turn = 2.0 * M_PI / (setup.nodes * setup.sensors);
    sensor.T_link_sensor.prerotate(
        Eigen::AngleAxisd(turn * static_cast<double>(index), Eigen::Vector3d::UnitZ()));
    return sensor;
}

HostRig rig_of(const BusSetup& setup) {
    HostRig rig = one_joint_rig();
    rig.nodes.clear();
    rig.cameras.clear();
    for (std::uint8_t n = 0; n < setup.nodes; ++n) {
        const auto id = static_cast<wire::NodeId>(kFirst + n);
        HostNode node{.node_id = id,
                      .name = "node " + std::to_string(id),
                      .node_hash = node_hash(config_of(setup, id)),
                      .pinned_build_id = {},
                      .sensors = {}};
        for (std::size_t i = 0; i < setup.sensors; ++i)
            node.sensors.push_back(host_sensor(setup, n * setup.sensors + i));
        rig.nodes.push_back(node);
    }
    return rig;
}

std::vector<SensorSetup> parts_of(const BusSetup& setup) {
    std::vector<SensorSetup> parts(setup.sensors);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        parts[i].part.slow_clock_factor = 1.0 + 0.02 * static_cast<double>(i % 4);
        parts[i].target = sim::RangingReturn{
            .range_m = 1e-3 * kTruthMm, .sigma_m = 0.005, .peak_signal_mcps = 10.0, .ambient_mcps = 0.5};
    }
    return parts;
}

Pipeline make_pipeline(const BusSetup& setup) {
    PipelineConfig config;
    config.release = setup.release;
    auto built = Pipeline::build(rig_of(setup), one_joint_robot(), plain_mapping(), config);
    EXPECT_TRUE(built.has_value());
    return std::move(built).value();
}

}  // namespace

wire::CanFrame range_frame(wire::NodeId node, const wire::RangeReading& reading) {
    return wire::encode(wire::Range{reading}, node);
}

AttackedBus::AttackedBus(const BusSetup& setup)
    : setup_(setup), joints_(kJoints, 1, kJointHz), random_(setup.seed) {
    for (std::uint8_t n = 0; n < setup_.nodes; ++n) {
        const NodeConfig config = config_of(setup_, static_cast<wire::NodeId>(kFirst + n));
        rigs_.push_back(std::make_unique<NodeRig>(config, parts_of(setup_),
                                                  sim::NodeClock{{0U - 6'000'000U}, 40.0 - 90.0 * n}));
        heard_.push_back(0);
    }
    pipeline_ = std::make_unique<Pipeline>(make_pipeline(setup_));
    pipeline_->set_listener(this);
    run();
}

void AttackedBus::run() {
    const auto end_us = static_cast<std::int64_t>(1e6 * setup_.run_s);
    bool is_reset = false;
    while (now_us_ < end_us) {
        for (const auto& rig : rigs_) rig->run_for(Microseconds{kStepUs});
        now_us_ += kStepUs;
        for (std::size_t i = 0; i < rigs_.size(); ++i) hear(*rigs_[i], heard_[i]);
        poll_host();
        deliver();
        look();
        if (setup_.resets_at_s && !is_reset && now_s() >= *setup_.resets_at_s) {
            is_reset = true;
            rigs_.front()->reset({.takes = Microseconds{0}});
        }
    }
    pipeline_->finish();
    EXPECT_TRUE(pipeline_->is_balanced()) << pipeline_->inputs_text();
}

/// As the daemon does: SYNC, asked for early where a clock is in question, and the joint states of this host.
void AttackedBus::poll_host() {
    if (pipeline_->intake().wants_exchange()) sync_.hasten();
    if (const auto due = sync_.poll(host_of(now_us_))) {
        for (const auto& rig : rigs_) rig->send_from_host(*due, wire::kHostId);
    }
    for (; joints_due_us_ <= now_us_; joints_due_us_ += 10'000) {
        const double position = M_PI / 2.0;
        const auto frames = joints_.frames(host_of(joints_due_us_), {&position, 1});
        ASSERT_TRUE(frames.has_value());
        for (const wire::CanFrame& frame : *frames) way_.emplace(joints_due_us_ + 400, frame);
    }
}

void AttackedBus::hear(NodeRig& rig, std::size_t& heard) {
    for (; heard < rig.said().size(); ++heard) {
        const SaidMessage& said = rig.said()[heard];
        const auto* sync = std::get_if<wire::Sync>(&said.message);
        if (sync == nullptr) {
            pass_on(rig.frames()[heard], said.end.us);
        } else if (&rig == rigs_.front().get()) {
            hear_sync(*sync, said.end.us);
        }
    }
}

/// Both nodes' buses carry it at the same time: nothing else delays it by over a frame's length.
void AttackedBus::hear_sync(const wire::Sync& sync, std::int64_t ended_us) {
    ++syncs_;
    way_.emplace(ended_us, wire::encode(sync, wire::kHostId));
    way_.emplace(ended_us + 50, joints_.report(sync.sequence, host_of(ended_us)));
    if (const auto follow_up = sync_.on_sent(sync.sequence, host_of(ended_us)))
        way_.emplace(ended_us + 300, wire::encode(*follow_up, wire::kHostId));
}

wire::CanFrame AttackedBus::as_on_a_jumped_clock(const wire::CanFrame& frame, std::int64_t end_us) const {
    if (!setup_.clock_jumps_at_s || 1e-6 * static_cast<double>(end_us) < *setup_.clock_jumps_at_s)
        return frame;
    auto decoded = *wire::decode(frame);
    if (auto* report = std::get_if<wire::SyncReport>(&decoded.message)) {
        report->heard = report->heard + Microseconds{setup_.clock_jump_us};
    } else if (auto* range = std::get_if<wire::Range>(&decoded.message)) {
        range->reading.capture = wire::classical_residue(NodeTime{range->reading.capture.value_us} +
                                                         Microseconds{setup_.clock_jump_us});
    }
    return wire::encode(decoded.message, decoded.node_id);
}

void AttackedBus::pass_on(const wire::CanFrame& frame, std::int64_t end_us) {
    if (std::bernoulli_distribution(setup_.loss)(random_)) return;
    const wire::CanFrame arriving = as_on_a_jumped_clock(frame, end_us);
    const auto decoded = wire::decode(arriving);
    const auto* range = decoded ? std::get_if<wire::Range>(&decoded->message) : nullptr;
    const std::int64_t half_budget_us = 500 * setup_.budget_ms;
    if (range != nullptr && is_counted(host_of(end_us - half_budget_us)))
        ++counts_[{decoded->node_id, range->reading.sensor}].sent;
    const auto* answer = decoded ? std::get_if<wire::SyncReport>(&decoded->message) : nullptr;
    std::vector<OnTheWay> way;
    if (range != nullptr && setup_.on_reading) {
        setup_.on_reading(decoded->node_id, range->reading, end_us, way);
    } else if (answer != nullptr && setup_.on_answer) {
        setup_.on_answer(decoded->node_id, *answer, end_us, way);
    } else {
        if (decoded && setup_.on_other) setup_.on_other(*decoded);
        way.push_back({end_us, arriving});
    }
    for (const OnTheWay& one : way) way_.emplace(one.arrives_us, one.frame);
}

void AttackedBus::deliver() {
    while (!way_.empty() && way_.begin()->first <= now_us_) {
        const auto [arrives_us, frame] = *way_.begin();
        way_.erase(way_.begin());
        pipeline_->on_can(frame, wall_of(arrives_us));
    }
}

void AttackedBus::look() {
    const CanIntake& intake = pipeline_->intake();
    const auto now = intake.now();
    if (!now) return;
    for (const auto& rig : rigs_) {
        const wire::NodeId node = rig->config().node_id;
        for (std::uint8_t sensor = 0; sensor < setup_.sensors; ++sensor) {
            if (intake.ranges().senders(node, sensor).is_named(*now))
                named_.try_emplace({node, sensor}, now_s());
        }
        if (intake.answers(node).hears_two(*now)) named_clocks_.try_emplace(node, now_s());
        if (intake.self_reports(node).hears_two(*now)) named_words_.try_emplace(node, now_s());
        const NodeCondition verdict = intake.nodes().verdict(node, now);
        if (now_s() > kSettled_s && verdict != NodeCondition::usable) refused_.try_emplace(node, verdict);
        if (const auto loss = intake.losses(node, *now); loss && verdict == NodeCondition::usable) {
            losing_s_.try_emplace(node, now_s());
            losses_.insert_or_assign(node, *loss);
        }
    }
}

std::optional<double> AttackedBus::named_s(SensorKey sensor) const {
    const auto named = named_.find(sensor);
    return named == named_.end() ? std::nullopt : std::optional(named->second);
}

bool AttackedBus::is_counted(HostTime captured) const {
    return captured >= host_of(std::llround(1e6 * kSettled_s)) &&
           captured < host_of(std::llround(1e6 * (setup_.run_s - 0.5)));
}

bool AttackedBus::is_true(const RangeMeasurement& measurement) const {
    constexpr std::int64_t kErrorUs = 1'000;
    const NodeRig& rig = *rigs_.at(static_cast<std::size_t>(measurement.source.node_id - kFirst));
    const std::int64_t captured_us = (measurement.captured.ns - kHostNs) / 1'000;
    const auto& truth = rig.truth(measurement.source.sensor);
    const bool is_of_a_window = std::any_of(truth.rbegin(), truth.rend(), [&](const TrueRange& range) {
        return std::abs(range.window_middle.us - captured_us) <= kErrorUs;
    });
    const bool is_range = measurement.range_m && std::abs(*measurement.range_m - 1e-3 * kTruthMm) < 0.002;
    return is_of_a_window && is_range && measurement.source.zone == 0;
}

void AttackedBus::on_reading(const RangeMeasurement& measurement, const Beam&,
                             std::span<const VoxelUpdate> updates) {
    commits_.emplace_back(measurement);
    if (!is_true(measurement)) {
        if (++untrue_ == 1)
            for (const VoxelUpdate& update : updates) untrue_voxels_.insert(update.key);
    } else if (is_counted(measurement.captured)) {
        ++counts_[{measurement.source.node_id, measurement.source.sensor}].used;
    }
}

std::string AttackedBus::map() const {
    return encode_ot(pipeline_->map());
}

std::string AttackedBus::replayed_map() const {
    Pipeline replayed = make_pipeline(setup_);
    MapBuilder& builder = replayed.builder();
    for (const Commit& commit : commits_) {
        if (const auto* joints = std::get_if<JointMeasurement>(&commit)) {
            EXPECT_TRUE(builder.add(*joints).has_value());
        } else {
            EXPECT_TRUE(builder.integrate(std::get<RangeMeasurement>(commit)).has_value());
        }
    }
    return encode_ot(replayed.map());
}

std::uint64_t AttackedBus::wrong_voxels(const AttackedBus& clean) const {
    const auto states = [](const AttackedBus& bus) {
        std::map<VoxelKey, bool> occupied;
        bus.pipeline_->map().for_each_known(
            [&](VoxelKey key, float log_odds) { occupied[key] = log_odds > 0.0F; });
        return occupied;
    };
    const auto mine = states(*this);
    const auto others = states(clean);
    std::set<VoxelKey> differing;
    for (const auto& [key, is_occupied] : mine)
        if (!others.contains(key) || others.at(key) != is_occupied) differing.insert(key);
    for (const auto& [key, is_occupied] : others)
        if (!mine.contains(key)) differing.insert(key);
    return static_cast<std::uint64_t>(
        std::ranges::count_if(differing, [&](const VoxelKey& key) { return !untrue_voxels_.contains(key); }));
}

}  // namespace octoskin::test
