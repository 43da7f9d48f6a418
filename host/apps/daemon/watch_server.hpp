// Serves the clients of `watch` in its own thread: no reading waits for them.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/apps/daemon/wake_event.hpp"
#include "host/apps/daemon/watcher.hpp"
#include "host/core/pipeline/measurement_observer.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/io/watch/image_pace.hpp"

namespace octoskin {

class WatchServer final : public MeasurementObserver {
  public:
    static constexpr std::size_t kWatchersMax = 8;
    /// A watcher that takes nothing for this long, although something waits for it, is dropped.
    static constexpr Nanoseconds kStalledMax{30'000'000'000};
    /// Events that wait for the thread; beyond this the newest are lost for all, but for lasting ones.
    static constexpr std::size_t kEventsMax = 8192;

    /// Throws std::system_error if there is no thread or descriptor left.
    explicit WatchServer(const HostRig& rig, Nanoseconds stalled_max = kStalledMax);
    ~WatchServer() override;
    WatchServer(const WatchServer&) = delete;
    WatchServer& operator=(const WatchServer&) = delete;

    /// "watch", which is "watch map ranges joints status", or some of these words, `images` and `robot`.
    [[nodiscard]] static bool is_request(const std::string& line);
    /// Empty: another word.
    [[nodiscard]] static std::optional<WatchWants> parse(const std::string& line);

    /// Closes all connections and takes no new ones, which frees their memory for the last save. Does not
    /// wait for a watcher.
    void end();
    /// Takes over a client's connection, which it closes. False: there are too many watchers, or it has
    /// ended, and the connection is the caller's.
    [[nodiscard]] bool take(int connection, const WatchWants& wants);
    /// True if one of them wants this kind. For the caller, to make nothing in vain.
    [[nodiscard]] bool wants(watch::FrameKind kind) const noexcept;

    /// The map as it is now, with its time on the bus; 0: not known.
    void give_map(FusedMap copy, HostTime time);
    void give_status(std::string json);
    /// The robot's URDF, or another one: late watchers get the newest. One that is too large for a frame is
    /// given as an empty text.
    void give_robot(const std::string& urdf);
    void on_sample(const JointMeasurement& joints) noexcept override;
    void on_beam(const Beam& beam) noexcept override;
    /// Of each camera one image in watch::ImagePace::kPeriod goes to the watchers, reduced.
    void on_image(const DepthFrame& frame) noexcept override;
    /// Another rig. Each watcher gets a frame that says so, after all that was given before and ahead of all
    /// that is given later. `reloads`: since the daemon's start.
    void change_rig(const HostRig& rig, std::uint64_t reloads);

    struct Record {
        std::size_t watchers = 0;
        std::uint64_t stalled = 0;  ///< dropped because they read nothing
        std::uint64_t lost = 0;     ///< events that did not reach the thread
    };
    [[nodiscard]] Record record() const;

  private:
    struct Client;
    /// What the loop's thread has given, under the mutex.
    struct Given {
        std::optional<MapNow> map;
        std::vector<WatchEvent> events;
        std::vector<std::unique_ptr<Client>> clients;
        std::uint64_t reloads = 0;  ///< so far; `map` is of their newest rig
    };
    void give(watch::FrameKind kind, HostTime time, std::string payload);
    void put(WatchEvent event);
    void run();
    [[nodiscard]] Given taken();
    void spread(Given given);
    void spread(const WatchEvent& event);
    void spread(MapNow map);
    void welcome(std::unique_ptr<Client> client, std::uint64_t reloads);
    void wait_for_work();
    void serve();
    [[nodiscard]] bool serve(Client& client, HostTime now);
    void count_watchers();

    Nanoseconds stalled_max_;
    std::vector<std::size_t> joint_counts_;
    watch::ImagePace images_;
    WakeEvent wake_;
    mutable std::mutex mutex_;
    Given given_;
    std::atomic<std::size_t> watchers_ = 0;
    std::atomic<std::uint64_t> stalled_ = 0;
    std::atomic<std::uint64_t> lost_ = 0;
    std::atomic<std::uint8_t> wanted_ = 0;  ///< a bit for each kind
    std::atomic<bool> is_ending_ = false;
    // Of the thread.
    std::optional<MapNow> map_;
    std::optional<WatchEvent> robot_;
    bool is_map_old_ = false;  ///< of the rig before a reload
    std::vector<std::unique_ptr<Client>> clients_;
    std::thread thread_;  ///< the last member: it uses all others
};

}  // namespace octoskin
