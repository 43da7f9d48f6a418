#include "host/bridge/view/recorded_view.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/apps/explain/explanation.hpp"
#include "host/apps/query/query_answer.hpp"
#include "host/apps/query/query_request.hpp"
#include "host/apps/query/voxel_answer.hpp"
#include "host/bridge/view/json_text.hpp"
#include "host/io/candump/log_source.hpp"
#include "host/io/watch/map_changes.hpp"

namespace octoskin::view {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds kQueryWorkMax = 10s;
constexpr std::size_t kContributions = 20;

double seconds_between(HostTime begin, HostTime end) {
    return std::chrono::duration<double>(end - begin).count();
}

/// A map of the same voxels without any brick.
watch::WatchedMap emptied(const watch::WatchedMap& map) {
    const FusedMap none(map.map().config());
    watch::MissingBricks bricks;
    watch::WatchedMap empty;
    constexpr std::size_t kBytes = 1024;
    (void)empty.take({.kind = watch::FrameKind::map, .flags = watch::kBegins | watch::kComplete},
                     bricks.take(none, kBytes));
    return empty;
}

}  // namespace

Result<std::unique_ptr<RecordedView>, AppError> RecordedView::open(const PlaybackRequest& request,
                                                                   WebOptions options, MeshSearch meshes) {
    auto events = bridge::RecordedEvents::open(request);
    if (!events) return unexpected(events.error());
    const auto span = span_of(request.recording, events->clock());
    if (!span)
        return fail(ExitCode::bad_data, {.code = ErrorCode::no_data,
                                         .what = "has no frame: there is nothing to show",
                                         .file = request.recording.directory});
    auto host = ViewHost::open(std::move(options), std::move(meshes), "recording");
    if (!host) return unexpected(host.error());
    return std::unique_ptr<RecordedView>(
        new RecordedView(std::move(host).value(), request, std::move(events).value(), *span));
}

RecordedView::RecordedView(std::unique_ptr<ViewHost> host, PlaybackRequest request,
                           bridge::RecordedEvents events, const Span& span)
    : host_(std::move(host)),
      request_(std::move(request)),
      setup_(events.setup()),
      urdf_(events.robot_description()),
      span_(span) {
    add_services();
    sources_.push_back(host_->loop().on_readable(answering_.descriptor(), [this] { take_answer(); }));
    sources_.push_back(host_->loop().every(500ms, [this] {
        forget_unwanted();
        publish_place();
        publish_status();
    }));
    player_.emplace(host_->loop(), std::move(events), *this);
}

/// The time stamps of a damaged log may go back: the largest one counts.
std::optional<RecordedView::Span> RecordedView::span_of(const RecordingPaths& recording,
                                                        const bridge::BusClock& clock) {
    auto reader = candump::LogReader::open(recording.can_log());
    if (!reader) return std::nullopt;
    std::optional<Span> span;
    while (true) {  // to the end, or to what cannot be read: the playback reports it
        const auto entry = reader->next();
        if (!entry || !*entry) return span;
        const HostTime at = clock.bus_of((*entry)->stamp);
        if (!span) span = Span{at, at};
        span->end = std::max(span->end, at);
    }
}

void RecordedView::run() {
    publish_place();
    host_->run();
}

void RecordedView::on_described(const Json& described) {
    host_->view().on_described(described);
}

/// The playback begins: an empty map takes the place of the one before.
void RecordedView::on_robot(bridge::RobotFacts robot) {
    has_ended_ = false;
    positions_.assign(robot.joint_sources.size(), {});
    ranges_.clear();
    host_->view().on_robot(std::move(robot));
    host_->view().on_urdf(urdf_);
    if (map_ && map_->is_whole()) on_map(emptied(*map_));
}

void RecordedView::on_map(const watch::WatchedMap& map) {
    map_ = map;
    host_->view().on_map(map);
}

void RecordedView::on_range(const watch::WatchedRange& range, HostTime captured) {
    ranges_[range.source.sensor_id()] = {captured, range.range_m};
    host_->view().on_range(range, captured);
}

