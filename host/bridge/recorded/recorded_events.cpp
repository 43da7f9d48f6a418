#include "host/bridge/recorded/recorded_events.hpp"

#include <algorithm>
#include <cassert>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "host/apps/daemon/description.hpp"
#include "host/apps/playback/data_set_playback.hpp"
#include "host/apps/playback/film_playback.hpp"
#include "host/apps/robot/fitted_robot.hpp"
#include "host/io/candump/log_source.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "host/io/watch/map_changes.hpp"

namespace octoskin::bridge {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kUrdfBytesMax = std::size_t{16} << 20U;

/// As the daemon's status, with what concerns a recording.
Json status_of(const std::vector<std::string>& sentences) {
    Json problems = Json::array();
    for (const std::string& sentence : sentences)
        problems.push_back({{"code", "recording"}, {"on", "recording"}, {"text", sentence}});
    return {{"problems", std::move(problems)}};
}

/// Turns the commits of a playback to the calls of a daemon's listener.
class Events final : public CommitListener {
  public:
    Events(DaemonListener& listener, RecordedDetails& details, const BusClock& clock,
           const std::vector<std::size_t>& joints)
        : listener_(listener), details_(details), clock_(clock), joint_counts_(joints) {}

    void on_begin(const FusedMap& map) override { begun_with_.emplace(map.copy()); }
    void on_joints(const JointMeasurement& joints) override {
        advance(joints.sampled);
        const auto begin = joints.position_rad.begin();
        const auto count = static_cast<std::ptrdiff_t>(joint_counts_.at(joints.source));
        listener_.on_joints({joints.source, std::vector(begin, begin + count)}, joints.sampled);
    }
    void on_reading(const RangeMeasurement&, const Beam& beam, std::span<const VoxelUpdate>) override {
        advance(beam.captured);
        listener_.on_range({beam.source, beam.range_m, beam.sigma_m, beam.p_map_sensor, beam.direction_map},
                           beam.captured);
    }
    void on_depth(const DepthFrame& frame, const Evidence&) override {
        advance(frame.captured);
        details_.on_depth(frame);
    }
    void on_maps(std::span<const FedMap> maps) override {
        const FusedMap* const map = find_map(maps, MapFeed::both);
        const bool is_due = !given_ || now_ - *given_ >= RecordedEvents::kMapPeriod;
        if (map != nullptr && is_due) give(*map);
    }

    /// The map as it is now, if it is another one than the listener has.
    void give(const FusedMap& map) {
        watch::MissingBricks missing;
        missing.add(before_ ? watch::changed_bricks(map, *before_) : watch::bricks_of(map));
        if (before_ && missing.empty()) return;
        std::uint8_t flags = before_ ? 0 : watch::kBegins;
        do {
            const std::string payload = missing.take(map, kPayloadBytes);
            if (missing.empty()) flags |= watch::kComplete;
            const auto taken =
                watched_.take({.kind = watch::FrameKind::map, .flags = flags, .time = now_}, payload);
            assert(taken != watch::WatchedMap::Taken::malformed);
            if (taken != watch::WatchedMap::Taken::all)
                return;  // the mapping's limit is lower than the map's
            flags = 0;
        } while (!missing.empty());
        before_.emplace(map.copy());
        given_ = now_;
        listener_.on_map(watched_);
    }

  private:
    static constexpr std::size_t kPayloadBytes = std::size_t{64} << 10U;

    void advance(HostTime time) {
        if (!has_begun_ || time > now_) now_ = time;
        details_.on_time(now_, clock_.wall_of(now_));
        if (!std::exchange(has_begun_, true) && begun_with_) give(*begun_with_);
    }

    DaemonListener& listener_;
    RecordedDetails& details_;
    const BusClock& clock_;
    const std::vector<std::size_t>& joint_counts_;
    std::optional<FusedMap> begun_with_;
    std::optional<FusedMap> before_;  ///< what the listener has
    watch::WatchedMap watched_;
    std::optional<HostTime> given_;
    HostTime now_;
    bool has_begun_ = false;
};

Status<AppError> check(const PlaybackRequest& request) {
    if (is_data_set(request.recording) || lone_film(request.recording))
        return fail(ExitCode::bad_data, {.code = ErrorCode::unsupported,
                                         .what = "has images only: a recording with a can.log is needed",
                                         .file = request.recording.directory});
    return check_playable(request);
}

Result<std::string, AppError> urdf_of(const PlaybackRequest& request, const rig::Rig& rig) {
    const FilePlace place = request.robot.urdf.empty() ? rig.urdf : FilePlace(request.robot.urdf);
    auto text = place.read(kUrdfBytesMax);
    if (!text) return fail(ExitCode::bad_config, to_error(text.error()));
    return std::move(text).value();
}

std::optional<BusClock> clock_of(const RecordingPaths& recording, const HostRig& rig) {
    auto reader = candump::LogReader::open(recording.can_log());
    if (!reader) return std::nullopt;  // reported by the playback
    BusClockSearch search(rig);
    while (!search.clock()) {
        const auto entry = reader->next();
        if (!entry || !*entry) break;
        search.take((*entry)->frame, (*entry)->stamp);
    }
    return search.clock();
}

}  // namespace

Result<RecordedEvents, AppError> RecordedEvents::open(PlaybackRequest request) {
    if (const auto checked = check(request); !checked) return unexpected(checked.error());
    auto rig = read_rig_with_body(request.rig.empty() ? request.recording.rig() : FilePlace(request.rig),
                                  request.robot, BodyFitting::if_needed);
    if (!rig) return unexpected(rig.error());
    auto urdf = urdf_of(request, *rig);
    if (!urdf) return unexpected(urdf.error());
    const auto setup = make_host_setup(*rig);
    if (!setup) return fail(ExitCode::bad_config, setup.error());
    Json described = description_json(*setup, true, 0);
    auto facts = robot_facts(described);
    if (!facts) return fail(ExitCode::failed, {ErrorCode::self_check, facts.error()});
    auto clock = clock_of(request.recording, setup->rig);
    request.maps = {MapFeed::both};
    return RecordedEvents(std::move(request), std::make_shared<const HostSetup>(*setup), std::move(described),
                          std::move(facts).value(), std::move(urdf).value(), clock);
}

RecordedEvents::RecordedEvents(PlaybackRequest request, std::shared_ptr<const HostSetup> setup,
                               Json described, RobotFacts robot, std::string urdf,
                               std::optional<BusClock> clock)
    : request_(std::move(request)),
      setup_(std::move(setup)),
      described_(std::move(described)),
      robot_(std::move(robot)),
      urdf_(std::move(urdf)),
      joint_counts_(setup_->rig.joint_counts()),
      clock_(clock.value_or(BusClock(Nanoseconds{0}))),
      has_wall_time_(clock.has_value()) {}

Result<Playback, AppError> RecordedEvents::play(DaemonListener& listener, RecordedDetails* details,
                                                const ReplayReport& report) {
    RecordedDetails none;
    Events events(listener, details == nullptr ? none : *details, clock_, joint_counts_);
    PlaybackRequest request = request_;
    request.listener = &events;
    listener.on_described(described_);
    listener.on_robot(robot_);
    listener.on_status(status_of({}));
    auto playback = play_recording(request, report);
    if (!playback) return playback;
    events.give(playback->pipeline.map());
    listener.on_status(status_of(playback->warnings));
    return playback;
}

}  // namespace octoskin::bridge
