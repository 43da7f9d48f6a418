#include "tests/unit/host/apps/daemon/daemon_view_fixture.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/wire/codec.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "tests/unit/host/core/pipeline/corner_scene.hpp"

namespace octoskin::test {

void expect_parts_in_text(const Problem& problem) {
    const std::string text = problem.text();
    EXPECT_FALSE(text.empty()) << name_of(problem.code);
    for (const std::string& part : {problem.on, problem.what, problem.remedy, problem.key})
        EXPECT_NE(text.find(part), std::string::npos) << name_of(problem.code) << ": " << part;
}

Scene daemon_scene() {
    Scene scene = good_scene();
    scene.config.release = Release::once_placed;
    scene.rig.nodes.resize(1);
    return scene;
}

DaemonViewTest::DaemonViewTest(const DaemonRequest& request) : request_(request) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    other_end_.emplace("other", ends[0]);
    request_.can_descriptor = ends[1];
    request_.interface = interface_;
    request_.is_listen_only = true;
    request_.has_camera = false;
    inputs_.emplace(request_, scene_.rig, loop_, beside_, recordings_);
    inputs_->watch(scene_.rig);
    view_.rig = &scene_.rig;
    view_.inputs = &*inputs_;
    view_.interface = &interface_;
    play(scene_, kAllWell);
    view_.started = host_at(0.0);
    CameraRecord camera;
    camera.is_open = true;
    camera.begun = host_at(0.0);
    camera.newest = host_at(4.5);
    view_.cameras = {camera};
}

void DaemonViewTest::play(const Scene& scene, double until_s) {
    scene_ = scene;
    pipeline_.emplace(make_pipeline(scene_));
    view_.pipeline = &*pipeline_;
    view_.used = {};
    play_on(scene_.bus.frames(), until_s);
}

void DaemonViewTest::play_on(const std::vector<StampedFrame>& frames, double until_s) {
    auto depth = scene_.depth.begin();
    for (const StampedFrame& entry : frames) {
        if (entry.stamp >= wall_at(until_s)) break;
        pipeline_->on_can(entry.frame, entry.stamp);
        const HostTime now{entry.stamp.ns - kWallOffsetNs};
        for (; depth != scene_.depth.end() && depth->captured <= now; ++depth) pipeline_->on_depth(*depth);
        view_.used.note(*pipeline_, scene_.rig, now);
    }
    set_now(until_s);
}

void DaemonViewTest::let_camera_contradict(const std::function<void()>& look) {
    Scene scene = daemon_scene();
    scene.depth.clear();  // of a smaller camera
    scene.rig = in_corner(std::move(scene.rig));
    scene.mapping.map.resolution_m = 0.2;  // the cross-check does not use the map
    play(scene, kAllWell);
    MapBuilder& builder = pipeline_->builder();
    builder.clear_motion({});
    CornerLooks looks(builder, scene_.rig, 5.0);
    for (int i = 0; i < 80; ++i) {
        (void)looks.look(0.3);
        if (look) look();
    }
}

void DaemonViewTest::say(const wire::CanFrame& frame) {
    EXPECT_TRUE(other_end_->send(frame).value());
    inputs_->catch_up();
}

HostTime DaemonViewTest::say_sync(std::uint8_t sequence) {
    constexpr int kTries = 20;  // now and then the clocks cannot be read closely enough
    const auto before = inputs_->foreign_sync();
    for (int i = 0; i < kTries && inputs_->foreign_sync() == before; ++i)
        say(wire::encode(wire::Sync{sequence}, wire::kHostId));
    EXPECT_NE(inputs_->foreign_sync(), before);
    return inputs_->foreign_sync().value_or(HostTime{});
}

std::unique_ptr<Inputs> DaemonViewTest::inputs_with_joint_socket() {
    request_with_joints_ = request_;
    request_with_joints_.joint_socket = folder_ / "joints";
    for (HostJointSource& source : scene_.rig.joint_sources) source.is_local = true;
    auto inputs = std::make_unique<Inputs>(request_with_joints_, scene_.rig, loop_, beside_, recordings_);
    EXPECT_TRUE(inputs->take_sockets(scene_.rig));
    return inputs;
}

void DaemonViewTest::send_joints(const std::string& line) const {
    const auto socket = connect_unix_socket(folder_ / "joints", SOCK_DGRAM);
    ASSERT_TRUE(socket) << socket.error().message();
    EXPECT_EQ(::send(*socket, line.data(), line.size(), 0), static_cast<ssize_t>(line.size()));
    ::close(*socket);
}

std::optional<Problem> DaemonViewTest::reported(ProblemCode code, const std::string& on) const {
    const std::vector<Problem> all = all_reported();
    const auto found = std::ranges::find_if(
        all, [&](const Problem& each) { return each.code == code && (on.empty() || each.on == on); });
    return found == all.end() ? std::nullopt : std::optional(*found);
}

std::vector<Problem> DaemonViewTest::all_reported() const {
    std::vector<Problem> all = problems(view_);
    std::ranges::for_each(all, expect_parts_in_text);
    return all;
}

}  // namespace octoskin::test
