// What a recording does where there is no memory for a line of it. A program of its own: any allocation of
// the thread that says so fails.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <nlohmann/json.hpp>

#include "host/apps/daemon/recorder.hpp"
#include "tests/support/allocation_hooks.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace {

thread_local bool is_memory_gone = false;

}  // namespace

static void* allocate(std::size_t bytes) {
    void* const place = is_memory_gone ? nullptr : std::malloc(bytes);
    if (place == nullptr) throw std::bad_alloc();
    return place;
}

static void release(void* place) noexcept {
    std::free(place);
}

namespace octoskin {
namespace {

// The daemon goes on, and whoever replays it is told.
TEST(RecorderWithoutMemory, counts_what_it_could_not_keep_as_lost_and_goes_on) {
    const testing_support::ScratchFolder folder;
    Pipeline pipeline = test::make_pipeline(test::good_scene());
    const RecordedSettings settings{.rig = "name: a\n",
                                    .robot = "<robot/>",
                                    .mapping = "base: robust\n",
                                    .rig_hash = 1,
                                    .joints = 1,
                                    .interface = "can0"};
    Recorder recorder(folder / "recording", {}, settings, pipeline, HostTime{1'000'000'000});
    const wire::CanFrame frame = test::good_scene().bus.frames().front().frame;
    const DepthFrame image = test::flat_frame(40'000.0);  // a line that needs memory
    const auto tell_all = [&] {
        recorder.on_can(frame, WallTime{1});
        recorder.on_reading({{1, 0, 0}, {1}, 0.5, 0.01}, {}, {});
        recorder.on_depth(image, {});
    };
    tell_all();
    is_memory_gone = true;
    tell_all();
    is_memory_gone = false;
    tell_all();
    const auto json = recorder.to_json(HostTime{2'000'000'000});
    EXPECT_EQ(json["can_frames"], 2);
    EXPECT_EQ(json["lost_can"], 1);
    EXPECT_EQ(json["lost_commits"], 2) << "a reading, and the line of the image";
    EXPECT_EQ(json["depth_frames"], 2);
    EXPECT_EQ(json["lost_depth"], 1);
    EXPECT_EQ(json["commits"], 6);
    EXPECT_FALSE(json["is_complete"].get<bool>());
    EXPECT_EQ(json["error"], "");
}

}  // namespace
}  // namespace octoskin
