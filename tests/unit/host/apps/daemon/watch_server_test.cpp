// Watchers that read, stall, go away and come again, while the loop gives maps and events.
#include "host/apps/daemon/watch_server.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/io/watch/watched_map.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;

HostRig rig_of_two_joints() {
    HostRig rig;
    rig.joint_sources = {{.node_id = 9, .joints = {"a", "b"}}};
    return rig;
}

/// The other end of a connection, which reads frames.
class Reader {
  public:
    explicit Reader(WatchServer& server, const WatchWants& wants = {true, true, true, true}) {
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
        connection_ = ends[0];
        const timeval patience{.tv_sec = 5, .tv_usec = 0};
        ::setsockopt(connection_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
        is_taken = server.take(ends[1], wants);
        if (!is_taken) ::close(ends[1]);
    }
    ~Reader() { ::close(connection_); }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    std::string line() const {
        std::string text;
        for (char next = 0; ::recv(connection_, &next, 1, 0) == 1 && next != '\n';) text += next;
        return text;
    }
    /// False at the end of the connection.
    bool read() {
        const auto parsed = watch::parse_header(bytes(watch::kHeaderBytes));
        if (!parsed) return false;
        header = *parsed;
        payload = bytes(header.bytes);
        EXPECT_EQ(header.number, frames++);
        if (header.kind == watch::FrameKind::map) {
            EXPECT_EQ(map.take(header, payload), watch::WatchedMap::Taken::all);
        }
        return true;
    }
    /// Reads on until it has the complete map of this time.
    bool read_to(HostTime time) {
        while (read())
            if (map.is_complete() && map.time() == time) return true;
        return false;
    }
    /// The number of the next frame, which is a reload; empty if it is another one.
    std::optional<std::uint64_t> next_reload() {
        if (!read() || header.kind != watch::FrameKind::reload) return std::nullopt;
        return watch::parse_reload(payload);
    }
    bool is_taken = false;
    watch::FrameHeader header;
    std::string payload;
    std::uint64_t frames = 0;
    watch::WatchedMap map;

  private:
    std::string bytes(std::size_t count) const {
        std::string all(count, '\0');
        std::size_t got = 0;
        while (got < count) {
            const ssize_t now = ::recv(connection_, all.data() + got, count - got, 0);
            if (now <= 0) break;
            got += static_cast<std::size_t>(now);
        }
        all.resize(got);
        return all;
    }
    int connection_ = -1;
};

/// Marks the voxels of a wall that moves, some thousand bricks.
void change(FusedMap& map, int step) {
    std::vector<VoxelUpdate> updates;
    for (int y = 0; y < 60; ++y)
        for (int z = 0; z < 60; ++z)
            updates.push_back(
                {{static_cast<std::uint16_t>(32'768 + step), static_cast<std::uint16_t>(32'768 + 4 * y),
                  static_cast<std::uint16_t>(32'768 + 4 * z)},
                 1.0F});
    feed(map, updates, SensorKind::camera);
}

template <class IsSo>
bool wait_until(const IsSo& is_so) {
    for (int i = 0; i < 500 && !is_so(); ++i) std::this_thread::sleep_for(10ms);
    return is_so();
}

TEST(WatchServer, accepts_the_words_that_it_knows) {
    EXPECT_TRUE(WatchServer::is_request("watch"));
    EXPECT_TRUE(WatchServer::is_request("watch map"));
    EXPECT_FALSE(WatchServer::is_request("watcher"));
    const auto all = WatchServer::parse("watch");
    EXPECT_TRUE(all && all->map && all->ranges && all->joints && all->status);
    EXPECT_FALSE(all->images || all->robot);
    const auto some = WatchServer::parse("watch map joints");
    EXPECT_TRUE(some && some->map && !some->ranges && some->joints && !some->status);
    const auto views = WatchServer::parse("watch images robot");
    EXPECT_TRUE(views && views->images && views->robot && !views->map);
    EXPECT_FALSE(WatchServer::parse("watch maps"));
}

TEST(WatchServer, gives_an_image_of_each_camera_in_a_period_and_the_newest_robot) {
    WatchServer server(rig_of_two_joints());
    server.give_robot("<robot/>");
    Reader reader(server, {.images = true, .robot = true});
    (void)reader.line();
    ASSERT_TRUE(reader.read());
    EXPECT_EQ(reader.header.kind, watch::FrameKind::reload);
    ASSERT_TRUE(reader.read());
    EXPECT_EQ(reader.header.kind, watch::FrameKind::robot);
    EXPECT_EQ(reader.payload, "<robot/>");
    constexpr std::int64_t kTenth_ns = 100'000'000;
    for (std::int64_t i = 1; i <= 10; ++i)
        for (const std::uint8_t camera : {std::uint8_t{0}, std::uint8_t{1}})
            server.on_image({.captured = {i * kTenth_ns},
                             .width = 2,
                             .height = 1,
                             .depth_mm = {1, 2},
                             .T_map_camera = std::nullopt,
                             .camera = camera});
    for (std::int64_t i = 1; i <= 10; i += 2) {
        for (const std::uint8_t camera : {std::uint8_t{0}, std::uint8_t{1}}) {
            ASSERT_TRUE(reader.read());
            EXPECT_EQ(reader.header.time, HostTime{i * kTenth_ns});
            EXPECT_EQ(watch::parse_image(reader.payload)->camera, camera);
        }
    }
    server.give_robot("<other/>");
    ASSERT_TRUE(reader.read());
    EXPECT_EQ(reader.payload, "<other/>");
    Reader late(server, {.robot = true});
    (void)late.line();
    ASSERT_TRUE(late.read());
    EXPECT_EQ(late.header.kind, watch::FrameKind::reload);
    ASSERT_TRUE(late.read());
    EXPECT_EQ(late.payload, "<other/>");
}

TEST(WatchServer, gives_each_watcher_what_it_wants_and_the_whole_map_first) {
    WatchServer server(rig_of_two_joints());
    EXPECT_FALSE(server.wants(watch::FrameKind::map));
    FusedMap map{MapConfig{}};
    change(map, 0);
    Reader early(server, {.map = true});
    EXPECT_TRUE(server.wants(watch::FrameKind::map));
    EXPECT_FALSE(server.wants(watch::FrameKind::range));
    EXPECT_EQ(early.line(), R"({"ok":true,"watch":1})");
    server.give_map(map.copy(), {1});
    EXPECT_TRUE(early.read_to({1}));
    change(map, 1);
    server.give_map(map.copy(), {2});
    EXPECT_TRUE(early.read_to({2}));
    Reader late(server);
    (void)late.line();
    server.on_sample({.sampled = {5}, .position_rad = {0.5, 0.25}});
    server.give_status("{}");
    change(map, 2);
    server.give_map(map.copy(), {3});
    EXPECT_TRUE(late.read_to({3}));
    EXPECT_TRUE(early.read_to({3}));
    for (Reader* reader : {&early, &late}) {
        std::size_t same = 0;
        map.for_each_known(
            [&](VoxelKey key, float) { same += reader->map.occupancy(key) == map.occupancy(key) ? 1U : 0U; });
        EXPECT_EQ(same, map.known_voxels());
    }
}

// What waits for a watcher that reads nothing is bounded; what it gets later is new.
TEST(WatchServer, drops_the_oldest_events_of_one_that_stalls_and_catches_it_up) {
    WatchServer server(rig_of_two_joints());
    Reader reader(server);
    (void)reader.line();
    FusedMap map{MapConfig{}};
    for (int step = 0; step < 40; ++step) {
        change(map, 8 * step);
        server.give_map(map.copy(), {step + 1});
        for (int i = 0; i < 500; ++i)
            server.on_sample({.sampled = {step * 1'000 + i}, .position_rad = {1.0, 2.0}});
        std::this_thread::sleep_for(2ms);
    }
    EXPECT_TRUE(reader.read_to({40}));
    EXPECT_GT(reader.header.lost, 1'000U);
    EXPECT_LT(reader.frames, 15'000U);
    std::size_t same = 0;
    map.for_each_known(
        [&](VoxelKey key, float) { same += reader.map.occupancy(key) == map.occupancy(key) ? 1U : 0U; });
    EXPECT_EQ(same, map.known_voxels());
}

TEST(WatchServer, says_first_which_rig_a_watcher_sees_and_then_when_another_one_follows) {
    WatchServer server(rig_of_two_joints());
    server.change_rig(rig_of_two_joints(), 6);
    Reader reader(server, {.joints = true});
    (void)reader.line();
    EXPECT_EQ(reader.next_reload(), 6U);
    server.on_sample({.sampled = {1}, .position_rad = {0.5, 0.25}});
    HostRig other;
    other.joint_sources = {{.node_id = 9, .joints = {"a", "b", "c"}}};
    server.change_rig(other, 7);
    server.on_sample({.sampled = {2}, .position_rad = {0.5, 0.25, 1.0}});
    ASSERT_TRUE(reader.read());
    EXPECT_EQ(reader.header.time, HostTime{1});
    EXPECT_EQ(reader.next_reload(), 7U);
    ASSERT_TRUE(reader.read());
    EXPECT_EQ(reader.header.time, HostTime{2});
    EXPECT_EQ(watch::parse_joints(reader.payload).value().position.size(), 3U);
}

// The map that waits at a reload is of the rig before it, whichever thread has it and however much of it went
// out.
TEST(WatchServer, sends_no_map_of_the_rig_before_a_reload_after_it) {
    WatchServer server(rig_of_two_joints());
    FusedMap map{MapConfig{}};
    Reader slow(server);
    Reader quick(server, {.map = true});
    (void)slow.line();
    (void)quick.line();
    std::int64_t given = 0;
    for (std::uint64_t reload = 1; reload <= 40; ++reload) {
        for (int step = 0; step < 4; ++step) {
            change(map, static_cast<int>(4 * reload) + step);
            server.give_map(map.copy(), {++given});
            server.on_sample({.sampled = {given}, .position_rad = {1.0, 2.0}});
            std::this_thread::sleep_for(std::chrono::microseconds(given * 97 % 3'000));
        }
        server.change_rig(rig_of_two_joints(), reload);
        Reader late(server, {.map = true});
        (void)late.line();
        EXPECT_EQ(late.next_reload(), reload);
        server.give_map(map.copy(), {++given});
        ASSERT_TRUE(late.read());
        EXPECT_EQ(late.header.time, HostTime{given}) << "not the one before the reload";
    }
    for (Reader* reader : {&slow, &quick}) {
        EXPECT_EQ(reader->next_reload(), 0U);
        std::int64_t newest = 0;
        std::uint64_t reloads = 0;
        while (newest < given && reader->read()) {
            newest = std::max(newest, reader->header.time.ns);
            if (reader->header.kind == watch::FrameKind::reload)
                reloads = watch::parse_reload(reader->payload).value();
            else  // five times are given from one reload to the next, the first of them at once
                EXPECT_EQ(reader->header.time.ns / 5, static_cast<std::int64_t>(reloads));
        }
        EXPECT_EQ(reloads, 40U);
        EXPECT_TRUE(reader->map.is_complete() || reader->read_to({given}));
    }
}

TEST(WatchServer, loses_no_reload_of_one_that_stalls) {
    WatchServer server(rig_of_two_joints());
    Reader reader(server, {.joints = true});
    (void)reader.line();
    EXPECT_EQ(reader.next_reload(), 0U);
    constexpr std::int64_t kOfEach = 3'000;  // more than what waits for a watcher
    for (std::uint64_t reload = 0; reload < 20; ++reload) {
        if (reload > 0) server.change_rig(rig_of_two_joints(), reload);
        for (std::int64_t i = 0; i < kOfEach; ++i)
            server.on_sample(
                {.sampled = {static_cast<std::int64_t>(reload) * kOfEach + i}, .position_rad = {1.0, 2.0}});
        std::this_thread::sleep_for(2ms);
    }
    std::uint64_t reloads = 0;
    while (reader.header.time.ns != 20 * kOfEach - 1 && reader.read()) {
        if (reader.header.kind == watch::FrameKind::reload)
            reloads = watch::parse_reload(reader.payload).value();
        else
            EXPECT_EQ(reader.header.time.ns / kOfEach, static_cast<std::int64_t>(reloads));
    }
    EXPECT_EQ(reloads, 19U);
    EXPECT_GT(reader.header.lost, 10'000U);
}

TEST(WatchServer, ends_the_connection_of_one_that_reads_nothing_for_long) {
    WatchServer server(rig_of_two_joints(), Nanoseconds{200'000'000});
    Reader reader(server, {.status = true});
    (void)reader.line();
    EXPECT_EQ(server.record().watchers, 1U);
    for (int i = 0; i < 100; ++i) server.give_status(std::string(100'000, ' '));
    EXPECT_TRUE(wait_until([&] {
        server.give_status("{}");
        return server.record().stalled == 1;
    }));
    EXPECT_TRUE(wait_until([&] { return server.record().watchers == 0; }));
    EXPECT_FALSE(server.wants(watch::FrameKind::status));
}

TEST(WatchServer, serves_eight_and_another_one_when_one_of_them_has_gone) {
    WatchServer server(rig_of_two_joints());
    std::vector<std::unique_ptr<Reader>> readers;
    for (std::size_t i = 0; i < WatchServer::kWatchersMax; ++i)
        readers.push_back(std::make_unique<Reader>(server));
    for (const auto& reader : readers) EXPECT_TRUE(reader->is_taken);
    EXPECT_FALSE(Reader(server).is_taken);
    readers.pop_back();
    EXPECT_TRUE(wait_until([&] { return server.record().watchers == WatchServer::kWatchersMax - 1; }));
    EXPECT_TRUE(Reader(server).is_taken);
    server.end();
    EXPECT_FALSE(Reader(server).is_taken);
    (void)readers.front()->line();
    EXPECT_EQ(readers.front()->next_reload(), 0U);
    EXPECT_FALSE(readers.front()->read()) << "closed";
}

}  // namespace
}  // namespace octoskin
