// The real OpenNI2 on both sides: its recorder through our virtual camera, its playback through our reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <random>
#include <string>
#include <thread>
#include <vector>

#include "host/io/openni2/helpers/oni_check.hpp"
#include "host/io/openni2/helpers/oni_outline.hpp"
#include "host/io/openni2/helpers/oni_records.hpp"
#include "host/io/openni2/oni_reader.hpp"
#include "host/io/openni2/oni_writer.hpp"
#include "tests/support/errors/error_fields.hpp"

namespace octoskin::openni2 {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::what_is;

namespace fs = std::filesystem;

constexpr FrameSize kSize{64, 53};
constexpr int kFrames = 12;

std::vector<std::uint16_t> noisy_frame(int index) {
    std::mt19937 random(static_cast<unsigned>(index));
    std::vector<std::uint16_t> depth(kSize.pixels());
    for (auto& value : depth)
        value = static_cast<std::uint16_t>(random() % 5 == 0 ? 0 : 400 + random() % 4200);
    depth.front() = 32'767;
    depth.back() = 1;
    return depth;
}

HostTime time_of(int index) {
    return HostTime{123'456'789'000'000 + index * 100'003'000LL};
}

class OniTest : public testing::Test {
  protected:
    OniTest() : directory_(fs::path(testing::TempDir()) / ("octoskin_oni_" + std::to_string(::getpid()))) {
        fs::create_directories(directory_);
    }
    ~OniTest() override { fs::remove_all(directory_); }

    [[nodiscard]] fs::path oni() const { return directory_ / "depth.oni"; }
    [[nodiscard]] fs::path epoch() const { return directory_ / "depth.epoch.yaml"; }

    void record() const {
        auto writer = OniWriter::create(oni(), epoch(), kSize);
        ASSERT_TRUE(writer) << writer.error().message();
        for (int i = 0; i < kFrames; ++i) ASSERT_TRUE(writer->write(time_of(i), noisy_frame(i)));
        const auto closed = writer->close();
        ASSERT_TRUE(closed) << closed.error().message();
    }

    /// Frames until the end or an error, which is in `error` then.
    static int count_frames(OniReader& reader, Error& error) {
        for (int frames = 0;; ++frames) {
            const auto frame = reader.next();
            if (!frame) {
                error = frame.error();
                return frames;
            }
            if (!frame->has_value()) return frames;
            EXPECT_EQ((*frame)->depth_mm.size(), kSize.pixels());
        }
    }

