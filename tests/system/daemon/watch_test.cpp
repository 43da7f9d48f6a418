// A client that watches a daemon on a bus that is alive.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/daemon/unix_socket.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/watch/watched_map.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

/// Reads frames, as soon as it is asked to.
class WatchClient {
  public:
    WatchClient(const std::filesystem::path& socket, const std::string& request)
        : socket_(connect_unix_socket(socket, SOCK_STREAM).value()) {
        const timeval patience{.tv_sec = 10, .tv_usec = 0};
        ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
        EXPECT_EQ(::send(socket_, request.data(), request.size(), MSG_NOSIGNAL),
                  static_cast<ssize_t>(request.size()));
        for (char next = 0; ::recv(socket_, &next, 1, 0) == 1 && next != '\n';) greeting += next;
    }
    ~WatchClient() { ::close(socket_); }
    WatchClient(const WatchClient&) = delete;
    WatchClient& operator=(const WatchClient&) = delete;

    /// False at the end of the connection, or if nothing comes for 10 s.
    bool read() {
        const std::string header_bytes = receive(watch::kHeaderBytes);
        const auto parsed = watch::parse_header(header_bytes);
        if (!parsed) return false;
        header = *parsed;
        payload = receive(header.bytes);
        EXPECT_EQ(header.number, frames++);
        ++of_kind[header.kind];
        if (header.kind == watch::FrameKind::map) {
            EXPECT_EQ(map.take(header, payload), watch::WatchedMap::Taken::all);
        }
        if (header.kind == watch::FrameKind::range) {
            const auto parsed_range = watch::parse_range(payload);
            EXPECT_TRUE(parsed_range);
            range = parsed_range.value_or(watch::WatchedRange{});
        }
        if (header.kind == watch::FrameKind::reload) {
            reloads = watch::parse_reload(payload);
            EXPECT_TRUE(reloads);
        }
        if (header.kind == watch::FrameKind::joints) {
            EXPECT_EQ(watch::parse_joints(payload).value().position.size(), 7U);
        }
        return payload.size() == header.bytes;
    }
    void read_for(std::chrono::milliseconds duration) {
        const auto end = std::chrono::steady_clock::now() + duration;
        while (std::chrono::steady_clock::now() < end && read()) continue;
    }

    std::string greeting;
    watch::FrameHeader header;
    std::string payload;
    std::uint64_t frames = 0;
    std::map<watch::FrameKind, int> of_kind;
    watch::WatchedMap map;
    watch::WatchedRange range;             ///< the newest
    std::optional<std::uint64_t> reloads;  ///< of the newest reload

  private:
    std::string receive(std::size_t bytes) const {
        std::string all(bytes, '\0');
        std::size_t got = 0;
        while (got < bytes) {
            const ssize_t now = ::recv(socket_, all.data() + got, bytes - got, 0);
            if (now <= 0) break;
            got += static_cast<std::size_t>(now);
        }
        all.resize(got);
        return all;
    }
    int socket_;
};

class WatchTest : public DaemonTest {
  protected:
    void start_ranging() {
        start({"--no-camera"});
        ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return is_ranging(now); }, 20s))
            << daemon_->log();
    }
    std::filesystem::path control() const { return folder_ / "control"; }
};

TEST_F(WatchTest, gets_ranges_joints_status_and_the_map_that_the_daemon_saves) {
    start_ranging();
    WatchClient client(control(), "watch\n");
    EXPECT_EQ(client.greeting, R"({"ok":true,"watch":1})");
    client.read_for(3s);
    EXPECT_GT(client.of_kind[watch::FrameKind::map], 10);
    EXPECT_GT(client.of_kind[watch::FrameKind::range], 100);
    EXPECT_GT(client.of_kind[watch::FrameKind::joints], 100);
    EXPECT_GE(client.of_kind[watch::FrameKind::status], 3);
    EXPECT_TRUE(client.map.is_whole());
    for (const wire::NodeId node : std::array<wire::NodeId, 3>{1, 2, 3}) bus_->silence(node, true);
    client.read_for(1s);  // from now on nothing changes but ages
    while (!client.map.is_complete() && client.read()) continue;
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(10s), 0) << daemon_->log();
    const auto loaded = load_map(folder_ / "maps" / "fused.ot");
    ASSERT_TRUE(loaded) << loaded.error().message();
    const FusedMap* const saved = &loaded->map;
    std::size_t same = 0;
    saved->for_each_known(
        [&](VoxelKey key, float) { same += client.map.occupancy(key) == saved->occupancy(key) ? 1U : 0U; });
    EXPECT_EQ(same, saved->known_voxels());
    EXPECT_GT(same, 1'000U);
}

