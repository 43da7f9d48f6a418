#include "host/apps/daemon/status.hpp"

#include <nlohmann/json.hpp>

#include "common/wire/names.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/version/version.hpp"
#include "host/core/ingest/node_silence.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;

double milliseconds(Nanoseconds duration) {
    return static_cast<double>(duration.count()) * 1e-6;
}
Json age_s(const std::optional<HostTime>& since, const std::optional<HostTime>& now) {
    return since && now ? Json(seconds_of(*now - *since)) : Json(nullptr);
}

/// Links without a body: all of them, or only those that the rig does not list.
Json links_json(const HostRig& rig, bool leaves_out_listed) {
    Json names = Json::array();
    for (const LinkWithoutBody& link : rig.links_without_body)
        if (!leaves_out_listed || !link.is_listed) names.push_back(link.link);
    return names;
}

Json borrowed_json(const HostRig& rig) {
    Json lenders = Json::object();
    for (const LinkWithBorrowedBody& link : rig.links_with_borrowed_body) lenders[link.link] = link.body_of;
    return lenders;
}

Json can_json(const DaemonView& view) {
    const CanLink::Counts counts = view.inputs->can().counts();
    return {{"interface", *view.interface},
            {"state", names_of(LinkState{})[static_cast<std::size_t>(view.inputs->can().state())]},
            {"why", view.inputs->can().why()},
            {"listen_only", view.is_listen_only},
            {"received", counts.received},
            {"sent", counts.sent},
            {"not_sent", counts.not_sent},
            {"foreign_follow_ups", view.inputs->foreign_follow_ups()},
            {"busy_s", seconds_of(view.inputs->bus_busy())},
            {"error_frames", counts.error_frames},
            {"dropped_by_kernel", counts.dropped},
            {"malformed", counts.malformed},
            {"bus_off", counts.bus_off},
            {"went_down", counts.went_down},
            {"reopened", counts.reopened}};
}

Json clock_json(const DaemonView& view) {
    const Pipeline& pipeline = *view.pipeline;
    const HostClockEstimate& clock = pipeline.intake().host_clock();
    return {{"known", pipeline.now().has_value()},
            {"steps_back", clock.steps_back()},
            {"steps_ahead", clock.steps_ahead()},
            {"stamps_ignored", clock.stamps_ignored()},
            {"relocks", clock.relocks()},
            {"times_back", pipeline.times_back()},
            {"times_ahead", pipeline.times_ahead()},
            {"follow_up_outliers", view.inputs->foreign_clock().outliers()}};
}

Json not_excluded_json(const SensorEvidence& evidence) {
    Json faults = Json::array();
    for (std::size_t i = 0; i < kRangeFaults; ++i)
        if (evidence.not_excluded[i]) faults.push_back(name(static_cast<RangeFault>(i)));
    return faults;
}

/// Null if ranges are not compared with a camera.
Json cross_check_json(const DaemonView& view, std::uint8_t node_id, std::uint8_t sensor) {
    const MapBuilder& builder = view.pipeline->builder();
    if (builder.cross_checks() == nullptr) return nullptr;
    const auto [evidence, camera] = builder.cross_checks()->finding(node_id, sensor);
    return {{"of", view.rig->cameras.at(camera).name},
            {"verdict", name(evidence.verdict())},
            {"contradicts", evidence.contradicts()},
            {"fault", evidence.fault ? Json(name(*evidence.fault)) : Json(nullptr)},
            {"doubt", evidence.doubt ? Json(name(*evidence.doubt)) : Json(nullptr)},
            {"not_excluded", not_excluded_json(evidence)},
            {"refused", builder.is_refused(node_id, sensor)},
            {"compared", evidence.compared},
            {"fitted", evidence.fitted},
            {"agreed", evidence.agreed},
            {"in_free_space", evidence.in_free_space},
            {"behind_surface", evidence.behind_surface}};
}

