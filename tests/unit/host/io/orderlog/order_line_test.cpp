#include "host/io/orderlog/order_line.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <limits>
#include <random>

#include "host/io/orderlog/order_reader.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {

// Only for these tests: in the product two samples are never compared.
static bool operator==(const JointMeasurement& a, const JointMeasurement& b) {
    return a.sampled == b.sampled && a.position_rad == b.position_rad;
}
static bool operator==(const RangeMeasurement& a, const RangeMeasurement& b) {
    return a.source == b.source && a.captured == b.captured && a.range_m == b.range_m &&
           a.sigma_m == b.sigma_m;
}

namespace orderlog {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::line_is;
using testing_support::value_is;
using testing_support::what_is;

std::string without_feed(std::string line) {
    EXPECT_TRUE(line.ends_with('\n'));
    line.pop_back();
    return line;
}

std::vector<std::string> sound_lines() {
    return {"octoskin-order/1 rig 1a2b3c4d mapping 00000001 joints 2 first 1a2b3c4d",
            "octoskin-order/1 rig 1a2b3c4d mapping 00000001 joints 2 first -",
            "octoskin-order/2 rig 1a2b3c4d mapping 00000001 joints 2 first - state 1a2b3c4d",
            "W 12",
            "J 71000000000 0.1 -0.25",
            "R 2 3 0 71003000000 0.734 0.021",
            "R 2 3 0 71003000000 - 0",
            "D 12 71010000000",
            "D - 71010000000",
            "end commits 3 lost_can 0 lost_commits 0 lost_depth 1 last 1a2b3c4d"};
}

const CommitForm kTwo{.joints = {2}};
const CommitForm kSeven{.joints = {7}};

bool is_any(std::string_view line) {
    return parse_header(line) || parse_commit(line, kTwo) || parse_trailer(line);
}

TEST(OrderLine, says_what_the_documentation_shows) {
    JointMeasurement joints{{71'000'000'000}, {}};
    joints.position_rad[0] = 0.1;
    joints.position_rad[1] = -0.25;
    EXPECT_EQ(format_commit(joints, kTwo), "J 71000000000 0.1 -0.25\n");
    EXPECT_EQ(format_commit(RangeMeasurement{{2, 3, 0}, {71'003'000'000}, 0.734, 0.021}, kTwo),
              "R 2 3 0 71003000000 0.734 0.021\n");
    EXPECT_EQ(format_commit(RangeMeasurement{{2, 3, 0}, {71'003'000'000}, std::nullopt, 0.0}, kTwo),
              "R 2 3 0 71003000000 - 0\n");
    EXPECT_EQ(format_commit(DepthCommit{12, {71'010'000'000}}, kTwo), "D 12 71010000000\n");
    EXPECT_EQ(format_header({0x1a2b3c4d, 1, kTwo, std::nullopt}),
              "octoskin-order/1 rig 1a2b3c4d mapping 00000001 joints 2 first -\n");
    EXPECT_EQ(format_header({0x1a2b3c4d, 1, kTwo, std::nullopt, 0xAU}),
              "octoskin-order/2 rig 1a2b3c4d mapping 00000001 joints 2 first - state 0000000a\n");
    EXPECT_EQ(parse_header("octoskin-order/2 rig 1a2b3c4d mapping 00000001 joints 2 first - state 0000000a"),
              (Header{0x1a2b3c4d, 1, kTwo, std::nullopt, 0xAU}));
    EXPECT_EQ(format_commit(WaitCommit{12}, kTwo), "W 12\n");
    EXPECT_EQ(parse_commit("W 12", kTwo), Commit(WaitCommit{12}));
    EXPECT_EQ(format_trailer({3, 0, 0, 1, 0x1a2b3c4dU}),
              "end commits 3 lost_can 0 lost_commits 0 lost_depth 1 last 1a2b3c4d\n");
    for (const std::string& line : sound_lines()) EXPECT_TRUE(is_any(line)) << line;
}

TEST(OrderLine, names_the_source_of_a_joint_sample_of_several) {
    const CommitForm kArmAndGripper{.joints = {2, 1}};
    const JointMeasurement arm{.sampled = {71}, .position_rad = {0.1, -0.25}};
    const JointMeasurement gripper{.sampled = {72}, .position_rad = {0.5}, .source = 1};
    EXPECT_EQ(format_commit(arm, kArmAndGripper), "J 0 71 0.1 -0.25\n");
    EXPECT_EQ(format_commit(gripper, kArmAndGripper), "J 1 72 0.5\n");
    EXPECT_EQ(parse_commit("J 0 71 0.1 -0.25", kArmAndGripper), Commit(arm));
    EXPECT_EQ(parse_commit("J 1 72 0.5", kArmAndGripper), Commit(gripper));
    for (const char* line : {"J 2 72 0.5", "J 1 72 0.5 0.5", "J 0 72 0.5", "J 71 0.1 -0.25", "J -1 72 0.5"})
        EXPECT_FALSE(parse_commit(line, kArmAndGripper)) << line;
    const Header header{0x1a2b3c4d, 1, kArmAndGripper, std::nullopt, 0xAU};
    EXPECT_EQ(format_header(header),
              "octoskin-order/2 rig 1a2b3c4d mapping 00000001 joints 2+1 first - state 0000000a\n");
    EXPECT_EQ(parse_header(without_feed(format_header(header))), header);
    for (const char* joints : {"0", "8", "2+", "+2", "2+0", "7+7+7+7+5", "2-1", ""})
        EXPECT_FALSE(parse_header(fmt::format(
            "octoskin-order/2 rig 1a2b3c4d mapping 00000001 joints {} first - state 0000000a", joints)))
            << joints;
}

TEST(OrderLine, names_the_camera_of_a_depth_frame_of_several) {
    const CommitForm two_cameras{.joints = {2}, .cameras = 2};
    const DepthCommit frame{.index = 12, .captured = {71}, .camera = 1};
    const DepthCommit unrecorded{.index = {}, .captured = {72}, .camera = 0};
    EXPECT_EQ(format_commit(frame, two_cameras), "D 1 12 71\n");
    EXPECT_EQ(format_commit(unrecorded, two_cameras), "D 0 - 72\n");
    EXPECT_EQ(parse_commit("D 1 12 71", two_cameras), Commit(frame));
    EXPECT_EQ(parse_commit("D 0 - 72", two_cameras), Commit(unrecorded));
    for (const char* line : {"D 2 12 71", "D 12 71", "D - 71", "D -1 12 71", "D 1 12 71 0", "D - 12 71"})
        EXPECT_FALSE(parse_commit(line, two_cameras)) << line;
    EXPECT_FALSE(parse_commit("D 1 12 71", kTwo));
    const Header header{0x1a2b3c4d, 1, two_cameras, std::nullopt, 0xAU};
    EXPECT_EQ(format_header(header),
              "octoskin-order/2 rig 1a2b3c4d mapping 00000001 joints 2 cameras 2 first - state 0000000a\n");
    EXPECT_EQ(parse_header(without_feed(format_header(header))), header);
    for (const char* cameras : {"0", "9", "-1", "1.5", ""})
        EXPECT_FALSE(parse_header(fmt::format(
            "octoskin-order/2 rig 1a2b3c4d mapping 00000001 joints 2 cameras {} first - state 0000000a",
            cameras)))
            << cameras;
}

TEST(OrderLine, gives_every_double_back_bit_for_bit) {
    std::mt19937_64 random(20);
    for (int i = 0; i < 20'000; ++i) {
        double value = 0.0;
        const std::uint64_t bits = random();
        std::memcpy(&value, &bits, sizeof(value));
        if (!std::isfinite(value)) continue;
        const RangeMeasurement reading{{1, 2, 3}, {static_cast<std::int64_t>(bits >> 2U)}, value, -value};
        const auto again = parse_commit(without_feed(format_commit(reading, kTwo)), kTwo);
        ASSERT_TRUE(again) << "seed 20, value " << value;
        EXPECT_EQ(std::get<RangeMeasurement>(*again), reading) << "seed 20, value " << value;
        JointMeasurement joints{reading.captured, {value, -value, 0.0, value, 1.0, 2.0, 3.0}};
        const auto sample = parse_commit(without_feed(format_commit(joints, kSeven)), kSeven);
        ASSERT_TRUE(sample);
        EXPECT_EQ(std::get<JointMeasurement>(*sample), joints);
    }
}

TEST(OrderLine, refuses_every_line_that_was_cut_or_lengthened) {
    for (const std::string& line : sound_lines()) {
        const std::size_t last_word = line.rfind(' ');
        for (std::size_t length = 0; length <= last_word; ++length) {
            EXPECT_FALSE(is_any(line.substr(0, length))) << line.substr(0, length);
        }
        for (const char* more : {" ", " 0", "x", "  "}) EXPECT_FALSE(is_any(line + more)) << line << more;
        EXPECT_FALSE(is_any(" " + line));
    }
}

TEST(OrderLine, refuses_what_is_no_number_of_the_field) {
    for (const char* line : {"J 71 nan 0",
                             "J 71 inf 0",
                             "J -1 0 0",
                             "J 9223372036854775807 0 0",
                             "J 71 0",
                             "R 256 0 0 71 1 0",
                             "R 1 0 0 71 nan 0",
                             "R 1 0 0 71 1 inf",
                             "R -1 0 0 71 1 0",
                             "R 1 0 0 71 1e400 0",
                             "D -1 71",
                             "D 1.5 71",
                             "D 0x1 71",
                             "X 1 71",
                             "W -1",
                             "W 1.5",
                             "W 9223372036854775807",
                             "W",
                             "octoskin-order/1 rig 1a2b3c4d mapping 00000001 joints 2 first - state 1a2b3c4d",
                             "octoskin-order/2 rig 1a2b3c4d mapping 00000001 joints 2 first - state -",
                             "octoskin-order/2 rig 1a2b3c4d mapping 00000001 joints 2 first -",
                             "octoskin-order/1 rig 1a2b3c4d mapping 00000001 joints 8 first -",
                             "octoskin-order/1 rig 1a2b3c4d mapping 00000001 joints 0 first -",
                             "octoskin-order/1 rig 1a2b mapping 00000001 joints 2 first -"}) {
        EXPECT_FALSE(is_any(line)) << line;
    }
}

class OrderFile : public testing::Test {
  protected:
    static constexpr const char* kBegin = "octoskin-order/1 rig 1a2b3c4d mapping 00000001 joints 1 first -\n";
    static constexpr const char* kEnd = "end commits 2 lost_can 0 lost_commits 0 lost_depth 0 last -\n";
    /// The number of commits; an error is in error_.
    std::string read(const std::string& text) {
        const auto file = folder_.write("order.log", text);
        auto reader = OrderReader::open(file);
        error_ = error_in(reader);
        if (!reader) return "refused";
        for (int count = 0;; ++count) {
            const auto commit = reader->next();
            error_ = error_in(commit);
            if (!commit) return "refused";
            if (!*commit) return std::to_string(count) + (reader->trailer() ? " whole" : " cut off");
        }
    }
    Error error_of(const std::string& text) {
        EXPECT_EQ(read(text), "refused");
        EXPECT_EQ(error_.file, folder_ / "order.log");
        EXPECT_TRUE(has_its_fields(error_));
        return error_;
    }

    Error error_;
    testing_support::ScratchFolder folder_;
};

TEST_F(OrderFile, is_read_to_its_end) {
    EXPECT_EQ(read(std::string(kBegin) + "J 1 0\n# a remark\nD 0 2\n" + kEnd), "2 whole");
}

TEST_F(OrderFile, of_a_daemon_that_was_killed_has_its_whole_lines) {
    EXPECT_EQ(read(std::string(kBegin) + "J 1 0\nD 0 2\n"), "2 cut off");
    EXPECT_EQ(read(std::string(kBegin) + "J 1 0\nD 0 2"), "1 cut off");
    EXPECT_EQ(read(kBegin), "0 cut off");
}

TEST_F(OrderFile, with_a_mistake_is_named_with_its_line) {
    const std::string file = (folder_ / "order.log").string();
    EXPECT_THAT(error_of(std::string(kBegin) + "J 1 0\nhello\n" + kEnd),
                AllOf(code_is(ErrorCode::bad_syntax), line_is(3), value_is("'hello'")));
    for (const char* reading : {"R 1 0 0 71 8.1 0.02", "R 1 0 0 71 1 1.1", "R 1 0 0 71 -1 0.02"}) {
        EXPECT_THAT(
            error_of(std::string(kBegin) + reading + "\n" + kEnd),
            AllOf(code_is(ErrorCode::out_of_range), line_is(2), value_is("'" + std::string(reading) + "'")));
    }
    EXPECT_EQ(read(std::string(kBegin) + "R 1 0 0 71 8 1\nR 1 0 0 72 - 60\n" + kEnd), "2 whole");
    EXPECT_THAT(error_of(std::string(kBegin) + "J 1 0\n" + kEnd),
                AllOf(code_is(ErrorCode::damaged), line_is(3),
                      what_is(AllOf(HasSubstr("2 commits"), HasSubstr("the 0 that"))), value_is("1")));
    EXPECT_THAT(error_of(std::string(kBegin) + "J 1 0\nD 0 2\n" + kEnd + "J 3 0\n"),
                AllOf(code_is(ErrorCode::damaged), line_is(5), what_is(HasSubstr("after the end"))));
    for (const std::string& text :
         {std::string("octoskin-order/9\n"), std::string(), std::string(100'000, 'x')})
        EXPECT_THAT(error_of(text), AllOf(code_is(ErrorCode::foreign_format), line_is(1)));
    std::filesystem::remove(file);
    EXPECT_THAT(OrderReader::open(file).error(), AllOf(code_is(ErrorCode::not_found), file_is("order.log")));
    ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
    EXPECT_THAT(OrderReader::open(file).error(),
                AllOf(code_is(ErrorCode::wrong_kind_of_file), what_is(HasSubstr("a named pipe"))));
}

}  // namespace
}  // namespace orderlog
}  // namespace octoskin
