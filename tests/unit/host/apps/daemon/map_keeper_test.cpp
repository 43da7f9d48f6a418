#include "host/apps/daemon/map_keeper.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

constexpr Nanoseconds kPatience{5'000'000'000};

FusedMap some_map(std::uint16_t voxels) {
    FusedMap map{MapConfig{}};
    for (std::uint16_t i = 0; i < voxels; ++i) {
        const VoxelUpdate update{{static_cast<std::uint16_t>(32768 + 7 * i), 32768, 32700},
                                 i % 3 == 0 ? 0.9F : -0.4F};
        map.apply(std::span(&update, 1));
    }
    return map;
}

TEST(FusedMapCopy, is_equal_and_its_own) {
    FusedMap map = some_map(300);
    const FusedMap copy = map.copy();
    EXPECT_EQ(encode_ot(copy), encode_ot(map));
    EXPECT_EQ(copy.known_voxels(), map.known_voxels());
    EXPECT_EQ(copy.counters(), map.counters());
    const std::string before = encode_ot(copy);
    const VoxelUpdate update{{40000, 40000, 40000}, 0.9F};
    map.apply(std::span(&update, 1));
    EXPECT_EQ(encode_ot(copy), before);
    EXPECT_NE(encode_ot(map), before);
}

TEST(FusedMapLimit, keeps_every_voxel_within_the_new_clamps) {
    FusedMap map = some_map(300);
    const MapConfig tighter{.log_odds_min = -0.1F, .log_odds_max = 0.5F, .memory_max_mib = 1};
    FusedMap same = map.copy();
    same.limit(MapConfig{.memory_max_mib = 900});
    EXPECT_EQ(encode_ot(same), encode_ot(map));
    map.limit(tighter);
    EXPECT_EQ(map.known_voxels(), 300U);
    EXPECT_EQ(map.log_odds({32768, 32768, 32700}), 0.5F);
    EXPECT_EQ(map.log_odds({32775, 32768, 32700}), -0.1F);
    EXPECT_EQ(map.log_odds({32769, 32768, 32700}), std::nullopt);
    EXPECT_EQ(map.config(), tighter);
}

TEST(FusedMapLimit, makes_room_again_and_counts_anew) {
    FusedMap map{MapConfig{.memory_max_mib = 1}};
    const auto fill = [&map](std::uint16_t from) {
        for (std::uint16_t i = 0; i < 1000; ++i) {
            const VoxelUpdate update{{static_cast<std::uint16_t>(8 * i), from, 0}, 0.9F};
            map.apply(std::span(&update, 1));
        }
    };
    fill(0);
    const std::size_t known = map.known_voxels();
    EXPECT_EQ(map.counters().no_room, 1000U - known);
    map.limit(MapConfig{.memory_max_mib = 4});
    EXPECT_EQ(map.counters(), MapCounters{});
    fill(0);
    EXPECT_EQ(map.known_voxels(), 1000U);
    map.limit(MapConfig{.memory_max_mib = 1});
    EXPECT_EQ(map.copy().known_voxels(), 1000U) << "what is there stays";
    fill(8);
    EXPECT_EQ(map.counters().no_room, 1000U);
    EXPECT_EQ(map.copy().known_voxels(), 1000U);
}

TEST(MapKeeper, loads_what_it_saved) {
    const testing_support::ScratchFolder folder;
    const FusedMap map = some_map(300);
    {
        std::filesystem::create_directory(folder / "maps");
        MapKeeper keeper(folder / "maps");
        EXPECT_FALSE(keeper.load(MapConfig{}).value().has_value());
        EXPECT_TRUE(keeper.save(map));
        ASSERT_TRUE(keeper.finish(kPatience));
        EXPECT_EQ(keeper.record().saved, 1U);
        EXPECT_TRUE(keeper.record().newest);
    }
    const MapKeeper again(folder / "maps");
    const auto loaded = again.load(MapConfig{});
    ASSERT_TRUE(loaded && *loaded);
    EXPECT_EQ(encode_ot(**loaded), encode_ot(map));
}

TEST(MapKeeper, refuses_a_damaged_map_and_one_of_another_resolution_by_name) {
    const testing_support::ScratchFolder folder;
    const MapKeeper keeper(folder.path());
    folder.write("fused.ot", "# Octomap OcTree file\nid OcTree\nsize 9\nres 0.04\ndata\nxx");
    const auto damaged = keeper.load(MapConfig{});
    ASSERT_FALSE(damaged);
    EXPECT_NE(damaged.error().message.find("fused.ot"), std::string::npos);
    folder.write("fused.ot", encode_ot(some_map(10)));
    const auto other = keeper.load(MapConfig{.resolution_m = 0.02});
    ASSERT_FALSE(other);
    EXPECT_NE(other.error().message.find("0.04"), std::string::npos) << other.error().message;
}

/// A disk that a test stops.
class SlowDisk {
  public:
    [[nodiscard]] MapKeeper::Writer writer() {
        return [this](const FusedMap& map, const std::filesystem::path&) {
            std::unique_lock lock(mutex_);
            ++begun_;
            changed_.notify_all();
            changed_.wait(lock, [this] { return is_open_; });
            written_ = map.known_voxels();
            return std::string();
        };
    }
    void wait_for_write() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return begun_ > 0; });
    }
    void open() {
        const std::lock_guard lock(mutex_);
        is_open_ = true;
        changed_.notify_all();
    }
    [[nodiscard]] std::size_t written() const { return written_; }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    int begun_ = 0;
    bool is_open_ = false;
    std::atomic<std::size_t> written_ = 0;
};

