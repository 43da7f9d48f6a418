// Recording a daemon's map changes nothing of it: two of them on the same frames, one of which is recorded.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "common/wire/crc.hpp"
#include "host/apps/daemon/record_requests.hpp"
#include "host/apps/daemon/settings.hpp"
#include "host/apps/query/query_answer.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/snapshot/snapshot_file.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"
#include "tests/system/said.hpp"

namespace octoskin::test {
namespace {

using testing_support::ScratchFolder;

constexpr const char* kCones = OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment_cone.yaml";

/// What a daemon does with frames, without its sockets and clocks.
class DaemonOnFrames {
  public:
    explicit DaemonOnFrames(const std::string& configuration)
        : settings_(read_settings(request(configuration)).value()),
          pipeline_(make_pipeline(request(configuration), settings_).value()) {}

    void on_can(const StampedFrame& entry) {
        requests_.on_can(entry.frame, entry.stamp);
        pipeline_.on_can(entry.frame, entry.stamp);
    }
    void on_depth(const DepthFrame& frame) { pipeline_.on_depth(frame); }
    nlohmann::json record(const std::string& arguments, HostTime now) {
        return nlohmann::json::parse(
            requests_.answer("record " + arguments, settings_.recorded, pipeline_, now));
    }
    void finish() { requests_.finish(Nanoseconds{20'000'000'000}); }

    [[nodiscard]] std::optional<HostTime> now() const { return pipeline_.now(); }
    [[nodiscard]] const FusedMap& map() const { return pipeline_.map(); }
    [[nodiscard]] bool has_readings() const {
        return std::ranges::any_of(pipeline_.builder().histories(), [](const auto& sensor) {
            return sensor.second.readings > 0 && !sensor.second.zones.begin()->second.passages.empty();
        });
    }
    [[nodiscard]] std::vector<CameraMemory> camera_memories() const {
        return pipeline_.builder().camera_memories();
    }
    [[nodiscard]] std::string state() const { return encode_snapshot(pipeline_.builder().state(), {}); }
    /// What a recording began with, as `state` has it.
    [[nodiscard]] std::string state_in(const std::string& file) const {
        const std::string& text = settings_.recorded.mapping;
        const auto mapping_crc32 = crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
        const auto snapshot = load_snapshot(file, settings_.mapping, mapping_crc32);
        EXPECT_TRUE(snapshot) << snapshot.error().message();
        return snapshot ? encode_snapshot(snapshot->state, {}) : std::string();
    }
    /// To a posture, and to the way there from another one.
    [[nodiscard]] std::vector<std::string> answers() const {
        const std::vector<double> upright{0.0, 0.0, 0.0, -0.1, 0.0, 1.6, 0.0};
        const std::vector<double> aside{0.8, 0.3, 0.0, -1.6, 0.0, 1.9, 0.0};
        std::vector<std::string> answers;
        using Path = std::vector<std::vector<double>>;
        for (const Path& path : {Path{upright}, Path{upright, aside}}) {
            QueryRequest asked;
            asked.path = path;
            FusedMap map = pipeline_.map().copy();
            map.advance_time(*now());
            QueryGround ground{
                &settings_.host.rig, &settings_.host.robot, std::move(map), upright, nullptr, true};
            auto answer = answer_query(asked, std::move(ground));
            answer.erase("took_us");
            answers.push_back(answer.dump());
        }
        return answers;
    }

  private:
    static DaemonRequest request(const std::string& configuration) {
        DaemonRequest request;
        request.rig = kCones;
        request.configuration = configuration;
        return request;
    }

    Settings settings_;
    Pipeline pipeline_;
    RecordRequests requests_;
};

/// What the camera sees in a part of its image: a wall that jumps.
struct Wall {
    int images = 4;         ///< from one jump to the next
    unsigned columns = 40;  ///< of the image that it fills
    double sigma_m = 0.0;   ///< of the camera; 0: each pixel varies by up to 6 cm, always in the same way
};

DepthFrame image_at(HostTime captured, int number, const Wall& wall) {
    std::mt19937 random(static_cast<unsigned>(number));
    std::normal_distribution<double> noise;
    const auto varied_mm = [&](std::size_t pixel) {
        return wall.sigma_m > 0.0
                   ? std::lround(1000.0 * wall.sigma_m * noise(random))
                   : static_cast<long>((pixel * 7 + static_cast<std::size_t>(number) * 23) % 61);
    };
    DepthFrame frame;
    frame.width = 512;
    frame.height = 424;
    frame.captured = captured;
    frame.depth_mm.assign(frame.width * frame.height, 0);
    const long wall_mm = number / wall.images % 2 == 0 ? 3'000 : 2'500;
    for (std::size_t i = 0; i < frame.depth_mm.size(); ++i)
        if (i % frame.width < wall.columns)
            frame.depth_mm[i] = static_cast<std::uint16_t>(wall_mm + varied_mm(i));
    return frame;
}

struct Look {
    const char* name;
    const char* mapping;
    std::int64_t begin_s;  ///< of the recording
    Wall wall = {};
};

/// Pixels that are the mean of several images and end in another voxel than before.
std::size_t moved_means(const CameraMemory& before, const CameraMemory& now) {
    std::size_t moved = 0;
    for (std::size_t i = 0; i < now.pixels.size(); ++i) {
        const EndMemory::End& was = before.pixels[i].end;
        const EndMemory::End& is = now.pixels[i].end;
        const bool is_elsewhere = was.key_xy != is.key_xy || was.key_z != is.key_z;
        const bool has_ends = was != EndMemory::End{} && is != EndMemory::End{};
        moved += now.pixels[i].depth.count > 1.0F && has_ends && is_elsewhere ? 1U : 0U;
    }
    return moved;
}

class Looking : public testing::TestWithParam<Look> {
  protected:
    static const std::vector<StampedFrame>& log() {
        static const std::vector<StampedFrame> log = make_log(rig::read_rig(kCones).value());
        return log;
    }
    ScratchFolder folder_;
};

TEST_P(Looking, changes_nothing_and_the_replay_gives_the_same_bytes) {
    const std::string configuration = folder_.write("mapping.yaml", GetParam().mapping).string();
    DaemonOnFrames recorded(configuration);
    DaemonOnFrames alone(configuration);
    const std::string out = (folder_ / "recording").string();
    const std::string taken = (folder_ / "taken").string();
    std::filesystem::create_directory(taken);
    (void)folder_.write("taken/file", "");
    std::int64_t first_ns = 0;
    std::int64_t second = 0;
    int images = 0;
    int compared = 0;
    bool had_counts = false;
    std::string first_state;
    std::vector<CameraMemory> second_before;
    std::size_t moved = 0;
    for (const StampedFrame& entry : log()) {
        for (DaemonOnFrames* daemon : {&recorded, &alone}) daemon->on_can(entry);
        const auto now = alone.now();
        if (!now) continue;
        if (first_ns == 0) first_ns = now->ns;
        const std::int64_t passed_ns = now->ns - first_ns;
        if (passed_ns / 250'000'000 > images) {
            ++images;
            for (DaemonOnFrames* daemon : {&recorded, &alone})
                daemon->on_depth(image_at(*now, images, GetParam().wall));
        }
        if (passed_ns / 1'000'000'000 == second) continue;
        second = passed_ns / 1'000'000'000;
        if (second == GetParam().begin_s - 1) {
            EXPECT_FALSE(recorded.record("start 0 " + taken, *now)["ok"].get<bool>());
        }
        if (second == GetParam().begin_s) {
            first_state = recorded.state();
            if (!second_before.empty())
                moved = moved_means(second_before.at(0), recorded.camera_memories().at(0));
            had_counts = !recorded.map().layers().counts.empty() && recorded.has_readings();
            const auto answer = recorded.record("start 0 " + out, *now);
            ASSERT_TRUE(answer["ok"].get<bool>()) << answer;
        }
        second_before = recorded.camera_memories();
        ++compared;
        EXPECT_TRUE(recorded.state() == alone.state()) << "in second " << second;
        EXPECT_TRUE(encode_ot(recorded.map()) == encode_ot(alone.map())) << "in second " << second;
        EXPECT_EQ(recorded.answers(), alone.answers()) << "in second " << second;
    }
    EXPECT_GE(compared, 9);
    EXPECT_TRUE(had_counts);
    EXPECT_TRUE(GetParam().wall.sigma_m == 0.0 || moved > 1'000) << moved;
    EXPECT_TRUE(recorded.record("stop", *alone.now())["ok"].get<bool>());
    recorded.finish();
    EXPECT_TRUE(recorded.state_in(out + "/first.snapshot") == first_state);
    for (const char* maps : {" --fused-only", ""}) {
        const Said replay = octoskin("replay " + out + maps);
        EXPECT_EQ(replay.exit_code, 0) << replay.output;
        EXPECT_NE(replay.output.find("identical to the daemon's, byte for byte"), std::string::npos)
            << replay.output;
        EXPECT_TRUE(ScratchFolder::read(out + "/maps/fused.ot") == encode_ot(alone.map())) << maps;
    }
}

constexpr Wall kNoisyWall{.images = 16, .columns = 160, .sigma_m = 0.03};

// With ages, the map forgets within the log what no sensor confirms. With noise, the recording begins while
// the camera's means still move, and the voxels that they leave are retracted.
constexpr const char* kAging = "base: fast\nage: {stale_after_s: 2, unknown_after_s: 4}\n";
INSTANTIATE_TEST_SUITE_P(Mappings, Looking,
                         testing::Values(Look{"fast_3_s", "base: fast\n", 3},
                                         Look{"denoised_3_s", "base: denoised\n", 3},
                                         Look{"denoised_6_s", "base: denoised\n", 6},
                                         Look{"denoised_noise_3_s", "base: denoised\n", 3, kNoisyWall},
                                         Look{"denoised_noise_6_s", "base: denoised\n", 6, kNoisyWall},
                                         Look{"fast_aging_3_s", kAging, 3},
                                         Look{"fast_aging_6_s", kAging, 6}),
                         [](const auto& look) { return look.param.name; });

}  // namespace
}  // namespace octoskin::test
