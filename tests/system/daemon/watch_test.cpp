// A client that watches a daemon on a bus that is alive.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <map>
#include <memory>
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
            EXPECT_TRUE(watch::parse_range(payload));
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
    EXPECT_EQ(client.of_kind.size(), 1U);
    WatchClient unknown(control(), "watch everything\n");
    EXPECT_NE(unknown.greeting.find("map, ranges, joints, status"), std::string::npos) << unknown.greeting;
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
