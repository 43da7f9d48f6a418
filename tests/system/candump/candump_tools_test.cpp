// can-utils as an independent reader of our logs: log2asc translates each line into Vector's ASC format.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "host/io/candump/log_writer.hpp"

namespace octoskin::candump {
namespace {

class CandumpTools : public testing::Test {
  protected:
    void SetUp() override {
        if (std::system("command -v log2asc >/dev/null") != 0) {
            GTEST_SKIP() << "log2asc is not installed (Debian package can-utils)";
        }
        directory_ = std::filesystem::temp_directory_path() / ("candump-tools-" + std::to_string(::getpid()));
        std::filesystem::create_directories(directory_);
    }
    void TearDown() override {
        if (!directory_.empty()) {
            std::filesystem::remove_all(directory_);
        }
    }

    /// The lines that log2asc makes of frames 1 ms apart, without its three header lines, blanks squeezed.
    [[nodiscard]] std::vector<std::string> translate(const std::vector<wire::CanFrame>& frames) const {
        const auto log = directory_ / "can.log";
        const auto asc = directory_ / "can.asc";
        auto writer = LogWriter::create(log, "can0");
        EXPECT_TRUE(writer.has_value());
        std::int64_t stamp_ns = 1'700'000'000'000'000'000;
        for (const wire::CanFrame& frame : frames) {
            EXPECT_TRUE(writer->write({stamp_ns}, frame).has_value());
            stamp_ns += 1'000'000;
        }
        EXPECT_TRUE(writer->close().has_value());
        const std::string command = "log2asc -I '" + log.string() + "' can0 -O '" + asc.string() + "'";
        EXPECT_EQ(std::system(command.c_str()), 0);
        std::vector<std::string> lines;
        std::ifstream stream(asc);
        for (std::string line; std::getline(stream, line);) {
            lines.push_back(squeezed(line));
        }
        EXPECT_GE(lines.size(), 3U);
        lines.erase(lines.begin(),
                    lines.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(3, lines.size())));
        return lines;
    }

  private:
    [[nodiscard]] static std::string squeezed(const std::string& line) {
        std::string result;
        for (const char c : line) {
            const bool is_blank = c == ' ' || c == '\r';
            if (!is_blank || (!result.empty() && result.back() != ' ')) {
                result.push_back(is_blank ? ' ' : c);
            }
        }
        while (!result.empty() && result.back() == ' ') {
            result.pop_back();
        }
        return result;
    }
    std::filesystem::path directory_;
};

TEST_F(CandumpTools, read_every_kind_of_frame_as_it_was_written) {
    const std::vector<wire::CanFrame> frames = {
        {.can_id = 0x44, .payload_len = 5, .data = {0x2A, 0x36, 0x6C, 0x2B, 0xBA}},
        {.can_id = 0x7FF},
        {.can_id = 0x44, .is_remote = true, .payload_len = 4},
        {.can_id = 0x44, .is_extended = true, .payload_len = 2, .data = {1, 2}},
        {.can_id = 4, .is_error = true, .payload_len = 8},
        {.can_id = 0x250,
         .is_fd = true,
         .has_bit_rate_switch = true,
         .payload_len = 12,
         .data = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}},
    };
    const std::vector<std::string> lines = translate(frames);
    ASSERT_EQ(lines.size(), 6U);
    EXPECT_EQ(lines[0], "0.000000 1 44 Rx d 5 2A 36 6C 2B BA");
    EXPECT_EQ(lines[1], "0.001000 1 7FF Rx d 0");
    EXPECT_EQ(lines[2], "0.002000 1 44 Rx r 4");
    EXPECT_EQ(lines[3], "0.003000 1 44x Rx d 2 01 02");
    EXPECT_EQ(lines[4], "0.004000 1 ErrorFrame");
    EXPECT_TRUE(lines[5].starts_with("0.005000 CANFD 1 Rx 250 1 0 9 12 00 01 02 03 04 05 06 07 08 09 0A 0B "))
        << lines[5];
}

TEST_F(CandumpTools, read_as_many_frames_as_were_written) {
    std::vector<wire::CanFrame> frames;
    for (std::uint32_t i = 0; i < 2'000; ++i) {
        frames.push_back({.can_id = i % 0x800, .payload_len = static_cast<std::uint8_t>(i % 9)});
    }
    EXPECT_EQ(translate(frames).size(), 2'000U);
}

}  // namespace
}  // namespace octoskin::candump