    fs::path directory_;
};

TEST_F(OniTest, every_frame_comes_back_with_its_pixels_and_its_time) {
    record();
    auto reader = OniReader::open(oni(), epoch());
    ASSERT_TRUE(reader) << reader.error().message();
    for (int i = 0; i < kFrames; ++i) {
        const auto frame = reader->next();
        ASSERT_TRUE(frame) << frame.error().message();
        ASSERT_TRUE(frame->has_value()) << "frame " << i;
        EXPECT_EQ((*frame)->captured, time_of(i)) << "frame " << i;
        EXPECT_EQ((*frame)->width, 64U);
        EXPECT_EQ((*frame)->height, 53U);
        EXPECT_EQ((*frame)->depth_mm, noisy_frame(i)) << "frame " << i;
    }
    EXPECT_EQ(reader->loss(), std::nullopt);
    for (int again = 0; again < 2; ++again) {
        const auto end = reader->next();
        ASSERT_TRUE(end);
        EXPECT_FALSE(end->has_value());
    }
}

TEST_F(OniTest, depth_that_the_codec_would_spoil_is_stored_as_none) {
    auto writer = OniWriter::create(oni(), epoch(), kSize);
    ASSERT_TRUE(writer);
    std::vector<std::uint16_t> depth(kSize.pixels(), 1000);
    depth[5] = 32'767;
    depth[7] = 32'768;
    depth[6] = 65'535;
    ASSERT_TRUE(writer->write(time_of(0), depth));
    ASSERT_TRUE(writer->close());
    auto reader = OniReader::open(oni(), epoch());
    ASSERT_TRUE(reader);
    const auto frame = reader->next();
    ASSERT_TRUE(frame && frame->has_value());
    EXPECT_EQ((*frame)->depth_mm[4], 1000);
    EXPECT_EQ((*frame)->depth_mm[5], 32'767);
    EXPECT_EQ((*frame)->depth_mm[7], 0);
    EXPECT_EQ((*frame)->depth_mm[6], 0);
}

TEST_F(OniTest, a_truncated_recording_gives_its_whole_frames_and_says_what_is_lost) {
    record();
    std::ifstream whole(oni(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(whole), {}};
    std::mt19937 random(1);
    std::vector<std::size_t> lengths{
        0, 1, 20, 24, 48, 200, bytes.size() / 2, bytes.size() - 28, bytes.size() - 1};
    for (int i = 0; i < 20; ++i) lengths.push_back(random() % bytes.size());
    for (const std::size_t length : lengths) {
        SCOPED_TRACE("cut to " + std::to_string(length) + " of " + std::to_string(bytes.size()) + " bytes");
        std::ofstream(oni(), std::ios::binary) << bytes.substr(0, length);
        const int expected = static_cast<int>(outline_of(oni()).frames);
        const auto start = std::chrono::steady_clock::now();
        auto reader = OniReader::open(oni(), epoch());
        if (expected == 0) {
            ASSERT_FALSE(reader);
            EXPECT_EQ(reader.error().file, oni());
            EXPECT_TRUE(has_its_fields(reader.error()));
            continue;
        }
        ASSERT_TRUE(reader) << reader.error().message();
        for (int i = 0; i < expected; ++i) {
            const auto frame = reader->next();
            ASSERT_TRUE(frame) << frame.error().message();
            ASSERT_TRUE(frame->has_value()) << "frame " << i;
            EXPECT_EQ((*frame)->captured, time_of(i)) << "frame " << i;
            EXPECT_EQ((*frame)->depth_mm, noisy_frame(i)) << "frame " << i;
        }
        const auto end = reader->next();
        ASSERT_TRUE(end) << end.error().message();
        EXPECT_FALSE(end->has_value());
        EXPECT_THAT(reader->loss().value_or(""),
                    testing::HasSubstr("depth.oni: was cut off; " + std::to_string(expected) +
                                       " of its 12 frames are complete and used, " +
                                       std::to_string(kFrames - expected) + " are lost"));
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(6));
    }
}

TEST_F(OniTest, a_damaged_recording_gives_an_error_or_its_frames_in_bounded_time) {
    record();
    std::ifstream whole(oni(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(whole), {}};
    for (unsigned seed = 0; seed < 12; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        std::string damaged = bytes;
        // Half of them in the head, where the sizes are.
        const std::size_t reach = seed % 2 == 0 ? 1000 : damaged.size();
        for (int i = 0; i < 8; ++i) damaged[random() % reach] = static_cast<char>(random());
        std::ofstream(oni(), std::ios::binary) << damaged;
        const auto start = std::chrono::steady_clock::now();
        Error error;
        auto reader = OniReader::open(oni(), epoch());
        if (reader) {
            EXPECT_LE(count_frames(*reader, error), kFrames);
        }
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(6));
    }
}

TEST_F(OniTest, what_would_overflow_the_buffers_of_OpenNI2_is_never_given_to_it) {
    record();
    EXPECT_EQ(fault_of(oni()), std::nullopt);
    OniRecords records(oni());
    auto frame = records.next();
    while (frame && frame->type != OniRecordType::new_data) frame = records.next();
    ASSERT_TRUE(frame);
    // A payload whose size and that of the fields are small together: modulo 2^32.
    const std::uint32_t payload_size = 0U - 16U;
    std::fstream file(oni(), std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(frame->position + 16));
    file.write(reinterpret_cast<const char*>(&payload_size), sizeof(payload_size));
    file.close();
    EXPECT_EQ(fault_of(oni()).value().position, frame->position);
    for (const char* program : {"octoskin-oni-read", "octoskin-camera"}) {
        auto helper = HelperProcess::start(find_helper(program).value(), {oni().string()},
                                           HelperPipe::its_output, HelperComplaints::kept);
        ASSERT_TRUE(helper);
        EXPECT_EQ(helper->wait(std::chrono::seconds(20)), "exit code 65") << program;
    }
}

TEST_F(OniTest, full_size_frames_of_pure_noise_come_back_whole) {
    constexpr FrameSize kFull{512, 424};
    constexpr int kCount = 40;
    const auto frame_of = [&](int index) {
        std::mt19937 random(static_cast<unsigned>(index));
        std::vector<std::uint16_t> depth(kFull.pixels());
        for (auto& value : depth) value = static_cast<std::uint16_t>(random() % 32'768);
        return depth;
    };
    auto writer = OniWriter::create(oni(), epoch(), kFull);
    ASSERT_TRUE(writer) << writer.error().message();
    for (int i = 0; i < kCount; ++i) ASSERT_TRUE(writer->write(time_of(i), frame_of(i)));
    const auto closed = writer->close();
    ASSERT_TRUE(closed) << closed.error().message();
    auto reader = OniReader::open(oni(), epoch());
    ASSERT_TRUE(reader) << reader.error().message();
    for (int i = 0; i < kCount; ++i) {
        const auto frame = reader->next();
        ASSERT_TRUE(frame) << frame.error().message();
        ASSERT_TRUE(frame->has_value()) << "frame " << i;
        ASSERT_EQ((*frame)->captured, time_of(i)) << "frame " << i;
        ASSERT_TRUE((*frame)->depth_mm == frame_of(i)) << "frame " << i;
    }
    EXPECT_FALSE(reader->next()->has_value());
}

TEST_F(OniTest, equal_frames_make_equal_bytes) {
    record();
    std::ifstream first_file(oni(), std::ios::binary);
    const std::string first{std::istreambuf_iterator<char>(first_file), {}};
    record();
    std::ifstream second_file(oni(), std::ios::binary);
    const std::string second{std::istreambuf_iterator<char>(second_file), {}};
    EXPECT_TRUE(first == second);
}

TEST_F(OniTest, a_recording_without_frames_has_an_end_and_no_frames) {
    auto writer = OniWriter::create(oni(), epoch(), kSize);
    ASSERT_TRUE(writer);
    const auto closed = writer->close();
    ASSERT_TRUE(closed) << closed.error().message();
    auto reader = OniReader::open(oni(), epoch());
    ASSERT_TRUE(reader) << reader.error().message();
    const auto end = reader->next();
    ASSERT_TRUE(end) << end.error().message();
    EXPECT_FALSE(end->has_value());
}

TEST_F(OniTest, a_recording_that_cannot_be_created_is_an_error_and_leaves_no_sidecar) {
    auto writer = OniWriter::create(directory_ / "no such folder" / "depth.oni", epoch(), kSize);
    ASSERT_FALSE(writer) << "the file is made before the helper begins";
    EXPECT_THAT(writer.error().file.string(), testing::HasSubstr("no such folder"));
    EXPECT_FALSE(fs::exists(epoch()));
}

/// No file of this process and its helpers grows beyond a size: what a full disk looks like to a writer.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

  private:
    rlimit before_{};
    void (*handler_)(int) = SIG_DFL;
};

TEST_F(OniTest, a_disk_that_fills_up_is_an_error_and_leaves_no_sidecar) {
    const FileSizeLimit room_for_three_frames(30'000);
    auto writer = OniWriter::create(oni(), epoch(), kSize);
    ASSERT_TRUE(writer);
    bool is_written = true;
    for (int i = 0; i < kFrames; ++i) is_written = is_written && writer->write(time_of(i), noisy_frame(i));
    const auto closed = writer->close();
    EXPECT_FALSE(is_written && closed);
    EXPECT_FALSE(fs::exists(epoch()));
}

TEST_F(OniTest, a_writer_whose_helper_ends_early_reports_it_instead_of_dying_of_it) {
    const fs::path ending = directory_ / "ending";
    std::ofstream(ending) << "#!/bin/sh\nexit 3\n";
    fs::permissions(ending, fs::perms::owner_all);
    auto writer = OniWriter::create(oni(), epoch(), kSize, ending);
    bool has_failed = !writer;
    for (int i = 0; i < 500 && !has_failed; ++i) has_failed = !writer->write(time_of(i), noisy_frame(0));
    EXPECT_TRUE(has_failed);
    EXPECT_FALSE(fs::exists(epoch()));
}

TEST_F(OniTest, a_file_that_is_removed_while_it_is_recorded_is_an_error_that_says_so) {
    auto writer = OniWriter::create(oni(), epoch(), kSize);
    ASSERT_TRUE(writer);
    for (int i = 0; i < 2000; ++i) ASSERT_TRUE(writer->write(time_of(i), noisy_frame(i % kFrames)));
    std::jthread remover([this](const std::stop_token& stop) {
        // Not before the recorder is in the middle of its work.
        while (!stop.stop_requested()) {
            std::error_code error;
            const auto size = fs::file_size(oni(), error);
            if (!error && size > 30'000) fs::remove(oni(), error);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    });
    const auto closed = writer->close();
    ASSERT_FALSE(closed);
    EXPECT_EQ(closed.error().file, oni());
    EXPECT_THAT(closed.error(), what_is(HasSubstr("the file was removed during recording")));
    EXPECT_FALSE(fs::exists(epoch()));
}

/// Another who may write to the folder lays a link there before the helper has opened the file.
TEST_F(OniTest, what_takes_the_files_name_meanwhile_is_not_written_to) {
    const fs::path slow = directory_ / "slow";
    const fs::path go = directory_ / "go";
    const fs::path real = fs::read_symlink("/proc/self/exe").parent_path() / "octoskin-oni-write";
    std::ofstream(slow) << "#!/bin/sh\nwhile [ ! -e " << go.string() << " ]; do sleep 0.01; done\nexec "
                        << real.string() << " \"$@\"\n";
    fs::permissions(slow, fs::perms::owner_all);
    const fs::path victim = directory_ / "victim";
    std::ofstream(victim) << "precious";
    auto writer = OniWriter::create(oni(), epoch(), kSize, slow);
    ASSERT_TRUE(writer) << writer.error().message();
    fs::create_symlink(victim, directory_ / "link");
    fs::rename(directory_ / "link", oni());
    std::ofstream(go) << "";
    for (int i = 0; i < 3; ++i) (void)writer->write(time_of(i), noisy_frame(i));
    EXPECT_FALSE(writer->close()) << "its file has no name any more";
    EXPECT_EQ(fs::file_size(victim), 8U);
}

TEST_F(OniTest, pictures_too_large_for_OpenNI2_are_refused) {
    const auto writer = OniWriter::create(oni(), epoch(), {2000, 1200});
    ASSERT_FALSE(writer);
    EXPECT_THAT(writer.error(), AllOf(code_is(ErrorCode::limit_exceeded), what_is(HasSubstr("2000 x 1200"))));
}

TEST_F(OniTest, an_error_stays_the_answer) {
    record();
    ASSERT_TRUE(write_epoch(epoch(), {.first_frame = time_of(0), .frames = kFrames + 1}));
    auto reader = OniReader::open(oni(), epoch());
    ASSERT_TRUE(reader);
    Error error, again;
    count_frames(*reader, error);
    EXPECT_EQ(count_frames(*reader, again), 0);
    EXPECT_EQ(again.code, error.code);
    EXPECT_EQ(again.message(), error.message());
}

TEST_F(OniTest, a_file_that_is_no_recording_is_named) {
    std::ofstream(epoch()) << "schema: octoskin-depth-epoch/1\nfirst_frame_us: 5\nframes: 1\n";
    std::ofstream(oni()) << "this is not a recording";
    const auto reader = OniReader::open(oni(), epoch());
    ASSERT_FALSE(reader);
    EXPECT_THAT(reader.error(), AllOf(code_is(ErrorCode::foreign_format), file_is("depth.oni"),
                                      what_is(HasSubstr("not a recording"))));
}

TEST_F(OniTest, a_helper_that_crashes_is_a_camera_fault_and_nothing_more) {
    record();
    const fs::path crashing = directory_ / "crashing";
    std::ofstream(crashing) << "#!/bin/sh\nkill -SEGV $$\n";
    fs::permissions(crashing, fs::perms::owner_all);
    const auto reader = OniReader::open(oni(), epoch(), crashing);
    ASSERT_FALSE(reader);
    EXPECT_THAT(reader.error(), what_is(HasSubstr("signal 11")));
}

TEST_F(OniTest, a_sidecar_that_promises_more_frames_is_an_error_after_the_last_one) {
    record();
    ASSERT_TRUE(write_epoch(epoch(), {.first_frame = time_of(0), .frames = kFrames + 1}));
    auto reader = OniReader::open(oni(), epoch());
    ASSERT_TRUE(reader);
    Error error;
    EXPECT_EQ(count_frames(*reader, error), kFrames);
    EXPECT_THAT(error, AllOf(code_is(ErrorCode::damaged), file_is("depth.oni"),
                             what_is(HasSubstr("after 12 of 13 frames"))));
}

TEST_F(OniTest, every_broken_sidecar_is_named) {
    record();
    for (const char* text :
         {"", "schema: other\n", "schema: octoskin-depth-epoch/1\nfirst_frame_us: -1\nframes: 1\n",
          "schema: octoskin-depth-epoch/1\nfirst_frame_us: soon\nframes: 1\n",
          "schema: octoskin-depth-epoch/1\nfirst_frame_us: 1\n",
          "schema: octoskin-depth-epoch/1\nfirst_frame_us: 1\nframes: 1\nfps: 10\n", "[", "a: [\n"}) {
        std::ofstream(epoch()) << text;
        const auto reader = OniReader::open(oni(), epoch());
        ASSERT_FALSE(reader) << text;
        EXPECT_EQ(reader.error().file, epoch()) << text;
        EXPECT_TRUE(has_its_fields(reader.error())) << text;
    }
    fs::remove(epoch());
    EXPECT_THAT(OniReader::open(oni(), epoch()).error(),
                AllOf(code_is(ErrorCode::not_found), file_is("depth.epoch.yaml")));
}

}  // namespace
}  // namespace octoskin::openni2