Json sensor_json(const DaemonView& view, const HostNode& node, std::size_t index) {
    const SensorRecord& record =
        view.pipeline->intake().ranges().record(node.node_id, static_cast<std::uint8_t>(index));
    const bool is_known = record.health && !is_unheard(record, view.bus_now);
    Json json = {{"index", index},
                 {"name", node.sensors[index].name},
                 {"state", is_known ? Json(name(record.health->state)) : Json(nullptr)},
                 {"fault", is_known ? Json(name(record.health->fault)) : Json(nullptr)},
                 {"received", record.received},
                 {"lost", record.sent.lost()},
                 {"age_s", age_s(record.arrivals.newest(), view.bus_now)}};
    if (record.newest) {
        json["range_m"] = record.newest->range_mm * 1e-3;
        json["sigma_m"] = record.newest->sigma_quarter_mm * 0.25e-3;
        json["device_status"] = record.newest->device_status;
        json["zone"] = record.newest->zone;
    }
    json["rejected"] =
        record.newest_rejected
            ? Json(names_of(ReadingReason{})[static_cast<std::size_t>(*record.newest_rejected)])
            : Json(nullptr);
    const SenderWatch& senders =
        view.pipeline->intake().ranges().senders(node.node_id, static_cast<std::uint8_t>(index));
    json["contradictions"] = senders.contradictions();
    json["strays"] = senders.strays();
    json["second_sender"] = view.bus_now && senders.is_named(*view.bus_now);
    json["disputed"] = view.bus_now && senders.is_disputed(*view.bus_now);
    json["reflexes"] = record.reflexes;
    json["reflex_below_m"] = node.sensors[index].reflex_below_m;
    json["reflex_m"] = record.reflex ? Json(record.reflex->range_mm * 1e-3) : Json(nullptr);
    json["camera"] = cross_check_json(view, node.node_id, static_cast<std::uint8_t>(index));
    return json;
}

Json register_json(const wire::RegisterReport& report, bool is_alike) {
    return {{"register", report.index},
            {"written", report.written},
            {"read", report.read},
            {"alike", is_alike},
            {"sensor", is_alike ? Json(nullptr) : Json(report.subject)},
            {"sensors", is_alike ? report.subject : 1}};
}

/// Without those of sensors that are well by now.
Json registers_json(const DaemonView& view, const HostNode& node, const NodeRecord& record) {
    Json registers = Json::array();
    for (const wire::RegisterReport& report : record.registers.alike())
        registers.push_back(register_json(report, true));
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
        const auto sensor = static_cast<std::uint8_t>(i);
        const auto& health = view.pipeline->intake().ranges().record(node.node_id, sensor).health;
        const auto& report = record.registers.of_sensor(sensor);
        if (report && health && health->fault == wire::SensorFault::config_mismatch)
            registers.push_back(register_json(*report, false));
    }
    return registers;
}

Json node_json(const DaemonView& view, const HostNode& node) {
    const CanIntake& intake = view.pipeline->intake();
    const NodeRecord& record = intake.nodes().records().at(node.node_id);
    const NodeCondition verdict = intake.nodes().verdict(node.node_id, view.bus_now);
    const auto reason = intake.nodes().reason(node.node_id, view.bus_now);
    const ClockMap& clock = intake.clock(node.node_id);
    const bool is_clock_known = view.bus_now && !clock.fault(*view.bus_now);
    const auto drift = clock.drift();
    const auto clock_error = view.bus_now ? clock.error_bound(*view.bus_now) : std::nullopt;
    Json json = {
        {"id", node.node_id},
        {"name", node.name},
        {"verdict", names_of(NodeCondition{})[static_cast<std::size_t>(verdict)]},
        {"reason", reason ? Json(reason->text()) : Json(nullptr)},
        {"state", record.heartbeat ? Json(name(record.heartbeat->state)) : Json(nullptr)},
        {"age_s", age_s(record.heard, view.bus_now)},
        {"degraded_sensors", record.heartbeat ? Json(record.heartbeat->degraded_sensors) : Json(nullptr)},
        {"clock_known", is_clock_known},
        {"clock_ppm", drift ? Json(*drift * 1e6) : Json(nullptr)},
        {"clock_error_ms", clock_error ? Json(milliseconds(*clock_error)) : Json(nullptr)}};
    const auto loss = view.bus_now ? intake.losses(node.node_id, *view.bus_now) : std::nullopt;
    json["refused_share"] = loss ? Json(loss->share) : Json(nullptr);
    json["refused_most"] =
        loss ? Json(names_of(ReadingReason{})[static_cast<std::size_t>(loss->most)]) : Json(nullptr);
    json["clock_contradictions"] = intake.answers(node.node_id).contradictions();
    json["restarts"] = record.restarts;
    json["registers"] = registers_json(view, node, record);
    Json sensors = Json::array();
    for (std::size_t i = 0; i < node.sensors.size(); ++i) sensors.push_back(sensor_json(view, node, i));
    json["sensors"] = std::move(sensors);
    return json;
}