void RecordedView::on_joints(const watch::WatchedJoints& joints, HostTime sampled) {
    if (joints.source < positions_.size()) positions_[joints.source] = joints.position;
    host_->view().on_joints(joints, sampled);
}

void RecordedView::on_status(const Json& status) {
    problems_ = status.value("problems", std::vector<Json>());
    publish_status();
}

Json RecordedView::sensor_status(const HostNode& node, std::size_t index) const {
    const auto number = static_cast<std::uint8_t>(index);
    const auto now = player_ ? player_->now() : std::nullopt;
    const auto newest = ranges_.find(SensorId{node.node_id, number});
    const bool has_any = newest != ranges_.end() && now;
    const bool has_target = has_any && newest->second.range_m;
    return {{"index", index},
            {"name", node.sensors[index].name},
            {"state", has_any ? Json("ranging") : Json()},
            {"age_s", has_any ? Json(seconds_between(newest->second.captured, *now)) : Json()},
            {"range_m", has_target ? Json(*newest->second.range_m) : Json()},
            {"rejected", has_any && !has_target ? Json("no_return") : Json()},
            {"fault", nullptr},
            {"disputed", false},
            {"camera", nullptr}};
}

Json RecordedView::nodes_status() const {
    Json nodes = Json::array();
    for (const HostNode& node : setup_->rig.nodes) {
        Json sensors = Json::array();
        for (std::size_t i = 0; i < node.sensors.size(); ++i) sensors.push_back(sensor_status(node, i));
        nodes.push_back(
            {{"id", node.node_id}, {"name", node.name}, {"verdict", "recorded"}, {"sensors", sensors}});
    }
    return nodes;
}

void RecordedView::publish_status() {
    const std::size_t known = map_ && map_->is_whole() ? map_->map().known_voxels() : 0;
    host_->view().on_status({{"problems", problems_},
                             {"nodes", nodes_status()},
                             {"map", {{"known_voxels", known}}},
                             {"inputs", Json::object()}});
}

void RecordedView::on_image(const watch::WatchedImage& image, HostTime captured) {
    host_->view().on_image(image, captured);
}

void RecordedView::on_lost(const std::string& why) {
    host_->view().on_lost(why);
}

void RecordedView::on_end(const std::optional<AppError>& error) {
    has_ended_ = true;
    if (error) on_lost(error->error.message());
    publish_place();
}

void RecordedView::publish_place() {
    const double end_s = seconds_between(span_.begin, span_.end);
    const auto now = player_ ? player_->now() : std::nullopt;
    const double reached_s = now ? std::min(end_s, seconds_between(span_.begin, *now)) : 0.0;
    host_->view().change_place({{"begin_s", 0.0},
                                {"end_s", end_s},
                                {"now_s", has_ended_ ? end_s : reached_s},
                                {"speed", player_ ? player_->speed() : 1.0}});
}

void RecordedView::add_services() {
    FoxgloveServer& server = host_->server();
    server.add_service("/octoskin/voxel", "octoskin.Voxel",
                       [this](const std::string& request, const Reply& reply) { reply(voxel(request)); });
    server.add_service("/octoskin/play", "octoskin.Play",
                       [this](const std::string& request, const Reply& reply) { reply(play(request)); });
    server.add_service("/octoskin/query", "octoskin.Query", [this](const std::string& request, Reply reply) {
        ask(query(request), std::move(reply));
    });
    server.add_service(
        "/octoskin/explain", "octoskin.Explain",
        [this](const std::string& request, Reply reply) { ask(explanation(request), std::move(reply)); });
}

void RecordedView::ask(std::function<Answer()> work, Reply reply) {
    if (questions_.size() >= kQuestionsMax)
        return reply(unexpected(std::string("too many questions wait: ask again later")));
    questions_.push_back({std::move(work), std::move(reply)});
    if (questions_.size() == 1) begin_next_question();
}

void RecordedView::begin_next_question() {
    *is_forgotten_ = false;
    answering_.begin(std::exchange(questions_.front().work, nullptr));
}

