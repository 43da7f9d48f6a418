#include "host/apps/daemon/recording_writer.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <new>
#include <thread>

#include "host/io/mapfile/map_file.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

constexpr Nanoseconds kPatience{10'000'000'000};

/// Files may grow no further than this while it lives: a full disk for this process.
class SmallDisk {
  public:
    explicit SmallDisk(rlim_t bytes) {
        before_ = std::signal(SIGXFSZ, SIG_IGN);
        ::getrlimit(RLIMIT_FSIZE, &limit_);
        const rlimit small{bytes, limit_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &small);
    }
    ~SmallDisk() {
        ::setrlimit(RLIMIT_FSIZE, &limit_);
        std::signal(SIGXFSZ, before_);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

  private:
    rlimit limit_{};
    void (*before_)(int) = nullptr;
};

class RecordingWriterTest : public testing::Test {
  protected:
    RecordingBegin begin() const {
        return {
            .paths = RecordingPaths(folder_ / "recording"),
            .rig = "rig text\n",
            .robot = "robot text\n",
            .mapping = "mapping text\n",
            .order = {.rig_hash = 1, .mapping_crc32 = 2, .form = {.joints = {1}}, .first_map = std::nullopt},
            .first = {FusedMap(MapConfig{}), {}},
            .cameras = {""}};
    }
    static RecordingEnd end(std::uint64_t commits) {
        RecordingMeta meta;
        meta.source = "robot";
        FusedMap map{MapConfig{}};
        const VoxelUpdate update{*map.key_of({0.1, 0.2, 0.3}), 1.0F};
        feed(map, {&update, 1});
        orderlog::Trailer trailer;
        trailer.commits = commits;
        return {.order = trailer, .remarks = "# none\n", .meta = meta, .last_map = std::move(map)};
    }
    std::string read(const std::string& name) const {
        return testing_support::ScratchFolder::read(folder_ / ("recording/" + name));
    }
    void expect_error(const RecordingWriter& writer, ErrorCode code, const std::string& file) const {
        const auto error = writer.error();
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code, code) << error->message();
        EXPECT_EQ(error->file, folder_ / file) << error->message();
    }
    testing_support::ScratchFolder folder_;
};

TEST_F(RecordingWriterTest, ends_with_an_error_where_its_folder_or_a_file_of_it_is_removed) {
    for (const char* const gone : {"recording", "recording/can.log", "recording/order.log"}) {
        std::filesystem::remove_all(folder_ / "recording");
        RecordingWriter writer(begin());
        ASSERT_FALSE(writer.refusal(kPatience));
        while (!std::filesystem::exists(folder_ / "recording/order.log")) std::this_thread::yield();
        std::filesystem::remove_all(folder_ / gone);
        EXPECT_TRUE(writer.wait(Nanoseconds{5'000'000'000})) << gone << ": by itself";
        expect_error(writer, ErrorCode::not_found, gone);
    }
}

TEST_F(RecordingWriterTest, is_not_complete_where_its_folder_is_removed_just_before_its_end) {
    RecordingWriter writer(begin());
    ASSERT_FALSE(writer.refusal(kPatience));
    while (!std::filesystem::exists(folder_ / "recording/order.log")) std::this_thread::yield();
    std::filesystem::remove_all(folder_ / "recording");
    writer.finish(end(0));
    ASSERT_TRUE(writer.wait(kPatience));
    ASSERT_TRUE(writer.error());
    EXPECT_EQ(writer.error()->code, ErrorCode::not_found) << writer.error()->message();
}

TEST_F(RecordingWriterTest, goes_on_in_a_folder_that_is_moved) {
    RecordingWriter writer(begin());
    ASSERT_FALSE(writer.refusal(kPatience));
    std::filesystem::rename(folder_ / "recording", folder_ / "moved");
    std::this_thread::sleep_for(std::chrono::milliseconds{1'500});
    writer.finish(end(0));
    ASSERT_TRUE(writer.wait(kPatience));
    EXPECT_FALSE(writer.error()) << writer.error()->message();
    EXPECT_TRUE(std::filesystem::exists(folder_ / "moved/meta.yaml"));
}

/// Depth frames come from the first moment on, before anybody has looked at the folder.
TEST_F(RecordingWriterTest, leaves_alone_what_is_in_a_folder_that_it_refuses) {
    std::filesystem::create_directories(folder_ / "recording");
    for (const char* const name : {"depth.oni", "depth.epoch.yaml"})
        folder_.write(std::string("recording/") + name, "somebody's own");
    DepthFrame frame;
    frame.width = frame.height = 8;
    frame.depth_mm.assign(64, 1'000);
    for (int round = 0; round < 10; ++round) {
        RecordingWriter writer(begin());
        (void)writer.add_depth(frame);
        ASSERT_TRUE(writer.wait(kPatience));
        expect_error(writer, ErrorCode::already_exists, "recording");
    }
    EXPECT_EQ(read("depth.oni"), "somebody's own");
    EXPECT_EQ(read("depth.epoch.yaml"), "somebody's own");
}

TEST_F(RecordingWriterTest, writes_what_came_before_the_end_and_vouches_for_it_last) {
    RecordingWriter writer(begin());
    ASSERT_TRUE(writer.add_can("(1.000000) can0 001#\n"));
    ASSERT_TRUE(writer.add_order("J 1 0\n"));
    EXPECT_FALSE(writer.has_ended());
    EXPECT_FALSE(std::filesystem::exists(folder_ / "recording/meta.yaml"));
    writer.finish(end(1));
    ASSERT_TRUE(writer.wait(kPatience));
    EXPECT_FALSE(writer.error()) << writer.error()->message();
    EXPECT_EQ(read("rig.yaml"), "rig text\n");
    EXPECT_EQ(read("robot.urdf"), "robot text\n");
    EXPECT_EQ(read("mapping.yaml"), "mapping text\n");
    EXPECT_EQ(read("can.log"), "(1.000000) can0 001#\n");
    const auto crc = crc32_of(folder_ / "recording/last.ot");
    ASSERT_TRUE(crc);
    orderlog::Header header = begin().order;
    header.first_state = crc32_of(folder_ / "recording/first.snapshot");
    ASSERT_TRUE(header.first_state);
    EXPECT_EQ(read("order.log"), orderlog::format_header(header) + "J 1 0\n# none\n" +
                                     orderlog::format_trailer({1, 0, 0, 0, crc}));
    EXPECT_TRUE(read_meta(RecordingPaths(folder_ / "recording")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "recording/first.ot")) << "of an empty map";
    EXPECT_FALSE(std::filesystem::exists(folder_ / "recording/depth.oni")) << "without a frame";
}

TEST_F(RecordingWriterTest, names_the_file_that_a_full_disk_stops_and_vouches_for_nothing) {
    const SmallDisk disk(64 << 10U);
    RecordingWriter writer(begin());
    ASSERT_TRUE(writer.add_order(std::string(100'000, '#') + "\n"));
    ASSERT_TRUE(writer.wait(kPatience)) << "goes on in spite of it";
    expect_error(writer, ErrorCode::system_error, "recording/order.log");
    EXPECT_EQ(writer.error()->what, "File too large");
    writer.finish(end(0));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "recording/meta.yaml"));
}

TEST_F(RecordingWriterTest, takes_nothing_that_has_no_room_and_never_waits) {
    (void)folder_.write("recording", "in the way");  // so that nothing is ever written
    RecordingWriter writer(begin());
    const std::string line(1U << 20U, 'x');
    int taken = 0;
    for (int i = 0; i < 20; ++i) taken += writer.add_can(line) ? 1 : 0;
    EXPECT_EQ(taken, 8);
    ASSERT_TRUE(writer.wait(kPatience));
    expect_error(writer, ErrorCode::already_exists, "recording");
}

/// A disk that takes no map until a test lets it, and then fails.
class HungDisk {
  public:
    [[nodiscard]] RecordingWriter::MapWriter writer() {
        return [this](const FusedMap&, const FilePlace&) -> Result<std::uint32_t, Error> {
            std::unique_lock lock(mutex_);
            is_writing_ = true;
            changed_.notify_all();
            changed_.wait(lock, [this] { return is_open_; });
            is_writing_ = false;
            changed_.notify_all();
            return unexpected(Error{ErrorCode::system_error, "the disk was gone"});
        };
    }
    void wait_for_write() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return is_writing_; });
    }
    void open() {
        std::unique_lock lock(mutex_);
        is_open_ = true;
        changed_.notify_all();
        changed_.wait(lock, [this] { return !is_writing_; });
    }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_writing_ = false;
    bool is_open_ = false;
};

TEST_F(RecordingWriterTest, is_left_behind_by_its_end_when_the_disk_hangs) {
    static HungDisk& disk = *new HungDisk;  // what was left behind may outlive the test
    std::optional<RecordingWriter> writer;
    writer.emplace(begin(), disk.writer());
    writer->finish(end(0));
    disk.wait_for_write();
    EXPECT_FALSE(writer->wait(Nanoseconds{10'000'000}));
    const auto begun = std::chrono::steady_clock::now();
    writer.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(1));
    disk.open();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // it ends before its folder goes
}

TEST_F(RecordingWriterTest, tells_since_when_it_is_writing) {
    HungDisk disk;
    RecordingWriter writer(begin(), disk.writer());
    for (int i = 0; i < 1000 && writer.writing_since(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{5});
    EXPECT_FALSE(writer.writing_since()) << "it waits for what comes";
    writer.finish(end(1));
    disk.wait_for_write();
    const auto since = writer.writing_since();
    EXPECT_TRUE(since);
    EXPECT_FALSE(writer.wait(Nanoseconds{50'000'000}));
    EXPECT_EQ(writer.writing_since(), since);
    disk.open();
    ASSERT_TRUE(writer.wait(kPatience));
    EXPECT_FALSE(writer.writing_since());
}

TEST_F(RecordingWriterTest, names_what_was_thrown_while_it_wrote) {
    RecordingWriter writer(begin(), [](const FusedMap&, const FilePlace&) -> Result<std::uint32_t, Error> {
        throw std::bad_alloc();
    });
    writer.finish(end(0));
    ASSERT_TRUE(writer.wait(kPatience));
    expect_error(writer, ErrorCode::no_resources, "recording");
}

TEST_F(RecordingWriterTest, leaves_the_files_of_others_alone) {
    std::filesystem::create_directory(folder_ / "recording");
    (void)folder_.write("recording/can.log", "precious");
    RecordingWriter writer(begin());
    ASSERT_TRUE(writer.wait(kPatience));
    expect_error(writer, ErrorCode::already_exists, "recording");
    EXPECT_EQ(read("can.log"), "precious");
}

}  // namespace
}  // namespace octoskin