/// The fault that the comparison of a camera's images with ranges finds, if any.
PoseFault pose_fault(const DaemonView& view, std::size_t camera) {
    const CrossChecks* const checks = view.pipeline->builder().cross_checks();
    return checks != nullptr ? checks->pose_fault(camera).value_or(PoseFault{}) : PoseFault{};
}

/// The first fault of a joint that the comparison with a camera finds, if any.
PoseFault joint_fault(const DaemonView& view) {
    for (std::size_t camera = 0; camera < view.rig->cameras.size(); ++camera)
        if (const PoseFault fault = pose_fault(view, camera); fault.joint) return fault;
    return {};
}

Json camera_json(const DaemonView& view, std::size_t index) {
    const HostCamera& of_rig = view.rig->cameras.at(index);
    const CameraRecord& camera = view.cameras[index];
    const bool is_compared = view.pipeline->builder().cross_checks() != nullptr;
    const PoseFault fault = pose_fault(view, index);
    const auto& error = fault.camera;
    const auto axes = [](const Eigen::Vector3d& of) { return Json{of.x(), of.y(), of.z()}; };
    return {{"name", of_rig.name},
            {"link", of_rig.link},
            {"device", of_rig.device},
            {"open", camera.is_open},
            {"why", camera.why},
            {"frames", camera.frames},
            {"displaced", camera.displaced},
            {"untimed", camera.untimed},
            {"repeated", camera.repeated},
            {"opened", camera.opened},
            {"is_off", is_compared ? Json(error && !fault.joint) : Json(nullptr)},
            {"turned_deg", error ? axes(error->turn_deg) : Json(nullptr)},
            {"shifted_m", error ? axes(error->shift_m) : Json(nullptr)},
            {"depth_scale", error ? Json(error->depth_scale) : Json(nullptr)},
            {"explains_sensors", error ? fault.explained : 0},
            {"age_s", age_s(camera.newest, view.now)}};
}

Json cameras_json(const DaemonView& view) {
    Json cameras = Json::array();
    for (std::size_t i = 0; i < std::min(view.cameras.size(), view.rig->cameras.size()); ++i)
        cameras.push_back(camera_json(view, i));
    return cameras;
}

std::uint64_t joint_contradictions(const Pipeline& pipeline, const HostRig& rig) {
    std::uint64_t contradictions = 0;
    for (std::size_t i = 0; i < rig.joint_sources.size(); ++i)
        contradictions += pipeline.intake().joint_senders(i).contradictions();
    return contradictions;
}

Json joint_sources_json(const DaemonView& view) {
    const RobotTracker& robot = view.pipeline->builder().robot();
    const std::span<const std::uint64_t> unknown = robot.times_unknown();
    Json sources = Json::array();
    std::size_t joint = 0;
    for (std::size_t i = 0; i < view.rig->joint_sources.size(); ++i) {
        const HostJointSource& source = view.rig->joint_sources[i];
        Json joints = Json::array();
        for (const std::string& name : source.joints)
            joints.push_back({{"name", name}, {"poses_without", unknown[joint++]}});
        sources.push_back({{"node_id", source.node_id},
                           {"via", source.is_local ? "socket" : "can"},
                           {"rate_hz", source.rate_hz},
                           {"age_s", age_s(robot.newest_sample(i), view.bus_reckoned)},
                           {"joints", std::move(joints)}});
    }
    return sources;
}

