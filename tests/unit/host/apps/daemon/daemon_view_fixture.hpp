// A daemon that a test looks into: a pipeline that was told a scripted bus and camera, inputs on one end of a
// socketpair, and what else there is to tell, written by hand.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "host/apps/daemon/status.hpp"
#include "host/io/socketcan/can_socket.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin {

inline void PrintTo(ProblemCode code, std::ostream* out) {
    *out << name_of(code);
}
inline void PrintTo(const Problem& problem, std::ostream* out) {
    *out << name_of(problem.code) << " (" << problem.detail << "): " << problem.text();
}

}  // namespace octoskin

namespace octoskin::test {

[[nodiscard]] inline auto on_is(const std::string& on) {
    return testing::Field("on", &Problem::on, on);
}
[[nodiscard]] inline auto what_has(const std::string& part) {
    return testing::Field("what", &Problem::what, testing::HasSubstr(part));
}
[[nodiscard]] inline auto remedy_has(const std::string& part) {
    return testing::Field("remedy", &Problem::remedy, testing::HasSubstr(part));
}
[[nodiscard]] inline auto key_is(const std::string& key) {
    return testing::Field("key", &Problem::key, key);
}
[[nodiscard]] inline auto detail_is(const std::string& detail) {
    return testing::Field("detail", &Problem::detail, detail);
}
/// `part` of what is wrong.
[[nodiscard]] inline auto is_problem(ProblemCode code, const std::string& on, const std::string& part) {
    return testing::AllOf(testing::Field("code", &Problem::code, code), on_is(on), what_has(part));
}
/// The sentence states the node, then its condition.
[[nodiscard]] inline auto is_unusable_node(const std::string& sentence) {
    return testing::AllOf(testing::Field("code", &Problem::code, ProblemCode::node_unusable),
                          testing::Property("text", &Problem::text, sentence));
}

/// Expects that the sentence contains the parts that a program reads: on, what, remedy and key.
void expect_parts_in_text(const Problem& problem);

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

    /// The first problem of this code, on this part if one is given; empty if there is none.
    [[nodiscard]] std::optional<Problem> reported(ProblemCode code, const std::string& on = {}) const;
    /// In the order of the status. The sentence of each is checked.
    [[nodiscard]] std::vector<Problem> all_reported() const;

    testing_support::ScratchFolder folder_;
    std::string interface_ = "can7";
    RecordedSettings settings_{.rig = "name: a\n",
                               .robot = "<robot/>",
                               .mapping = "base: robust\n",
                               .rig_hash = 1,
                               .form = {.joints = {1}},
                               .cameras = {""},
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
