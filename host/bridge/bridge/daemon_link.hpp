// The bridge's connection to the daemon: watches its map, ranges, joints and status, and connects again when
// the daemon comes back.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/bridge/robot/robot_facts.hpp"
#include "host/io/watch/watched_map.hpp"

namespace octoskin::bridge {

/// Called from the loop.
class DaemonListener {
  public:
    virtual ~DaemonListener() = default;
    /// The daemon's answer to `describe` as it is, before `on_robot`.
    virtual void on_described(const nlohmann::ordered_json&) {}
    /// At each connection and after each reload of the daemon.
    virtual void on_robot(RobotFacts robot) = 0;
    /// The whole map has changed; `map` is valid during the call.
    virtual void on_map(const watch::WatchedMap& map) = 0;
    virtual void on_range(const watch::WatchedRange& range, HostTime captured) = 0;
    virtual void on_joints(const watch::WatchedJoints& joints, HostTime sampled) = 0;
    virtual void on_status(const nlohmann::ordered_json& status) = 0;
    virtual void on_image(const watch::WatchedImage&, HostTime /*captured*/) {}
    virtual void on_urdf(const std::string& /*text*/) {}
    /// The daemon has gone or cannot be reached.
    virtual void on_lost(const std::string& why) = 0;
};

class DaemonLink {
  public:
    /// The words of `watch` for map, ranges, joints and status; with images and the URDF, too.
    static constexpr const char* kUsualFrames = "watch";
    static constexpr const char* kAllFrames = "watch map ranges joints status images robot";

    struct Wishes {
        std::string request = kUsualFrames;
        /// How long the daemon may take to accept a connection, and to answer. The caller does nothing else
        /// meanwhile.
        std::chrono::milliseconds patience{300};
    };

    /// `loop` and `listener` must outlive it.
    DaemonLink(EventLoop& loop, std::filesystem::path socket, DaemonListener& listener, Wishes wishes);
    ~DaemonLink();
    DaemonLink(const DaemonLink&) = delete;
    DaemonLink& operator=(const DaemonLink&) = delete;

    /// Connects if there is no connection. Call it about twice a second. Waits at most twice the patience for
    /// a daemon that hangs, and then not again for 2 s.
    void attend();
    [[nodiscard]] bool is_connected() const noexcept { return descriptor_ >= 0; }
    /// Frames that the daemon left out because this program read too slowly.
    [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
    /// Frames of the rig before a reload that came after the description of the next rig: not handed on.
    [[nodiscard]] std::uint64_t outdated() const noexcept { return outdated_; }

  private:
    void connect();
    [[nodiscard]] Status<std::string> describe();
    void read();
    /// Takes the complete frames of `bytes_`; the error is a sentence.
    [[nodiscard]] Status<std::string> take_frames();
    [[nodiscard]] Status<std::string> take(const watch::FrameHeader& header, std::string_view payload);
    [[nodiscard]] Status<std::string> take_reload(std::string_view payload);
    [[nodiscard]] Status<std::string> take_map(const watch::FrameHeader& header, std::string_view payload);
    [[nodiscard]] Status<std::string> take_range(const watch::FrameHeader& header, std::string_view payload);
    [[nodiscard]] Status<std::string> take_joints(const watch::FrameHeader& header, std::string_view payload);
    [[nodiscard]] Status<std::string> take_image(const watch::FrameHeader& header, std::string_view payload);
    [[nodiscard]] Status<std::string> take_status(std::string_view payload);
    /// True if the frames that come now are of the described rig; else one more is outdated.
    [[nodiscard]] bool is_current();
    void lose(const std::string& why);

    EventLoop& loop_;
    std::filesystem::path socket_;
    DaemonListener& listener_;
    std::string request_;  ///< with its line feed
    std::chrono::milliseconds patience_;
    int descriptor_ = -1;
    EventSource readable_;
    std::string bytes_;
    bool is_greeted_ = false;
    watch::WatchedMap map_;
    std::optional<std::uint64_t> reloads_;  ///< of the rig of the frames that come now
    std::uint64_t described_ = 0;           ///< of the rig that the listener has
    std::uint64_t lost_ = 0;
    std::uint64_t outdated_ = 0;
    std::optional<HostTime> tried_;
    Nanoseconds rest_{0};
};

}  // namespace octoskin::bridge