Json joint_states_json(const DaemonView& view) {
    const auto jump = newest_jump(view);
    const PoseFault fault = joint_fault(view);
    const std::vector<std::string> joints = view.rig->joint_names();
    return {{"sources", joint_sources_json(view)},
            {"second_sender", are_joints_withheld(view)},
            {"contradictions", joint_contradictions(*view.pipeline, *view.rig)},
            {"jumped", jump ? Json(jump->name) : Json(nullptr)},
            {"jump_age_s", age_s(view.used.joint_jump, view.now)},
            {"off_joint", fault.joint ? Json(joints.at(fault.joint->joint)) : Json(nullptr)},
            {"off_by", fault.joint ? Json(fault.joint->offset) : Json(nullptr)},
            {"or_camera", fault.joint && fault.camera}};
}

void add_senders(const JointSenders& senders, wire::NodeId node, HostTime now, Json& all) {
    for (const JointSenders::Heard& heard : senders.heard(now)) {
        all.push_back({{"node_id", node},
                       {"pid", heard.sender.pid},
                       {"uid", heard.sender.uid},
                       {"program", heard.program},
                       {"address", heard.sender.address},
                       {"samples", heard.samples},
                       {"age_s", seconds_of(now - heard.newest)}});
    }
}

Json joints_json(const DaemonView& view) {
    const JointSocket* const joints = view.inputs->joints();
    if (joints == nullptr) return nullptr;
    double rate_hz = 0.0;
    Json senders = Json::array();
    for (std::size_t i = 0; i < joints->joints().sources.size(); ++i) {
        rate_hz += joints->rate_hz(i, view.now);
        const std::size_t source = joints->joints().sources[i].index;
        add_senders(joints->senders(i), view.rig->joint_sources.at(source).node_id, view.now, senders);
    }
    Json json = {{"samples", joints->samples()},
                 {"displaced", view.inputs->joints_displaced()},
                 {"surplus", joints->surplus()},
                 {"thinned", view.inputs->joints_thinned()},
                 {"second_sender", view.inputs->joints_of_several()},
                 {"rate_hz", rate_hz},
                 {"above_rate", are_joints_above_rate(view)},
                 {"joint_node_ignored", view.inputs->joint_node_ignored()}};
    for (std::size_t i = 0; i < joints->faults().size(); ++i)
        json[names_of(JointTextFault{}).at(i)] = joints->faults().at(i);
    json["senders"] = std::move(senders);
    return json;
}

Json latency_json(const LatencyHistogram& latency, const LatencyHistogram& age) {
    return {{"readings", latency.count()},
            {"median_ms", milliseconds(latency.within(0.5))},
            {"p99_ms", milliseconds(latency.within(0.99))},
            {"max_ms", milliseconds(latency.longest())},
            {"age_median_ms", milliseconds(age.within(0.5))},
            {"age_p99_ms", milliseconds(age.within(0.99))},
            {"age_max_ms", milliseconds(age.longest())}};
}

Json map_json(const DaemonView& view) {
    const FusedMap& map = view.pipeline->map();
    return {{"known_voxels", map.known_voxels_at(view.bus_reckoned)},
            {"resolution_m", map.resolution_m()},
            {"memory_mib", static_cast<double>(map.memory_bytes()) / (1U << 20U)},
            {"memory_max_mib", map.config().memory_max_mib},
            {"no_room", map.counters().no_room},
            {"no_memory", map.counters().no_memory},
            {"undated", map.counters().undated},
            {"saved", view.saves.saved},
            {"saves_failed", view.saves.failed},
            {"saves_skipped", view.saves.skipped},
            {"saved_age_s", age_s(view.saves.newest, view.now)},
            {"folder_silent_s", age_s(view.maps_silent_since, view.now)}};
}

