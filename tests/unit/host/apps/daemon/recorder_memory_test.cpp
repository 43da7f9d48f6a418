// What a recording does where there is no memory for a line of it. A program of its own: any allocation of
// the thread that says so fails.
#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <nlohmann/json.hpp>

#include "host/apps/daemon/boot_clock.hpp"
#include "host/apps/daemon/map_saver.hpp"
#include "host/apps/daemon/query_server.hpp"
#include "host/apps/daemon/recorder.hpp"
#include "host/apps/query/query_request.hpp"
#include "tests/support/allocation_hooks.hpp"
#include "tests/support/evidence.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace {

thread_local bool is_memory_gone = false;
thread_local bool is_spared = false;
std::atomic<bool> is_memory_of_others_gone = false;  ///< of each thread that is not spared

}  // namespace

static void* allocate(std::size_t bytes) {
    const bool is_refused = is_memory_gone || (is_memory_of_others_gone && !is_spared);
    void* const place = is_refused ? nullptr : std::malloc(bytes);
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

// A restart behind it adds what this one could not.
TEST(MapTimeWithoutMemory, is_that_of_before_where_the_map_cannot_grow_older) {
    constexpr std::int64_t kLong_s = 20'000;  // more than the clock has room for: all stamps change
    const BootTime saved{{1}, Nanoseconds{1'000'000'000}};
    const BootTime now{{1}, Nanoseconds{(kLong_s + 1) * 1'000'000'000}};
    FusedMap map(MapConfig{.age = {.stale_after_s = 10, .unknown_after_s = 0}});
    map.advance_time(HostTime{5'000'000'000});
    feed(map, std::vector<VoxelUpdate>{{{32768, 32768, 32768}, 1.0F}});
    const FusedMap shares = map.copy();
    MapTime time([now] { return std::optional(now); });
    is_memory_gone = true;
    (void)time.begin_with(map, saved);
    const bool is_older = map.wait(kLong_s);
    is_memory_gone = false;
    EXPECT_FALSE(is_older);
    EXPECT_EQ(time.map_time(), saved);
    EXPECT_EQ(map.confirmation({32768, 32768, 32768})->age_s, 0U);
    EXPECT_TRUE(map.wait(kLong_s));
    EXPECT_EQ(map.confirmation({32768, 32768, 32768})->age_s, VoxelAges::kAgeMax_s);
}

// A reload comes to it when there is no way back any more.
TEST(MapTimeWithoutMemory, is_forgotten_though_a_copy_of_the_map_has_it_too) {
    FusedMap map(MapConfig{.age = {.stale_after_s = 10, .unknown_after_s = 0}});
    map.advance_time(HostTime{5'000'000'000});
    feed(map, std::vector<VoxelUpdate>{{{32768, 32768, 32768}, 1.0F}});
    const FusedMap shares = map.copy();
    is_memory_gone = true;
    map.clear_times();
    is_memory_gone = false;
    map.advance_time(HostTime{6'000'000'000});
    EXPECT_FALSE(map.confirmation({32768, 32768, 32768}));
    EXPECT_TRUE(map.is_stale({32768, 32768, 32768}));
    EXPECT_TRUE(shares.confirmation({32768, 32768, 32768}));
}

TEST(QueryServerWithoutMemory, answers_and_goes_on) {
    is_spared = true;
    const test::Scene scene = test::good_scene();
    Pipeline pipeline = test::make_pipeline(scene);
    const HostSetup setup{scene.rig, test::one_joint_robot(), {}};
    QueryServer desk(setup);
    const auto ask = [&](std::uint64_t ticket) {
        QueryRequest request;
        request.path = {{0.0}};
        EXPECT_TRUE(desk.take(to_line(request), ticket, 0));
        std::string line;
        for (int i = 0; i < 2 && line.empty(); ++i) {  // its map, and its answer
            pollfd readable{desk.descriptor(), POLLIN, 0};
            EXPECT_EQ(::poll(&readable, 1, 20'000), 1);
            for (const auto& answer : desk.serve(pipeline, {HostTime{1}, HostTime{1}, WallTime{1}})) {
                EXPECT_EQ(answer.ticket, ticket);
                line = answer.line;
            }
        }
        return nlohmann::json::parse(line);
    };
    is_memory_of_others_gone = true;
    const auto refused = ask(1);
    EXPECT_FALSE(refused["ok"].get<bool>());
    EXPECT_EQ(refused["code"], static_cast<int>(ExitCode::unavailable));
    is_memory_of_others_gone = false;
    EXPECT_TRUE(ask(2)["ok"].get<bool>());
}

// The next one may find some.
TEST(MapSaverWithoutMemory, counts_a_save_as_failed_and_goes_on) {
    is_spared = true;
    const testing_support::ScratchFolder folder;
    MapSaver saver{NamedFolder(folder.path())};
    const FusedMap map{MapConfig{}};
    is_memory_of_others_gone = true;
    EXPECT_TRUE(saver.save(map));
    EXPECT_TRUE(saver.finish(Nanoseconds{10'000'000'000}));
    EXPECT_EQ(saver.record().failed, 1U);
    is_memory_of_others_gone = false;
    EXPECT_TRUE(saver.save(map));
    EXPECT_TRUE(saver.finish(Nanoseconds{10'000'000'000}));
    EXPECT_EQ(saver.record().saved, 1U) << saver.record().error;
}

}  // namespace
}  // namespace octoskin
