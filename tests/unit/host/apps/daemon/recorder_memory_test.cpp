// What a recording does where there is no memory for a line of it. A program of its own: any allocation of
// the thread that says so fails.
#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "host/apps/daemon/boot_clock.hpp"
#include "host/apps/daemon/map_saver.hpp"
#include "host/apps/daemon/query_server.hpp"
#include "host/apps/daemon/recorder.hpp"
#include "host/apps/query/query_request.hpp"
#include "host/core/pipeline/ordered_replay.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/orderlog/order_reader.hpp"
#include "tests/support/allocation_hooks.hpp"
#include "tests/support/evidence.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace {

thread_local bool is_memory_gone = false;
thread_local bool is_spared = false;
std::atomic<bool> is_memory_of_others_gone = false;  ///< of each thread that is not spared
constexpr std::int64_t kNever = -1;
thread_local std::int64_t fails_after = kNever;  ///< allocations that succeed before some fail
thread_local std::int64_t fails_for = 0;         ///< allocations that fail then

/// True if this allocation of the thread is one of those that fail.
bool is_next_to_fail() {
    if (fails_after == kNever) return false;
    if (fails_after > 0) return --fails_after, false;
    return fails_for > 0 && fails_for-- > 0;
}

}  // namespace

static void* allocate(std::size_t bytes) {
    const bool is_refused = is_next_to_fail() || is_memory_gone || (is_memory_of_others_gone && !is_spared);
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
                                    .form = {.joints = {1}},
                                    .cameras = {""},
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

std::string bytes_of(const FusedMap& map) {
    std::string bytes;
    write_ot(map, [&](std::string_view more) {
        bytes += more;
        return true;
    });
    return bytes;
}

/// Readings of a robot that stays, until one ends with a lack of memory; its map has expiry.
void measure(MapBuilder& builder) try {
    for (int second = 1; second <= 8; ++second) {
        const HostTime captured{second * 1'000'000'000LL};
        for (const int ms : {-10, 0, 10}) {
            JointMeasurement joints{.sampled = captured + Nanoseconds{ms * 1'000'000LL}};
            joints.position_rad[0] = test::angle_at(0.0);
            EXPECT_TRUE(builder.add(joints));
        }
        EXPECT_TRUE(builder.integrate({{test::kLeft, test::kGood, 0}, captured, 0.2 + 0.1 * second, 0.01}));
    }
} catch (const std::bad_alloc&) {
}

/// Records readings while `times` allocations fail after the first `allocations`, and replays the recording.
/// Expects that it is incomplete or gives the map. False if none failed.
bool record_and_replay(const test::Scene& scene, std::int64_t allocations, std::int64_t times) {
    const testing_support::ScratchFolder folder;
    Pipeline pipeline = test::make_pipeline(scene);
    const RecordedSettings settings{.rig = "name: a\n",
                                    .robot = "<robot/>",
                                    .mapping = "base: fast\n",
                                    .rig_hash = 1,
                                    .form = {.joints = {1}},
                                    .cameras = {""},
                                    .interface = "can0"};
    Recorder recorder(folder / "recording", {}, settings, pipeline, HostTime{1'000'000'000});
    fails_after = allocations;
    fails_for = times;
    measure(pipeline.builder());
    fails_after = kNever;
    const std::string live = bytes_of(pipeline.map());
    recorder.stop(HostTime{2'000'000'000});
    EXPECT_TRUE(recorder.wait(Nanoseconds{10'000'000'000}));
    EXPECT_EQ(recorder.error(), "");
    auto order = orderlog::OrderReader::open(RecordingPaths(folder / "recording").order());
    EXPECT_TRUE(order);
    Pipeline again = test::make_pipeline(scene);
    const OrderedOutcome outcome = replay_in_order(again.builder(), *order, {});
    EXPECT_FALSE(outcome.order_error) << outcome.order_error->message();
    EXPECT_EQ(order->trailer()->is_complete(), recorder.is_complete());
    if (recorder.is_complete()) {
        EXPECT_EQ(bytes_of(again.map()), live) << times << " from allocation " << allocations;
    }
    return fails_for < times;
}

TEST(RecorderWithoutMemory, is_complete_only_if_its_replay_gives_the_map) {
    test::Scene scene = test::good_scene();
    scene.mapping = fast_mapping();
    scene.mapping.map.age = {.stale_after_s = 1, .unknown_after_s = 3};
    for (const std::int64_t times : {1, 20}) {
        std::int64_t allocations = 0;
        const std::int64_t step = times == 1 ? 4 : 16;
        while (record_and_replay(scene, allocations, times)) allocations += step;
        EXPECT_GT(allocations, 100);
    }
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
    EXPECT_EQ(refused["exit"], static_cast<int>(ExitCode::unavailable));
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
