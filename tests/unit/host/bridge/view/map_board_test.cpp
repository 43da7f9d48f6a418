// What the readers of the view's map put together is the daemon's map, and costs no memory over night.
#include "host/bridge/view/map_board.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <random>
#include <vector>

#include "host/core/bricks/cell_term.hpp"
#include "host/io/snapshot/bytes.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin::view {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// The daemon's side: a map that changes, and `watch`'s frames of it.
class Daemon {
  public:
    explicit Daemon(unsigned seed, double resolution_m = 0.05)
        : random_(seed), map_({.resolution_m = resolution_m, .age = {.stale_after_s = 3}}) {}

    /// Another map at the watcher, after some voxels of `cells` cubed have changed.
    const watch::WatchedMap& next(int voxels, int cells = 60) {
        now_.ns += kSecond / 10;
        map_.advance_time(now_);
        std::vector<VoxelUpdate> updates;
        for (int i = 0; i < voxels; ++i) updates.push_back({key(cells), term()});
        feed(map_, updates, SensorKind::camera);
        FusedMap copy = map_.copy();
        lacks_.on_map(copy, before_ ? watch::changed_bricks(copy, *before_) : watch::BrickCodes{});
        before_.emplace(std::move(copy));
        while (const auto piece = lacks_.next(*before_, 4'000))
            EXPECT_EQ(watched_.take({.kind = watch::FrameKind::map, .flags = piece->flags, .time = now_},
                                    piece->payload),
                      watch::WatchedMap::Taken::all);
        return watched_;
    }
    [[nodiscard]] const FusedMap& map() const { return map_; }
    [[nodiscard]] HostTime now() const { return now_; }

  private:
    VoxelKey key(int cells) {
        std::uniform_int_distribution<int> place(0, cells - 1);
        const auto at = [&] { return static_cast<std::uint16_t>(32'768 + place(random_)); };
        return {at(), at(), at()};
    }
    float term() { return std::uniform_real_distribution<float>(-1.5F, 1.5F)(random_); }

    std::mt19937 random_;
    FusedMap map_;
    std::optional<FusedMap> before_;
    watch::MapReader lacks_;
    watch::WatchedMap watched_;
    HostTime now_{kSecond};
};

/// A client of the view's.
class Client {
  public:
    explicit Client(MapBoard& board) : stream_(board.stream()) {}
    /// False if there is no further frame.
    bool read() {
        const auto message = stream_->next();
        if (!message) return false;
        snapshot::ByteReader reader(message->payload);
        const auto flags = reader.get<std::uint8_t>();
        const HostTime time{reader.get<std::int64_t>()};
        EXPECT_TRUE(reader.is_sound());
        EXPECT_EQ(map.take({.kind = watch::FrameKind::map, .flags = flags, .time = time},
                           std::string_view(message->payload).substr(9)),
                  watch::WatchedMap::Taken::all);
        begun += (flags & watch::kBegins) != 0 ? 1 : 0;
        bytes_max = std::max(bytes_max, message->payload.size());
        return true;
    }
    void read_all() {
        while (read()) continue;
    }
    watch::WatchedMap map;
    int begun = 0;
    std::size_t bytes_max = 0;

  private:
    std::unique_ptr<MessageStream> stream_;
};

void expect_equal(const watch::WatchedMap& found, const FusedMap& map) {
    EXPECT_TRUE(found.is_complete());
    EXPECT_EQ(found.map().stale_stamp(), map.stale_stamp());
    std::size_t bricks = 0;
    found.log_odds().for_each([&](MortonCode, const BrickView&) { ++bricks; });
    EXPECT_EQ(bricks, map.layers().log_odds.bricks());
    for (const MortonCode brick : watch::bricks_of(map))
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
            ASSERT_EQ(std::bit_cast<std::uint32_t>(found.log_odds().find(brick).at(cell)),
                      std::bit_cast<std::uint32_t>(map.layers().log_odds.find(brick).at(cell)));
            ASSERT_EQ(found.stamps().find(brick).at(cell), map.layers().ages.find(brick).at(cell));
        }
}

TEST(MapBoard, gives_the_daemons_map_brick_by_brick_to_quick_slow_and_late_readers) {
    Daemon daemon(3);
    MapBoard board;
    Client quick(board);
    Client slow(board);
    std::optional<Client> late;
    EXPECT_FALSE(quick.read()) << "there is no map yet";
    const unsigned rounds = testing_support::cases(200);
    for (unsigned round = 0; round < rounds; ++round) {
        board.on_map(daemon.next(200), WallTime{1});
        if (round == rounds / 2) late.emplace(board);
        quick.read_all();
        if (round % 40 == 0) expect_equal(quick.map, daemon.map());
        if (round % 7 == 0) (void)slow.read();
    }
    slow.read_all();
    late->read_all();
    for (const Client* const client : {&quick, &slow, &*late}) {
        expect_equal(client->map, daemon.map());
        EXPECT_EQ(client->map.time(), daemon.now());
        EXPECT_EQ(client->begun, 1);
        EXPECT_LT(client->bytes_max, MapBoard::kFrameBytes + 4096);
    }
}

TEST(MapBoard, cuts_a_large_map_into_frames) {
    Daemon daemon(4);
    MapBoard board;
    board.on_map(daemon.next(60'000, 200), WallTime{1});
    Client client(board);
    int frames = 0;
    while (client.read()) ++frames;
    EXPECT_GT(frames, 3);
    expect_equal(client.map, daemon.map());
}

TEST(MapBoard, begins_again_with_another_daemon_and_with_another_resolution) {
    Daemon first(5);
    MapBoard board;
    Client client(board);
    board.on_map(first.next(500), WallTime{1});
    client.read_all();
    board.begin_again();
    EXPECT_FALSE(client.read()) << "the newest map is still shown";
    Daemon second(6);
    board.on_map(second.next(500), WallTime{2});
    client.read_all();
    EXPECT_EQ(client.begun, 2);
    expect_equal(client.map, second.map());
    Daemon third(7, 0.02);
    board.on_map(third.next(500), WallTime{3});
    client.read_all();
    EXPECT_EQ(client.begun, 3);
    expect_equal(client.map, third.map());
}

#ifndef OCTOSKIN_SANITIZED  // its allocator does not say what is in use
TEST(MapBoard, keeps_its_memory_over_ten_thousand_maps_with_a_quick_and_a_stalled_reader) {
    Daemon daemon(8);
    MapBoard board;
    Client quick(board);
    Client stalled(board);
    const auto run = [&](int maps) {
        for (int i = 0; i < maps; ++i) {
            board.on_map(daemon.next(5, 16), WallTime{i});
            quick.read_all();
        }
        return mallinfo2().uordblks;
    };
    const std::size_t before = run(1'000);  // by then all bricks are there
    const std::size_t after = run(10'000);
    EXPECT_LT(after, before + before / 10);
    stalled.read_all();
    expect_equal(stalled.map, daemon.map());
}
#endif

}  // namespace
}  // namespace octoskin::view