TEST(MapKeeper, copies_nothing_while_it_writes_and_counts_what_it_skipped) {
    const testing_support::ScratchFolder folder;
    SlowDisk disk;
    MapKeeper keeper(folder.path(), disk.writer());
    EXPECT_TRUE(keeper.save(some_map(5)));
    disk.wait_for_write();
    EXPECT_FALSE(keeper.save(some_map(6)));
    EXPECT_FALSE(keeper.save(some_map(7)));
    disk.open();
    ASSERT_TRUE(keeper.finish(kPatience));
    EXPECT_EQ(disk.written(), 5U);
    EXPECT_TRUE(keeper.save(some_map(8)));
    ASSERT_TRUE(keeper.finish(kPatience));
    EXPECT_EQ(disk.written(), 8U);
    EXPECT_EQ(keeper.record().saved, 2U);
    EXPECT_EQ(keeper.record().skipped, 2U);
}

TEST(MapKeeper, does_not_wait_for_a_disk_that_hangs) {
    const testing_support::ScratchFolder folder;
    // The save that is left behind may still hold its lock when the test has ended.
    static SlowDisk& disk = *new SlowDisk;
    const auto begun = std::chrono::steady_clock::now();
    {
        MapKeeper keeper(folder.path(), disk.writer());
        EXPECT_TRUE(keeper.save(some_map(5)));
        disk.wait_for_write();
        EXPECT_FALSE(keeper.finish(Nanoseconds{50'000'000}));
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(2));
    EXPECT_EQ(disk.written(), 0U);
    disk.open();  // what was left behind ends, before the disk does
    while (disk.written() != 5U) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

TEST(MapKeeper, says_why_it_cannot_save) {
    const testing_support::ScratchFolder folder;
    folder.write("file", "in the way");
    MapKeeper keeper(folder / "file");
    EXPECT_TRUE(keeper.save(some_map(3)));
    ASSERT_TRUE(keeper.finish(kPatience));
    EXPECT_EQ(keeper.record().failed, 1U);
    EXPECT_NE(keeper.record().error.find("file"), std::string::npos);
}

}  // namespace
}  // namespace octoskin
