// The view of a recording, which the server plays: the same channels as of a daemon, and what `octoskin
// explain` says of a voxel.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/daemon/side_task.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/bridge/recorded/recorded_events.hpp"
#include "host/bridge/view/recorded_player.hpp"
#include "host/bridge/view/view_host.hpp"
#include "host/core/rig/sensor_id.hpp"

namespace octoskin::view {

class RecordedView final : public PlayerListener {
  public:
    /// Questions that wait for the one that is being answered; further ones are refused.
    static constexpr std::size_t kQuestionsMax = 8;

    /// Reads rig, robot and the times of the recording, and listens. Errors: those of RecordedEvents::open().
    /// `meshes`: where those of the robot are; none are in a recording.
    [[nodiscard]] static Result<std::unique_ptr<RecordedView>, AppError> open(const PlaybackRequest& request,
                                                                              WebOptions options,
                                                                              MeshSearch meshes);
    ~RecordedView() override { *is_forgotten_ = true; }
    RecordedView(const RecordedView&) = delete;
    RecordedView& operator=(const RecordedView&) = delete;

    [[nodiscard]] std::string url() const { return host_->url(); }
    /// Until SIGTERM or SIGINT. Throws std::bad_alloc.
    void run();

    void on_described(const nlohmann::ordered_json& described) override;
    void on_robot(bridge::RobotFacts robot) override;
    void on_map(const watch::WatchedMap& map) override;
    void on_range(const watch::WatchedRange& range, HostTime captured) override;
    void on_joints(const watch::WatchedJoints& joints, HostTime sampled) override;
    void on_status(const nlohmann::ordered_json& status) override;
    void on_image(const watch::WatchedImage& image, HostTime captured) override;
    void on_lost(const std::string& why) override;
    void on_end(const std::optional<AppError>& error) override;

  private:
    struct Question {
        std::function<Answer()> work;
        Reply reply;
    };
    struct NewestRange {
        HostTime captured;
        std::optional<double> range_m;
    };
    /// Of the bus: the first and the last frame of the log.
    struct Span {
        HostTime begin;
        HostTime end;
    };
    RecordedView(std::unique_ptr<ViewHost> host, PlaybackRequest request, bridge::RecordedEvents events,
                 const Span& span);
    [[nodiscard]] static std::optional<Span> span_of(const RecordingPaths& recording,
                                                     const bridge::BusClock& clock);
    void add_services();
    void ask(std::function<Answer()> work, Reply reply);
    void begin_next_question();
    void take_answer();
    void publish_place();
    /// The problems of the playback, and of each sensor the newest range. A playback has no counters before
    /// its end.
    void publish_status();
    [[nodiscard]] nlohmann::ordered_json nodes_status() const;
    [[nodiscard]] nlohmann::ordered_json sensor_status(const HostNode& node, std::size_t index) const;
    [[nodiscard]] Answer voxel(const std::string& request) const;
    [[nodiscard]] Answer play(const std::string& request);
    /// Questions whose client has gone are not answered, and the one in work is ended.
    void forget_unwanted();
    [[nodiscard]] std::function<Answer()> query(const std::string& request) const;
    [[nodiscard]] std::function<Answer()> explanation(const std::string& request) const;

    std::unique_ptr<ViewHost> host_;
    PlaybackRequest request_;
    std::shared_ptr<const HostSetup> setup_;
    std::string urdf_;
    Span span_;
    std::map<SensorId, NewestRange> ranges_;
    std::vector<nlohmann::ordered_json> problems_;
    std::optional<watch::WatchedMap> map_;
    bool has_ended_ = false;                      ///< all of the recording was played
    std::vector<std::vector<double>> positions_;  ///< newest, of each joint source; empty: none yet
    std::deque<Question> questions_;              ///< the first one is being answered
    /// The question in work is not wanted any more.
    std::shared_ptr<std::atomic<bool>> is_forgotten_ = std::make_shared<std::atomic<bool>>(false);
    SideTask<Answer> answering_;
    std::vector<EventSource> sources_;
    std::optional<RecordedPlayer> player_;  ///< the last member: its events use all others
};

}  // namespace octoskin::view