TEST_F(WatchTest, gets_only_what_it_asks_for) {
    start_ranging();
    WatchClient client(control(), "watch joints\n");
    client.read_for(500ms);
    EXPECT_GT(client.of_kind[watch::FrameKind::joints], 10);
    EXPECT_EQ(client.of_kind.size(), 2U);
    EXPECT_EQ(client.of_kind[watch::FrameKind::reload], 1);
    EXPECT_EQ(client.reloads, 0U);
    WatchClient unknown(control(), "watch everything\n");
    EXPECT_NE(unknown.greeting.find("map, ranges, joints, status"), std::string::npos) << unknown.greeting;
}

/// The experiment with its base so many metres above the map's origin.
std::string rig_at(double height_m) {
    return fmt::format("extends: {}\nname: high\nT_map_base: {{xyz_m: [0, 0, {}], rpy_deg: [0, 0, 0]}}\n",
                       kExperiment, height_m);
}

/// Of the highest brick in which something is known; 0: of the map's origin.
double top_m(const watch::WatchedMap& map) {
    constexpr int kOrigin = 32'768;
    int top = 0;
    map.log_odds().for_each([&](MortonCode brick, const BrickView&) {
        top = std::max(top, int{key_of_morton(brick).z} - kOrigin);
    });
    return top * map.resolution_m();
}

// With each reload the base is 20 m higher, so that a range and a voxel show the rig that they are of.
TEST_F(WatchTest, sees_nothing_of_another_rig_before_its_reload_and_no_range_of_the_one_before_after_it) {
    constexpr double kStep_m = 20.0;
    constexpr double kReach_m = 8.0;  // of the arm and its ranges
    constexpr std::uint64_t kReloads = 3;
    const auto rig_file = folder_.write("rig.yaml", rig_at(0));
    start({"--no-camera"}, rig_file, make_log(rig::read_rig(rig_file).value(), 3));
    ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return is_ranging(now); }, 20s)) << daemon_->log();
    WatchClient client(control(), "watch map ranges\n");
    WatchClient idle(control(), "watch joints\n");  // reads nothing until the end
    ASSERT_TRUE(client.read());
    EXPECT_EQ(client.reloads, 0U);
    for (std::uint64_t reload = 0; reload <= kReloads; ++reload) {
        if (reload > 0) {
            folder_.write("rig.yaml", rig_at(kStep_m * static_cast<double>(reload)));
            daemon_->signal(SIGHUP);
        }
        int ranges = 0;
        bool is_seen = false;
        const auto end = std::chrono::steady_clock::now() + 15s;
        while ((ranges < 200 || !is_seen) && std::chrono::steady_clock::now() < end && client.read()) {
            const double base_m = kStep_m * static_cast<double>(client.reloads.value());
            if (client.header.kind == watch::FrameKind::range) {
                ASSERT_NEAR(client.range.p_map_sensor.z(), base_m, kReach_m);
                ranges += *client.reloads == reload ? 1 : 0;
            }
            if (client.header.kind == watch::FrameKind::map) {
                ASSERT_LT(top_m(client.map), base_m + kReach_m);
                is_seen = client.map.is_complete() && top_m(client.map) > base_m - kReach_m;
            }
        }
        ASSERT_EQ(client.reloads, reload) << daemon_->log();
        EXPECT_GE(ranges, 200) << reload;
        EXPECT_TRUE(is_seen) << reload;
    }
    while (idle.reloads != kReloads && idle.read()) continue;
    EXPECT_EQ(idle.reloads, kReloads);
}

TEST_F(WatchTest, takes_no_place_of_a_query_and_eight_at_most) {
    start_ranging();
    std::vector<std::unique_ptr<WatchClient>> clients;
    for (int i = 0; i < 8; ++i) clients.push_back(std::make_unique<WatchClient>(control(), "watch\n"));
    for (const auto& client : clients) EXPECT_EQ(client->greeting, R"({"ok":true,"watch":1})");
    EXPECT_EQ(daemon_->status()["watch"]["watchers"], 8);
    const WatchClient refused(control(), "watch\n");
    EXPECT_NE(refused.greeting.find("limit_exceeded"), std::string::npos) << refused.greeting;
    // None of them reads: the daemon goes on, and what they get later is new.
    const int before = readings_used(daemon_->status());
    EXPECT_TRUE(daemon_->wait_until([&](const Json& now) { return readings_used(now) > before + 500; }, 10s));
    clients[3]->read_for(1s);
    EXPECT_TRUE(clients[3]->map.is_whole());
    clients.pop_back();
    EXPECT_TRUE(daemon_->wait_until([](const Json& now) { return now["watch"]["watchers"] == 7; }, 5s));
    const WatchClient next(control(), "watch status\n");
    EXPECT_EQ(next.greeting, R"({"ok":true,"watch":1})");
}

}  // namespace
}  // namespace octoskin::test