void RecordedView::take_answer() {
    auto answer = answering_.take();
    if (!answer) return;
    const Reply reply = std::move(questions_.front().reply);
    questions_.pop_front();
    while (!questions_.empty() && !questions_.front().reply.is_wanted()) questions_.pop_front();
    if (!questions_.empty()) begin_next_question();
    reply(std::move(*answer));
}

void RecordedView::forget_unwanted() {
    if (!questions_.empty() && !questions_.front().reply.is_wanted()) *is_forgotten_ = true;
    const auto waiting = questions_.begin() + (questions_.empty() ? 0 : 1);
    questions_.erase(
        std::remove_if(waiting, questions_.end(), [](const Question& one) { return !one.reply.is_wanted(); }),
        questions_.end());
}

Answer RecordedView::voxel(const std::string& request) const {
    if (!map_ || !map_->is_whole()) return unexpected(std::string("there is no map yet"));
    return text_of(answer_voxel("voxel " + request, map_->map()));
}

/// {"at_s": seconds since the beginning or null, "speed": 0 or more}
Answer RecordedView::play(const std::string& request) {
    const Json json = Json::parse(request, nullptr, false);
    const Json at_s = json.is_object() && json.contains("at_s") ? json["at_s"] : Json();
    const Json speed = json.is_object() && json.contains("speed") ? json["speed"] : Json();
    constexpr double kSpeedMax = 1000.0;
    constexpr double kAtMax_s = 1e7;
    const auto is_within = [](const Json& value, double max) {
        return value.is_number() && value.get<double>() >= 0.0 && value.get<double>() <= max;
    };
    const bool is_too_slow = is_within(speed, RecordedPlayer::kSpeedMin) && speed.get<double>() != 0.0 &&
                             speed.get<double>() != RecordedPlayer::kSpeedMin;
    if (is_too_slow || !is_within(speed, kSpeedMax) || !(at_s.is_null() || is_within(at_s, kAtMax_s)))
        return unexpected(std::string(R"(expected {"at_s": seconds or null, "speed": 0, or 0.001 to 1000})"));
    std::optional<HostTime> at;
    if (!at_s.is_null()) at = span_.begin + Nanoseconds{static_cast<std::int64_t>(1e9 * at_s.get<double>())};
    player_->play(at, speed.get<double>());
    return std::string(R"({"ok":true})");
}

/// The same answer as of a daemon whose map and arm are these.
std::function<Answer()> RecordedView::query(const std::string& request) const {
    std::vector<double> present;
    for (const std::vector<double>& source : positions_) {
        if (source.empty()) {
            present.clear();
            break;
        }
        present.insert(present.end(), source.begin(), source.end());
    }
    return [request, setup = setup_, map = map_, present = std::move(present),
            is_forgotten = is_forgotten_]() -> Answer {
        if (!map || !map->is_whole()) return unexpected(std::string("there is no map yet"));
        const auto asked = read_query("query " + request);
        if (!asked) return text_of(query_refused(asked.error()));
        return text_of(answer_query(*asked,
                                    {.rig = &setup->rig,
                                     .robot = &setup->robot,
                                     .map = map->map(),
                                     .present = present,
                                     .is_live = true,
                                     .work_max = kQueryWorkMax},
                                    [&] { return is_forgotten->load(); }));
    };
}

/// Replays all of the recording, in seconds to minutes.
std::function<Answer()> RecordedView::explanation(const std::string& request) const {
    return [request, playback = request_, is_forgotten = is_forgotten_]() -> Answer {
        struct Forgotten {};
        const auto point = requested_point(request);
        if (!point) return unexpected(std::string(R"(expected {"point_m": [x, y, z]})"));
        const auto go_on = [&](const ReplayProgress&) {
            if (*is_forgotten) throw Forgotten{};
        };
        const auto explained = [&]() -> Result<Explanation, AppError> {
            try {
                return explain(playback, *point, kContributions, go_on);
            } catch (const Forgotten&) {
                return fail(ExitCode::unavailable, {ErrorCode::cancelled, "the question was cancelled"});
            }
        }();
        if (!explained) return text_of(query_refused(explained.error()));
        return text_of(to_json(*explained));
    };
}

}  // namespace octoskin::view