Json inputs_json(const Pipeline& pipeline) {
    Json units = Json::object();
    for (const CounterTable& table : pipeline.counter_tables()) {
        Json rejected = Json::object();
        for (const CounterTable::Row& row : table.rejected)
            if (row.count > 0) rejected[row.name] = row.count;
        units[table.title()] = {{"in", table.in},
                                {"used", table.used},
                                {"pending", table.pending},
                                {"rejected", std::move(rejected)},
                                {"balanced", table.is_balanced}};
    }
    return units;
}

}  // namespace

namespace {

void note_one(std::uint64_t count, std::uint64_t& before, std::optional<HostTime>& last, HostTime now) {
    if (count > before) last = now;
    before = count;
}

void note_camera(const InputCounters<DepthReason>& frames, CameraUse& use, HostTime now) {
    constexpr Nanoseconds kAgain{1'000'000'000};
    note_one(frames.used(), use.used_before, use.frame, now);
    const auto before = use.left_out;
    note_one(frames.rejected(DepthReason::queue_overflow), use.left_out_before, use.left_out, now);
    if (use.left_out == now && (!before || now - *before > kAgain)) use.left_out_since = now;
}

}  // namespace

void LastUsed::note(const Pipeline& pipeline, const HostRig& rig, HostTime now) {
    const PipelineInputs& inputs = pipeline.inputs();
    note_one(inputs.joint_samples.used(), counts_[0], joint_sample, now);
    note_one(inputs.readings.used(), counts_[1], reading, now);
    note_one(pipeline.times_back(), counts_[2], time_back, now);
    note_one(pipeline.times_ahead(), counts_[3], time_ahead, now);
    note_one(inputs.joint_samples.rejected(JointReason::joint_jump), counts_[4], joint_jump, now);
    note_one(inputs.joint_samples.rejected(JointReason::second_sender) + joint_contradictions(pipeline, rig),
             counts_[5], joint_senders, now);
    cameras.resize(inputs.depth_frames.size());
    for (std::size_t i = 0; i < cameras.size(); ++i) note_camera(inputs.depth_frames[i], cameras[i], now);
}

/// Fields that are empty are left out.
Json problem_json(const Problem& problem) {
    Json json{{"code", name_of(problem.code)}, {"text", problem.text()}};
    const auto put = [&json](const char* key, const std::string& value) {
        if (!value.empty()) json[key] = value;
    };
    put("on", problem.on);
    put("key", problem.key);
    put("remedy", problem.remedy);
    return json;
}

Json status_json(const DaemonView& view) {
    Json nodes = Json::array();
    for (const HostNode& node : view.rig->nodes) nodes.push_back(node_json(view, node));
    Json reported = Json::array();
    for (const Problem& problem : problems(view)) reported.push_back(problem_json(problem));
    return {{"octoskin", program_version()},
            {"uptime_s", seconds_of(view.now - view.started)},
            {"rig", view.rig->name},
            {"links_without_body", links_json(*view.rig, false)},
            {"links_unknown", links_json(*view.rig, true)},
            {"links_with_borrowed_body", borrowed_json(*view.rig)},
            {"problems", std::move(reported)},
            {"can", can_json(view)},
            {"clock", clock_json(view)},
            {"nodes", std::move(nodes)},
            {"joint_states", joint_states_json(view)},
            {"joints_socket", joints_json(view)},
            {"recording", view.recorder != nullptr ? view.recorder->to_json(view.now) : Json(nullptr)},
            {"cameras", cameras_json(view)},
            {"latency", latency_json(view.inputs->latency(), view.inputs->age())},
            {"map", map_json(view)},
            {"reloads",
             {{"count", view.reloads.count},
              {"unchanged", view.reloads.unchanged},
              {"dropped", view.reloads.dropped},
              {"reading_s", age_s(view.reloads.reading_since, view.now)}}},
            {"watch",
             {{"watchers", view.watch.watchers}, {"stalled", view.watch.stalled}, {"lost", view.watch.lost}}},
            {"log",
             {{"dropped", view.log.dropped},
              {"waiting", view.log.waiting},
              {"stuck_s", age_s(view.log.stuck_since, view.now)}}},
            {"inputs", inputs_json(*view.pipeline)}};
}

}  // namespace octoskin
