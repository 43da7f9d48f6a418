// A daemon that a test looks into: a pipeline that was told a scripted bus and camera, inputs on one end of a
// socketpair, and what else there is to tell, written by hand.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/daemon/status.hpp"
#include "host/io/socketcan/can_socket.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {

/// The good scene as the daemon maps it, with the one node of it that speaks. At kAllWell there is nothing to
/// complain about: joints, readings and depth frames are in the map.
[[nodiscard]] Scene daemon_scene();
inline constexpr double kAllWell = 4.55;

class DaemonViewTest : public testing::Test {
  protected:
    static constexpr Nanoseconds kNs{1};
    static constexpr Nanoseconds kSecond{1'000'000'000};

    /// Up, and silent; only listens, so that nothing is on the bus but what the test puts there.
    explicit DaemonViewTest(const DaemonRequest& request = {});

    /// A pipeline of this scene, and all that comes before `until_s`, which is then the time of bus and
    /// daemon.
    void play(const Scene& scene, double until_s);
    /// A scene like the good one, but for what `change` does to it.
    template <class Change>
    void play_changed(const Change& change, double until_s = kAllWell) {
        Scene scene = daemon_scene();
        change(scene);
        play(scene, until_s);
    }
    /// What more of frames, stamped before `until_s`.
    void play_on(const std::vector<StampedFrame>& frames, double until_s);
    /// The arm swings before a corner, and kGood reports 0.3 m less than the camera shows. `look` after each
    /// of 80 images.
    void let_camera_contradict(const std::function<void()>& look = {});
    void set_now(double now_s) { view_.now = host_at(now_s), view_.bus_now = host_at(now_s); }

    /// Puts a frame on the bus of the inputs, and has it read.
    void say(const wire::CanFrame& frame);
    /// Another host's SYNC, heard on this machine's clock then.
    HostTime say_sync(std::uint8_t sequence);

    /// Others, that take joint states of this machine too; `send_joints` is such a program's one line.
    [[nodiscard]] std::unique_ptr<Inputs> inputs_with_joint_socket();
    void send_joints(const std::string& line) const;

    /// As they are named in the status, by this kind; empty: there is none.
    [[nodiscard]] std::string reported(const std::string& about) const;
    [[nodiscard]] std::vector<std::string> all_reported() const;

    testing_support::ScratchFolder folder_;
    std::string interface_ = "can7";
    RecordedSettings settings_{.rig = "name: a\n",
                               .robot = "<robot/>",
                               .mapping = "base: robust\n",
                               .rig_hash = 1,
                               .joints = 1,
                               .interface = "can7"};
    DaemonRequest request_;
    Scene scene_ = daemon_scene();
    EventLoop loop_;
    RecordRequests recordings_;
    Pipeline beside_ = make_pipeline(scene_);  ///< of the inputs, which no test looks at
    std::optional<socketcan::CanSocket> other_end_;
    DaemonRequest request_with_joints_;
    std::optional<Inputs> inputs_;
    std::optional<Pipeline> pipeline_;
    DaemonView view_;
};

}  // namespace octoskin::test
