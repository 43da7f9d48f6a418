#include "host/apps/daemon/map_saver.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <thread>

#include "host/io/mapfile/map_file.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/snapshot/snapshot.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

constexpr Nanoseconds kPatience{30'000'000'000};  // a busy machine, under the thread sanitizer

MappingConfig mapping_of(const MapConfig& map) {
    MappingConfig mapping;
    mapping.map = map;
    return mapping;
}

FusedMap some_map(std::uint16_t voxels) {
    FusedMap map{MapConfig{}};
    for (std::uint16_t i = 0; i < voxels; ++i) {
        const VoxelUpdate update{{static_cast<std::uint16_t>(32768 + 7 * i), 32768, 32700},
                                 i % 3 == 0 ? 0.9F : -0.4F};
        feed(map, std::span(&update, 1));
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
    feed(map, std::span(&update, 1));
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
            feed(map, std::span(&update, 1));
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

TEST(MapSaver, loads_what_it_saved) {
    const testing_support::ScratchFolder folder;
    const FusedMap map = some_map(300);
    {
        std::filesystem::create_directory(folder / "maps");
        MapSaver saver(folder / "maps");
        EXPECT_FALSE(saver.load(mapping_of(MapConfig{})).value().has_value());
        EXPECT_TRUE(saver.save(map));
        ASSERT_TRUE(saver.finish(kPatience));
        EXPECT_EQ(saver.record().saved, 1U);
        EXPECT_TRUE(saver.record().newest);
    }
    const MapSaver again(folder / "maps");
    const auto loaded = again.load(mapping_of(MapConfig{}));
    ASSERT_TRUE(loaded && *loaded);
    EXPECT_EQ(encode_ot((*loaded)->map), encode_ot(map));
}

/// Whose voxel was seen by a range sensor 7 s ago, and counted.
FusedMap dated_map() {
    FusedMap map{MapConfig{}};
    map.advance_time(HostTime{100'000'000'000});
    ConeVoxels cone;
    cone.cap = {{{32768, 32768, 32700}, 1.0F}};
    for (int i = 0; i < 9; ++i) feed(map, cone, ConeModel{});
    map.advance_time(HostTime{107'000'000'000});
    return map;
}

constexpr std::uint32_t kMapping = 5;

SnapshotOrigin origin_now() {
    return {.mapping_crc32 = kMapping, .placement_crc32 = 7, .map_time = BootTime{{1, 2, 3}, Nanoseconds{4}}};
}

TEST(MapSaver, loads_counts_and_times_that_it_saved_and_when_that_was) {
    const testing_support::ScratchFolder folder;
    const FusedMap map = dated_map();
    ASSERT_GT(map.known_voxels(), 0U);
    MapSaver saver(folder.path());
    EXPECT_TRUE(saver.save(map, origin_now()));
    ASSERT_TRUE(saver.finish(kPatience));
    EXPECT_EQ(saver.record().error, "");
    const auto kept = saver.load(mapping_of(MapConfig{}), kMapping);
    ASSERT_TRUE(kept && *kept);
    EXPECT_TRUE((*kept)->is_whole);
    EXPECT_TRUE((*kept)->warnings.empty());
    EXPECT_EQ((*kept)->map_time, origin_now().map_time);
    EXPECT_EQ((*kept)->placement_crc32, origin_now().placement_crc32);
    const auto bytes = [](const FusedMap& of) { return encode_snapshot({of.copy(), {}}, {}); };
    EXPECT_TRUE(bytes((*kept)->map) == bytes(map));
}

/// What happens in a folder while it lives.
class FolderEvents {
  public:
    explicit FolderEvents(const std::filesystem::path& folder) : descriptor_(::inotify_init1(IN_NONBLOCK)) {
        ::inotify_add_watch(descriptor_, folder.c_str(),
                            IN_CREATE | IN_MODIFY | IN_CLOSE_WRITE | IN_MOVED_TO);
    }
    ~FolderEvents() { ::close(descriptor_); }
    FolderEvents(const FolderEvents&) = delete;
    FolderEvents& operator=(const FolderEvents&) = delete;

    /// Names of what came into its place, after all else; empty: something else came behind the first.
    [[nodiscard]] std::vector<std::string> moved_last() const {
        std::vector<std::string> moved;
        alignas(inotify_event) char bytes[65'536];
        const ssize_t count = ::read(descriptor_, bytes, sizeof(bytes));
        for (ssize_t at = 0; at < count;) {
            const auto* const event = reinterpret_cast<const inotify_event*>(bytes + at);
            at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
            const bool is_moved = (event->mask & IN_MOVED_TO) != 0;
            if (!is_moved && !moved.empty()) return {};
            if (is_moved) moved.emplace_back(event->name);
        }
        return moved;
    }

  private:
    int descriptor_;
};

TEST(MapSaver, has_written_all_its_files_before_the_first_comes_into_its_place) {
    const testing_support::ScratchFolder folder;
    for (int save = 0; save < 2; ++save) {
        const FolderEvents events(folder.path());
        EXPECT_EQ(MapSaver::write_map(dated_map(), origin_now(), NamedFolder(folder.path())), "");
        EXPECT_EQ(events.moved_last(), (std::vector<std::string>{"fused.ot", "fused.snapshot", "fused.bt"}));
    }
}

TEST(MapSaver, leaves_the_whole_map_of_before_where_one_of_its_files_cannot_be_written) {
    for (const char* const name : {"fused.ot", "fused.bt", "fused.snapshot"}) {
        const testing_support::ScratchFolder folder;
        EXPECT_EQ(MapSaver::write_map(dated_map(), origin_now(), NamedFolder(folder.path())), "");
        const auto in_the_way = folder / ("." + std::string(name) + ".octoskin-part");
        std::filesystem::create_directory(in_the_way);
        const std::string error = MapSaver::write_map(some_map(30), origin_now(), NamedFolder(folder.path()));
        EXPECT_NE(error.find(name), std::string::npos) << error;
        EXPECT_EQ(folder.entries(), 4) << name;
        const auto kept = MapSaver(folder.path()).load(mapping_of(MapConfig{}), kMapping);
        ASSERT_TRUE(kept && *kept) << name;
        EXPECT_TRUE((*kept)->is_whole) << name;
        EXPECT_EQ(encode_ot((*kept)->map), encode_ot(dated_map())) << name;
    }
}

/// A folder as a process leaves it that is killed when `renames` of the three files of a save were renamed.
void leave_killed_save(const testing_support::ScratchFolder& folder, std::size_t renames) {
    const testing_support::ScratchFolder saved;
    EXPECT_EQ(MapSaver::write_map(some_map(300), {}, NamedFolder(folder.path())), "");
    EXPECT_EQ(MapSaver::write_map(dated_map(), origin_now(), NamedFolder(saved.path())), "");
    for (const std::string name : {"fused.ot", "fused.snapshot", "fused.bt"}) {
        const bool is_renamed = renames > 0;
        renames -= is_renamed ? 1U : 0U;
        folder.write(is_renamed ? name : "." + name + ".octoskin-part",
                     testing_support::ScratchFolder::read(saved / name));
    }
}

TEST(MapSaver, goes_on_with_a_whole_map_wherever_the_save_before_was_killed) {
    for (std::size_t renames = 0; renames < 4; ++renames) {
        const testing_support::ScratchFolder folder;
        leave_killed_save(folder, renames);
        const FusedMap map = renames == 0 ? some_map(300) : dated_map();
        const std::uint32_t mapping = renames == 0 ? 0 : kMapping;
        for (const bool is_again : {false, true}) {
            const auto kept = MapSaver(folder.path()).load(mapping_of(MapConfig{}), mapping);
            ASSERT_TRUE(kept && *kept) << renames;
            EXPECT_TRUE((*kept)->is_whole) << renames << is_again;
            EXPECT_EQ(encode_ot((*kept)->map), encode_ot(map)) << renames;
            EXPECT_EQ(folder.entries(), 3) << "what was left of it goes";
        }
    }
}

TEST(MapSaver, uses_no_half_of_a_snapshot_that_a_killed_save_left) {
    const testing_support::ScratchFolder folder;
    leave_killed_save(folder, 1);
    const auto draft = folder / ".fused.snapshot.octoskin-part";
    std::filesystem::resize_file(draft, std::filesystem::file_size(draft) - 1);
    const auto kept = MapSaver(folder.path()).load(mapping_of(MapConfig{}), kMapping);
    ASSERT_TRUE(kept && *kept);
    EXPECT_FALSE((*kept)->is_whole);
    EXPECT_EQ((*kept)->warnings.size(), 1U);
    EXPECT_EQ(folder.entries(), 3);
}

TEST(MapSaver, goes_on_with_log_odds_alone_where_the_snapshot_is_not_the_maps) {
    const auto folder_with = [](testing_support::ScratchFolder& folder) {
        MapSaver saver(folder.path());
        EXPECT_TRUE(saver.save(dated_map(), origin_now()));
        EXPECT_TRUE(saver.finish(kPatience));
    };
    const auto expect_alone = [](const testing_support::ScratchFolder& folder, std::uint32_t mapping_crc32,
                                 const std::string& why) {
        const auto kept = MapSaver(folder.path()).load(mapping_of(MapConfig{}), mapping_crc32);
        ASSERT_TRUE(kept && *kept) << why;
        EXPECT_FALSE((*kept)->is_whole) << why;
        EXPECT_FALSE((*kept)->map.layers().ages.has_begun()) << why;
        EXPECT_EQ((*kept)->map.known_voxels(), dated_map().known_voxels()) << why;
        ASSERT_EQ((*kept)->warnings.size(), why.empty() ? 0U : 1U) << why;
        EXPECT_TRUE(why.empty() || (*kept)->warnings.front().find(why) != std::string::npos) << why;
    };
    testing_support::ScratchFolder of_another_mapping;
    folder_with(of_another_mapping);
    expect_alone(of_another_mapping, kMapping + 1, "belongs to the mapping");

    testing_support::ScratchFolder of_another_map;
    folder_with(of_another_map);
    const std::string snapshot = testing_support::ScratchFolder::read(of_another_map / "fused.snapshot");
    {
        MapSaver saver(of_another_map.path());
        FusedMap other = dated_map();
        feed(other, std::vector<VoxelUpdate>{{{32768, 32768, 32700}, -3.0F}});
        EXPECT_TRUE(saver.save(other, origin_now()));
        EXPECT_TRUE(saver.finish(kPatience));
    }
    of_another_map.write("fused.snapshot", snapshot);
    expect_alone(of_another_map, kMapping, "was not saved with the fused.ot beside it");

    testing_support::ScratchFolder damaged;
    folder_with(damaged);
    damaged.write("fused.snapshot", snapshot.substr(0, snapshot.size() - 1));
    expect_alone(damaged, kMapping, "no complete and undamaged block");
    std::filesystem::remove(damaged / "fused.snapshot");
    expect_alone(damaged, kMapping, "");
}

TEST(MapSaver, refuses_a_damaged_map_and_one_of_another_resolution_by_name) {
    const testing_support::ScratchFolder folder;
    const MapSaver saver(folder.path());
    folder.write("fused.ot", "# Octomap OcTree file\nid OcTree\nsize 9\nres 0.04\ndata\nxx");
    const auto damaged = saver.load(mapping_of(MapConfig{}));
    ASSERT_FALSE(damaged);
    EXPECT_EQ(damaged.error().error.file, folder / "fused.ot");
    EXPECT_EQ(damaged.error().error.code, ErrorCode::damaged);
    folder.write("fused.ot", encode_ot(some_map(10)));
    const auto other = saver.load(mapping_of(MapConfig{.resolution_m = 0.02}));
    ASSERT_FALSE(other);
    const Error& error = other.error().error;
    EXPECT_EQ(error.file, folder / "fused.ot");
    EXPECT_EQ(error.code, ErrorCode::mismatch);
    EXPECT_EQ(error.value, "0.040000 m");
    EXPECT_NE(error.what.find("0.020000 m"), std::string::npos) << error.what;
    for (const char* const part : {"map.resolution_m", "fused.ot, fused.bt and fused.snapshot"})
        EXPECT_NE(error.remedy.find(part), std::string::npos) << error.remedy;
}

// Who begins from the map of another program has it as a .bt, and who moved a damaged fused.ot away has no
// more.
TEST(MapSaver, goes_on_with_a_bt_if_that_is_all_there_is) {
    const FusedMap map = some_map(30);
    const std::string octoskins = encode_bt(map);
    std::string octomaps = octoskins;
    octomaps.erase(octomaps.find("# saved by octoskin\n"), 20);
    for (const std::string& bytes : {octoskins, octomaps}) {
        const testing_support::ScratchFolder folder;
        folder.write("fused.bt", bytes);
        const auto loaded = MapSaver(folder.path()).load(mapping_of(MapConfig{}));
        ASSERT_TRUE(loaded) << loaded.error().message();
        ASSERT_TRUE(*loaded);
        EXPECT_EQ(encode_bt((*loaded)->map), octoskins);
        EXPECT_EQ(is_saved_by_octoskin(folder / "fused.bt"), bytes == octoskins);
        EXPECT_EQ((*loaded)->map.log_odds({32768, 32768, 32700}), 3.5F);
    }
}

TEST(MapSaver, refuses_what_its_next_save_would_destroy) {
    const std::string ot = encode_ot(some_map(30));
    std::string octomaps = encode_bt(some_map(29));
    octomaps.erase(octomaps.find("# saved by octoskin\n"), 20);
    const std::string coloured = "# Octomap OcTree file\nid ColorOcTree\nsize 0\nres 0.04\ndata\n";
    struct Case {
        std::string ot, bt;
        std::string file;  ///< of the refusal; empty: taken
        ErrorCode code = {};
    };
    const Case cases[] = {
        {ot, encode_bt(some_map(30)), ""},
        {ot, encode_bt(some_map(29)), ""},  // octoskin's own, saved less lately
        {ot, octomaps, "fused.bt", ErrorCode::mismatch},
        {ot, "not a map at all", "fused.bt", ErrorCode::mismatch},
        {ot, octomaps.substr(0, octomaps.size() - 1), "fused.bt", ErrorCode::mismatch},
        {"", "not a map at all", "fused.bt", ErrorCode::foreign_format},
        {"", octomaps.substr(0, octomaps.size() - 1), "fused.bt", ErrorCode::damaged},
        {coloured, "", "fused.ot", ErrorCode::unsupported},
    };
    for (const Case& each : cases) {
        const testing_support::ScratchFolder folder;
        if (!each.ot.empty()) folder.write("fused.ot", each.ot);
        if (!each.bt.empty()) folder.write("fused.bt", each.bt);
        const auto loaded = MapSaver(folder.path()).load(mapping_of(MapConfig{.memory_max_mib = 4}));
        EXPECT_EQ(loaded.has_value(), each.file.empty()) << each.file;
        if (loaded) continue;
        EXPECT_EQ(loaded.error().error.code, each.code) << loaded.error().message();
        EXPECT_EQ(loaded.error().error.file, folder / each.file) << loaded.error().message();
    }
    // What an older octoskin saved has no comment; the two hold the same voxels.
    const testing_support::ScratchFolder folder;
    folder.write("fused.ot", encode_ot(some_map(29)));
    folder.write("fused.bt", octomaps);
    EXPECT_TRUE(MapSaver(folder.path()).load(mapping_of(MapConfig{})));
}

/// A disk that a test stops.
class SlowDisk {
  public:
    [[nodiscard]] MapSaver::Writer writer() {
        return [this](const FusedMap& map, const SnapshotOrigin&, const NamedFolder&) {
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

TEST(MapSaver, copies_nothing_while_it_writes_and_counts_what_it_skipped) {
    const testing_support::ScratchFolder folder;
    SlowDisk disk;
    MapSaver saver(folder.path(), disk.writer());
    EXPECT_FALSE(saver.record().saving_since);
    EXPECT_TRUE(saver.save(some_map(5)));
    disk.wait_for_write();
    const auto since = saver.record().saving_since;
    EXPECT_TRUE(since);
    EXPECT_FALSE(saver.save(some_map(6)));
    EXPECT_FALSE(saver.save(some_map(7)));
    EXPECT_EQ(saver.record().saving_since, since);
    disk.open();
    ASSERT_TRUE(saver.finish(kPatience));
    EXPECT_FALSE(saver.record().saving_since);
    EXPECT_EQ(disk.written(), 5U);
    EXPECT_TRUE(saver.save(some_map(8)));
    ASSERT_TRUE(saver.finish(kPatience));
    EXPECT_EQ(disk.written(), 8U);
    EXPECT_EQ(saver.record().saved, 2U);
    EXPECT_EQ(saver.record().skipped, 2U);
}

TEST(MapSaver, does_not_wait_for_a_disk_that_hangs) {
    const testing_support::ScratchFolder folder;
    // The save that is left behind may still hold its lock when the test has ended.
    static SlowDisk& disk = *new SlowDisk;
    const auto begun = std::chrono::steady_clock::now();
    {
        MapSaver saver(folder.path(), disk.writer());
        EXPECT_TRUE(saver.save(some_map(5)));
        disk.wait_for_write();
        EXPECT_FALSE(saver.finish(Nanoseconds{50'000'000}));
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(2));
    EXPECT_EQ(disk.written(), 0U);
    disk.open();  // what was left behind ends, before the disk does
    while (disk.written() != 5U) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

TEST(MapSaver, goes_on_after_what_there_was_no_memory_for) {
    const testing_support::ScratchFolder folder;
    bool has_memory = false;
    const auto need_memory = [&has_memory] {
        if (!has_memory) throw std::bad_alloc();
    };
    const MapSaver::Writer write = [&](const FusedMap&, const SnapshotOrigin&, const NamedFolder&) {
        need_memory();
        return std::string();
    };
    MapSaver to_copy(
        folder.path(), [](const FusedMap&, const auto&, const auto&) { return std::string(); },
        [&](const FusedMap& map) {
            need_memory();
            return map.copy();
        });
    EXPECT_FALSE(to_copy.save(some_map(5)));
    EXPECT_TRUE(to_copy.finish(kPatience)) << "busy for ever";
    EXPECT_EQ(to_copy.record().failed, 1U);
    EXPECT_NE(to_copy.record().error.find("memory_max_mib"), std::string::npos) << to_copy.record().error;
    MapSaver to_write(folder.path(), write);
    EXPECT_TRUE(to_write.save(some_map(5)));
    EXPECT_TRUE(to_write.finish(kPatience)) << "busy for ever";
    EXPECT_NE(to_write.record().error.find("out of memory"), std::string::npos) << to_write.record().error;
    has_memory = true;
    for (MapSaver* saver : {&to_copy, &to_write}) {
        EXPECT_TRUE(saver->save(some_map(5)));
        ASSERT_TRUE(saver->finish(kPatience));
        EXPECT_EQ(saver->record().saved, 1U);
        EXPECT_EQ(saver->record().failed, 1U);
        EXPECT_EQ(saver->record().error, "");
    }
}

/// As many voxels as there is memory for, side by side, or each as far from the next as can be.
FusedMap full_map(std::uint32_t memory_mib, bool is_dense) {
    FusedMap map{MapConfig{.memory_max_mib = memory_mib}};
    std::uint32_t random = 1;
    for (std::uint32_t i = 0; map.counters().no_room == 0; ++i) {
        random = random * 1664525U + 1013904223U;
        const std::uint32_t place = is_dense ? i : random;
        const auto axis = [&](unsigned shift, unsigned bits) {
            return static_cast<std::uint16_t>(32768U + (is_dense
                                                            ? (place >> shift) & ((1U << bits) - 1U)
                                                            : ((place * (shift + 7U)) >> 16U) & 0x7FFFU));
        };
        // Neighbours differ, so that no octree leaves any of them out.
        const VoxelUpdate update{{axis(0, 8), axis(8, 8), axis(16, 8)},
                                 0.5F + 0.001F * static_cast<float>(i % 997U)};
        feed(map, std::span(&update, 1));
    }
    return map;
}

TEST(MapSaver, loads_any_map_that_it_saved_with_the_same_memory) {
    for (const bool is_dense : {true, false}) {
        const testing_support::ScratchFolder folder;
        MapSaver saver(folder.path());
        const FusedMap map = full_map(3, is_dense);
        EXPECT_TRUE(saver.save(map));
        ASSERT_TRUE(saver.finish(kPatience));
        const auto loaded = saver.load(mapping_of(map.config()));
        ASSERT_TRUE(loaded) << loaded.error().message();
        EXPECT_EQ((*loaded)->map.known_voxels(), map.known_voxels());
        const auto bytes = std::filesystem::file_size(folder / "fused.ot");
        EXPECT_LT(bytes, (3U << 20U) * 3 / 2) << "what the limit for files is derived from";
        EXPECT_EQ(bytes > 3U << 20U, is_dense) << "the file of a dense map is larger than its memory";
    }
}

TEST(MapSaver, goes_on_with_a_map_that_was_saved_with_wider_clamps) {
    const testing_support::ScratchFolder folder;
    MapSaver saver(folder.path());
    EXPECT_TRUE(saver.save(some_map(30)));
    ASSERT_TRUE(saver.finish(kPatience));
    const MapConfig tighter{.log_odds_min = -0.1F, .log_odds_max = 0.5F};
    const auto loaded = saver.load(mapping_of(tighter), kMapping);
    ASSERT_TRUE(loaded) << loaded.error().message();
    EXPECT_EQ((*loaded)->map.known_voxels(), 30U);
    EXPECT_EQ((*loaded)->map.log_odds({32768, 32768, 32700}), 0.5F);
    EXPECT_EQ((*loaded)->map.log_odds({32775, 32768, 32700}), -0.1F);
    EXPECT_EQ((*loaded)->map.config(), tighter);
}

TEST(MapSaver, says_what_to_do_about_a_map_that_was_saved_with_more_memory) {
    const testing_support::ScratchFolder folder;
    MapSaver saver(folder.path());
    EXPECT_TRUE(saver.save(full_map(4, true)));
    ASSERT_TRUE(saver.finish(kPatience));
    for (const std::uint32_t less_mib : {1U, 3U}) {
        const auto loaded = saver.load(mapping_of(MapConfig{.memory_max_mib = less_mib}));
        ASSERT_FALSE(loaded);
        const Error& error = loaded.error().error;
        EXPECT_EQ(error.code, ErrorCode::too_large) << error.message();
        EXPECT_EQ(error.file, folder / "fused.ot");
        EXPECT_NE(error.what.find(std::to_string(less_mib) + " MiB of map.memory_max_mib"), std::string::npos)
            << error.message();
        EXPECT_NE(error.remedy.find("mapping file"), std::string::npos) << error.message();
    }
    EXPECT_TRUE(saver.load(mapping_of(MapConfig{.memory_max_mib = 4})));
}

TEST(MapSaver, tells_which_mapping_would_not_load_the_map_again) {
    const testing_support::ScratchFolder folder;
    MapSaver saver(folder.path());
    FusedMap map = full_map(4, true);
    EXPECT_TRUE(saver.save(map));
    ASSERT_TRUE(saver.finish(kPatience));
    for (std::uint32_t mib = 1; mib < 6; ++mib) {
        const MapConfig next{.memory_max_mib = mib};
        EXPECT_EQ(!why_no_room(map, next), saver.load(mapping_of(next)).has_value()) << mib;
    }
    const auto error = why_no_room(map, MapConfig{.memory_max_mib = 3});
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code, ErrorCode::too_large);
    EXPECT_EQ(error->key, "map.memory_max_mib");
    EXPECT_EQ(error->value, "3");
    EXPECT_NE(error->remedy.find("4"), std::string::npos) << error->remedy;
    EXPECT_FALSE(why_no_room(FusedMap(MapConfig{}), MapConfig{.memory_max_mib = 1}));
}

/// Half of its space is counted, which takes three times as much as log-odds, and may take 3/16 of the limit.
TEST(MapSaver, goes_on_with_no_less_memory_than_its_counts_need) {
    FusedMap map{MapConfig{.memory_max_mib = 64}};
    for (std::uint16_t i = 0; i < 400; ++i) {
        ConeVoxels cone;
        cone.cap = {{{static_cast<std::uint16_t>(32768 + 8 * (i % 20)),
                      static_cast<std::uint16_t>(32768 + 8 * (i / 20)), 32700},
                     1.0F}};
        feed(map, cone, ConeModel{});
    }
    ASSERT_LT(map.memory_bytes(), std::size_t{1} << 20U);
    ASSERT_GT(map.layers().counts.bytes_at_most(), std::size_t{2} << 20U);
    EXPECT_TRUE(why_no_room(map, MapConfig{.memory_max_mib = 8}));
    EXPECT_FALSE(why_no_room(map, MapConfig{.memory_max_mib = 16}));
}

TEST(MapSaver, saves_the_last_map_without_a_copy_of_it) {
    const testing_support::ScratchFolder folder;
    const FusedMap map = some_map(300);
    MapSaver saver(folder.path(), MapSaver::write_map,
                   [](const FusedMap&) -> FusedMap { throw std::bad_alloc(); });
    saver.save_last(map.copy());
    ASSERT_TRUE(saver.finish(kPatience));
    EXPECT_EQ(saver.record().saved, 1U) << saver.record().error;
    const auto loaded = saver.load(mapping_of(MapConfig{}));
    ASSERT_TRUE(loaded && *loaded);
    EXPECT_EQ(encode_ot((*loaded)->map), encode_ot(map));
}

TEST(MapSaver, says_why_it_cannot_save) {
    const testing_support::ScratchFolder folder;
    folder.write("file", "in the way");
    MapSaver saver(folder / "file");
    EXPECT_TRUE(saver.save(some_map(3)));
    ASSERT_TRUE(saver.finish(kPatience));
    EXPECT_EQ(saver.record().failed, 1U);
    EXPECT_NE(saver.record().error.find("file"), std::string::npos);
}

}  // namespace
}  // namespace octoskin
