#include "host/bridge/view/recorded_player.hpp"

#include <utility>

#include "host/apps/daemon/quiet_thread.hpp"
#include "host/io/watch/image_pace.hpp"

namespace octoskin::view {

/// Passes the calls of the playback on to the loop.
class RecordedPlayer::Relay final : public bridge::DaemonListener, public bridge::RecordedDetails {
  public:
    explicit Relay(RecordedPlayer& player) : player_(player) {}

    void on_described(const nlohmann::ordered_json& described) override {
        post([described](PlayerListener& to) { to.on_described(described); });
    }
    void on_robot(bridge::RobotFacts robot) override {
        post([robot = std::move(robot)](PlayerListener& to) { to.on_robot(robot); });
    }
    void on_map(const watch::WatchedMap& map) override {
        post([map](PlayerListener& to) { to.on_map(map); });
    }
    void on_range(const watch::WatchedRange& range, HostTime captured) override {
        if (!player_.is_passing())
            post([range, captured](PlayerListener& to) { to.on_range(range, captured); });
    }
    void on_joints(const watch::WatchedJoints& joints, HostTime sampled) override {
        post([joints, sampled](PlayerListener& to) { to.on_joints(joints, sampled); });
    }
    void on_status(const nlohmann::ordered_json& status) override {
        post([status](PlayerListener& to) { to.on_status(status); });
    }
    void on_lost(const std::string& why) override {
        post([why](PlayerListener& to) { to.on_lost(why); });
    }
    void on_time(HostTime bus, WallTime) override { player_.wait_for(bus); }
    void on_depth(const DepthFrame& frame) override {
        if (player_.is_passing() || !images_.takes(frame.camera, frame.captured)) return;
        if (auto image = watch::parse_image(watch::image_payload(frame)))
            post([image = std::move(*image), captured = frame.captured](PlayerListener& to) {
                to.on_image(image, captured);
            });
    }

  private:
    template <class Event>
    void post(Event event) {
        player_.post(
            [event = std::move(event), this_listener = &player_.listener_] { event(*this_listener); });
    }

    RecordedPlayer& player_;
    watch::ImagePace images_;
};

RecordedPlayer::RecordedPlayer(EventLoop& loop, bridge::RecordedEvents events, PlayerListener& listener)
    : events_(std::move(events)),
      listener_(listener),
      readable_(loop.on_readable(wake_.descriptor(), [this] { take_events(); })),
      thread_(start_without_signals([this] { work(); })) {}

RecordedPlayer::~RecordedPlayer() {
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void RecordedPlayer::play(std::optional<HostTime> at, double speed) {
    {
        const std::lock_guard lock(mutex_);
        speed_ = speed;
        base_.reset();
        if (at) {
            passing_until_ = at;
            is_restarting_ = is_restarting_ || !now_ || *at < *now_;
            if (is_restarting_) waiting_.clear();
        }
    }
    changed_.notify_all();
}

std::optional<HostTime> RecordedPlayer::now() const {
    const std::lock_guard lock(mutex_);
    return now_;
}

double RecordedPlayer::speed() const {
    const std::lock_guard lock(mutex_);
    return speed_;
}

bool RecordedPlayer::is_passing() const {
    const std::lock_guard lock(mutex_);
    return passing_until_.has_value();
}

/// Called with the lock.
void RecordedPlayer::throw_if_interrupted() const {
    if (is_ending_ || is_restarting_) throw Interrupted{};
}

void RecordedPlayer::wait_for(HostTime time) {
    std::unique_lock lock(mutex_);
    while (true) {  // until it is due
        throw_if_interrupted();
        now_ = time;
        if (passing_until_ && time < *passing_until_) return;
        passing_until_.reset();
        if (speed_ <= 0.0) {
            changed_.wait(lock);
            continue;
        }
        if (!base_) base_ = {Clock::now(), time};
        const std::chrono::duration<double, std::nano> since(
            static_cast<double>((time - base_->time).count()) / speed_);
        const auto due = base_->played + std::chrono::duration_cast<Clock::duration>(since);
        if (Clock::now() >= due) return;
        changed_.wait_until(lock, due);
    }
}

void RecordedPlayer::post(std::function<void()> event) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_.size() < kWaitingMax || is_ending_ || is_restarting_; });
    throw_if_interrupted();
    waiting_.push_back(std::move(event));
    wake_.wake();
}

void RecordedPlayer::take_events() {
    std::deque<std::function<void()>> events;
    {
        const std::lock_guard lock(mutex_);
        events.swap(waiting_);
        wake_.clear();
        if (thrown_) std::rethrow_exception(thrown_);
    }
    changed_.notify_all();
    for (const auto& event : events) event();
}

std::optional<AppError> RecordedPlayer::play_once() {
    Relay relay(*this);
    const auto played = events_.play(relay, &relay);
    return played ? std::nullopt : std::optional(played.error());
}

void RecordedPlayer::work() {
    yield_to_the_loop();
    while (true) {  // until the view ends
        {
            const std::lock_guard lock(mutex_);
            if (is_ending_) return;
            is_restarting_ = false;
            base_.reset();
            now_.reset();
        }
        try {
            const auto error = play_once();
            post([error, this] { listener_.on_end(error); });
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [this] { return is_ending_ || is_restarting_; });
        } catch (const Interrupted&) {
            continue;
        } catch (...) {  // no memory: the loop ends the program, which says so
            const std::lock_guard lock(mutex_);
            thrown_ = std::current_exception();
            wake_.wake();
            return;
        }
    }
}

}  // namespace octoskin::view
