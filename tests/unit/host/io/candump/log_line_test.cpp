// Lines are literal, in the format that can-utils 2020.11 writes; expected values are read off by eye.
#include "host/io/candump/log_line.hpp"

#include <gmock/gmock.h>

#include <random>
#include <string>

namespace octoskin::candump {
namespace {

const std::string kHead = "(1436509053.850870) vcan0 ";

LogEntry good(const std::string& line) {
    const auto entry = parse_line(line);
    EXPECT_TRUE(entry.has_value()) << line;
    return entry ? *entry : LogEntry{};
}

void expect_fault(LineFault fault, const std::string& line) {
    const auto entry = parse_line(line);
    ASSERT_FALSE(entry.has_value()) << line;
    EXPECT_EQ(static_cast<int>(entry.error()), static_cast<int>(fault)) << line;
}

TEST(LogLine, reads_a_classical_frame) {
    const LogEntry entry = good("(1436509053.850870) vcan0 044#2A366C2BBA");
    EXPECT_EQ(entry.stamp.ns, 1'436'509'053'850'870'000);
    EXPECT_EQ(entry.interface, "vcan0");
    EXPECT_EQ(entry.frame.can_id, 0x44U);
    EXPECT_FALSE(entry.frame.is_extended || entry.frame.is_remote || entry.frame.is_error ||
                 entry.frame.is_fd);
    EXPECT_THAT(entry.frame.payload(), testing::ElementsAre(0x2A, 0x36, 0x6C, 0x2B, 0xBA));
}

TEST(LogLine, tells_standard_extended_remote_error_and_fd_frames_apart) {
    EXPECT_EQ(good(kHead + "7FF#").frame, (wire::CanFrame{.can_id = 0x7FF}));
    EXPECT_EQ(good(kHead + "000007FF#").frame, (wire::CanFrame{.can_id = 0x7FF, .is_extended = true}));
    EXPECT_EQ(good(kHead + "1FFFFFFF#").frame, (wire::CanFrame{.can_id = 0x1FFFFFFF, .is_extended = true}));
    EXPECT_EQ(good(kHead + "20000004#").frame, (wire::CanFrame{.can_id = 4, .is_error = true}));
    EXPECT_EQ(good(kHead + "044#R").frame, (wire::CanFrame{.can_id = 0x44, .is_remote = true}));
    EXPECT_EQ(good(kHead + "044#R8").frame,
              (wire::CanFrame{.can_id = 0x44, .is_remote = true, .payload_len = 8}));
    EXPECT_EQ(good(kHead + "044##0").frame, (wire::CanFrame{.can_id = 0x44, .is_fd = true}));
    EXPECT_EQ(
        good(kHead + "044##5AB").frame,
        (wire::CanFrame{
            .can_id = 0x44, .is_fd = true, .has_bit_rate_switch = true, .payload_len = 1, .data = {0xAB}}));
}

TEST(LogLine, takes_nanoseconds_a_direction_mark_and_a_carriage_return) {
    EXPECT_EQ(good("(1.000000999) can0 044#").stamp.ns, 1'000'000'000);
    EXPECT_EQ(good("(0000000000.000001) can0 044#").stamp.ns, 1'000);
    EXPECT_EQ(good(kHead + "044#11 R\r").frame.payload_len, 1);
    EXPECT_EQ(good(kHead + "044#11 T").frame.payload_len, 1);
}

TEST(LogLine, takes_what_candump_shows_on_a_screen) {
    const wire::CanFrame five{.can_id = 0x44, .payload_len = 5, .data = {0x2A, 0x36, 0x6C, 0x2B, 0xBA}};
    for (const char* shown :
         {" (1436509053.850870)  vcan0  044   [5]  2A 36 6C 2B BA",
          " (1436509053.850870)  vcan0  044   {5}  2A 36 6C 2B BA",
          " (1436509053.850870)  vcan0       044   [5]  2A 36 6C 2B BA",
          "(1436509053.850870)\tvcan0\t044\t[5]\t2A 36 6C 2B BA\r",
          " (1436509053.850870)  vcan0  RX - -  044   [5]  2A 36 6C 2B BA",
          " (1436509053.850870)  vcan0  TX - -  044   [5]  2A 36 6C 2B BA",
          " (1436509053.850870)  vcan0  044   [5]  2A 36 6C 2B BA            '*6l+.'",
          " \x1B[31m(1436509053.850870)  \x1B[32mvcan0\x1B[0m  044   [5]  2A 36 6C 2B BA\x1B[0m"}) {
        const LogEntry entry = good(shown);
        EXPECT_EQ(entry.stamp.ns, 1'436'509'053'850'870'000) << shown;
        EXPECT_EQ(entry.interface, "vcan0") << shown;
        EXPECT_EQ(entry.frame, five) << shown;
    }
    EXPECT_EQ(good(kHead + " 12345678   [1]  2A").frame,
              (wire::CanFrame{.can_id = 0x12345678, .is_extended = true, .payload_len = 1, .data = {0x2A}}));
    EXPECT_EQ(good(kHead + " 044   [4]  remote request").frame,
              (wire::CanFrame{.can_id = 0x44, .is_remote = true, .payload_len = 4}));
    EXPECT_EQ(good(kHead + " 20000004   [8]  00 00 00 00 00 00 00 00   ERRORFRAME").frame,
              (wire::CanFrame{.can_id = 4, .is_error = true, .payload_len = 8}));
    EXPECT_EQ(good(kHead + " 044  [01]  2A").frame,
              (wire::CanFrame{.can_id = 0x44, .is_fd = true, .payload_len = 1, .data = {0x2A}}));
    EXPECT_EQ(
        good(kHead + " RX B -  044  [01]  2A").frame,
        (wire::CanFrame{
            .can_id = 0x44, .is_fd = true, .has_bit_rate_switch = true, .payload_len = 1, .data = {0x2A}}));
    EXPECT_EQ(good(kHead + " 044   {F}  01 02 03 04 05 06 07 08").frame.payload_len, 8);
    std::string longest = " \x1B[31m(2025-06-15 15:06:40.123456789)   fifteen_letters  TX B E  044  [64] ";
    for (int i = 0; i < 64; ++i) longest += " 5A";
    EXPECT_LT(longest.size() + 8, kLineBytesMax);
    EXPECT_EQ(good(longest).frame.payload_len, 64);
}

TEST(LogLine, takes_times_of_every_kind) {
    const auto ns = [](const std::string& stamp) { return good(stamp + " can0 044#2A").stamp.ns; };
    EXPECT_EQ(ns("(000.000270)"), 270'000);
    EXPECT_EQ(ns("(1436509053.850)"), 1'436'509'053'850'000'000);
    EXPECT_EQ(ns("(1436509053.85087012)"), 1'436'509'053'850'870'000);
    EXPECT_EQ(ns("(1436509053.850870999)"), 1'436'509'053'850'870'000);
    EXPECT_EQ(ns("(2025-06-15 15:06:40.000220)"), 1'750'000'000'000'220'000);
    EXPECT_EQ(ns("(2024-02-29 00:00:00.000)"), 1'709'164'800'000'000'000);
    EXPECT_EQ(ns("(1970-01-01 00:00:00.000001)"), 1'000);
}

TEST(LogLine, takes_blanks_as_they_come_and_the_raw_length_code) {
    EXPECT_EQ(good(" (1436509053.850870)  vcan0   044#2A  R ").frame.payload_len, 1);
    const LogEntry entry = good(kHead + "044#0102030405060708_F");
    EXPECT_EQ(entry.frame.payload_len, 8);
    EXPECT_EQ(entry.frame.data[7], 8);
}

TEST(LogLine, takes_the_frame_from_behind_the_name_whatever_that_looks_like) {
    for (const char* name : {"can(0)", "(0)", "123", "[1]", "RX", "044", "R", "'a'"}) {
        for (const char* frame : {" 045#2A", "  045   [1]  2A"}) {
            const auto entry = parse_line("(1436509053.850870) " + std::string(name) + frame);
            ASSERT_TRUE(entry) << name << frame;
            EXPECT_EQ(entry->interface, name);
            EXPECT_EQ(entry->frame.can_id, 0x45U) << name << frame;
            EXPECT_EQ(entry->frame.payload_len, 1U) << name << frame;
        }
    }
    // No name of Linux has a blank. One of another tool that does is no frame of its second word.
    for (const char* name : {"a 123#00", "a 123#00 R", "a 123", "a 123 [0]", "a 123 [1] 2A"})
        EXPECT_FALSE(parse_line("(1436509053.850870) " + std::string(name) + " 045#2A")) << name;
}

TEST(LogLine, names_what_is_wrong) {
    expect_fault(LineFault::blank, "");
    expect_fault(LineFault::blank, " \t \r");
    expect_fault(LineFault::foreign, "vcan0  044   [5]  2A 36 6C 2B BA");
    for (const char* stamp :
         {"()", "(.)", "(1)", "(1.5)", "(1.12)", "(1.1234567890)", "(1.000000)x",
          "(2025-02-29 15:06:40.000220)", "(2025-06-15 24:06:40.000220)", "(2025-06-15T15:06:40.000220)",
          "(1969-06-15 15:06:40.000220)", "(-1.000000)", "(1.-00001)", "(1.000000", "(1,000000)",
          "(99999999999.000000)", "(9223372036.000000)", "(9999-06-15 15:06:40.000220)", "(nan.000000)"}) {
        expect_fault(LineFault::timestamp, std::string(stamp) + " vcan0 044#2A");
    }
    expect_fault(LineFault::interface, "(1436509053.850870)");
    expect_fault(LineFault::interface, "(1436509053.850870)  044#2A");
    for (const char* name : {"vcan#0", "123#00", "#", "123##0", "123#R"}) {
        expect_fault(LineFault::interface, "(1436509053.850870) " + std::string(name) + " 044#2A");
        expect_fault(LineFault::interface, "(1436509053.850870)  " + std::string(name) + "  044   [1]  2A");
    }
    expect_fault(LineFault::interface, "(1436509053.850870) sixteen_letters_ 044#2A");
    for (const char* id : {"", "44", "0044", "800", "-44", "0x4", "G44", "80000044", "40000044"}) {
        expect_fault(LineFault::identifier, kHead + id + "#2A");
    }
    expect_fault(LineFault::identifier, kHead);
    for (const char* body : {"",
                             "#2",
                             "#2A3",
                             "#2G",
                             "#-1",
                             "#2A.36",
                             "#RX",
                             "#R10",
                             "##",
                             "##G00",
                             "##00",
                             "#2A x",
                             "#2A R T",
                             "#2A_9",
                             "#0102030405060708_8",
                             "#0102030405060708_",
                             "##00102030405060708_9",
                             "   [5]  2A 36",
                             "   [1]  2AB",
                             "   [1]",
                             "   5  2A",
                             "   [1]  2A 36",
                             "   [0]  remote",
                             "   [08] remote request",
                             "   [2]  2A`36"}) {
        expect_fault(LineFault::data, kHead + "044" + body);
    }
    expect_fault(LineFault::length, kHead + "044#010203040506070809");
    expect_fault(LineFault::length, kHead + "044#R9");
    expect_fault(LineFault::length, kHead + "044   [9]  01 02 03 04 05 06 07 08 09");
    expect_fault(LineFault::length, kHead + "044  [09]  01 02 03 04 05 06 07 08 09");
    expect_fault(LineFault::identifier, kHead + "44   [1]  2A");
    expect_fault(LineFault::length, kHead + "044##0010203040506070809");
    expect_fault(LineFault::length, kHead + "044##0" + std::string(130, '0'));
}

TEST(LogLine, writes_what_candump_would_have_written) {
    EXPECT_EQ(format_line({{1'436'509'053'850'870'999},
                           "vcan0",
                           {.can_id = 0x44, .payload_len = 5, .data = {0x2A, 0x36, 0x6C, 0x2B, 0xBA}}}),
              "(1436509053.850870) vcan0 044#2A366C2BBA\n");
    EXPECT_EQ(format_line({{1'000}, "can0", {.can_id = 4, .is_error = true, .payload_len = 1, .data = {7}}}),
              "(0000000000.000001) can0 20000004#07\n");
    EXPECT_EQ(format_line({{0}, "can0", {.can_id = 0x44, .is_remote = true, .payload_len = 8}}),
              "(0000000000.000000) can0 044#R8\n");
    EXPECT_EQ(format_line({{0}, "can0", {.can_id = 0x44, .is_extended = true, .is_fd = true}}),
              "(0000000000.000000) can0 00000044##0\n");
}

wire::CanFrame random_frame(std::mt19937& random) {
    const auto up_to = [&](std::uint32_t max) {
        return std::uniform_int_distribution<std::uint32_t>(0, max)(random);
    };
    wire::CanFrame frame;
    const std::uint32_t kind = up_to(4);
    frame.is_extended = kind == 1;
    frame.is_error = kind == 2;
    frame.is_remote = kind == 3;
    frame.is_fd = kind == 4;
    frame.has_bit_rate_switch = frame.is_fd && up_to(1) == 1;
    frame.can_id = up_to(frame.is_extended || frame.is_error ? 0x1FFFFFFF : 0x7FF);
    do {
        frame.payload_len = static_cast<std::uint8_t>(up_to(frame.is_fd ? 64 : 8));
    } while (!wire::is_fd_length(frame.payload_len));
    for (std::size_t i = 0; i < frame.payload_len && !frame.is_remote; ++i) {
        frame.data[i] = static_cast<std::uint8_t>(up_to(255));
    }
    return frame;
}

TEST(LogLine, reads_back_any_frame_it_wrote) {
    std::mt19937 random(20260101);
    for (int i = 0; i < 5'000; ++i) {
        const LogEntry entry{{std::int64_t{1000} * i * 1'234'567}, "can0", random_frame(random)};
        std::string line = format_line(entry);
        ASSERT_LE(line.size(), kLineBytesMax);
        line.pop_back();
        const auto back = parse_line(line);
        ASSERT_TRUE(back.has_value()) << line;
        ASSERT_EQ(*back, entry) << line;
    }
}

TEST(LogLine, survives_every_cut_and_every_changed_character_of_a_line) {
    const std::string line = "(1436509053.850870) can0 250##1000102030405060708090A0B";
    for (std::size_t length = 0; length < line.size(); ++length) {
        const auto cut = parse_line(line.substr(0, length));
        if (cut) {  // cut between bytes at a length that CAN FD has
            EXPECT_TRUE(wire::is_fd_length(cut->frame.payload_len));
            EXPECT_EQ(cut->stamp.ns, 1'436'509'053'850'870'000);
        }
    }
}

TEST(LogLine, is_written_back_the_same_whatever_character_of_it_was_changed) {
    for (const std::string line : {"(1436509053.850870) can0 250##1000102030405060708090A0B",
                                   " (2025-06-15 15:06:40.000220)  can0  RX B -  250  [03]  00 01 02",
                                   "\x1B[31m(000.000270) can0 250#0001020304050607_F R"}) {
        ASSERT_TRUE(parse_line(line)) << line;
        for (std::size_t place = 0; place < line.size(); ++place) {
            for (int value = 0; value < 256; ++value) {
                std::string changed = line;
                changed[place] = static_cast<char>(value);
                const auto entry = parse_line(changed);
                if (!entry) continue;
                const std::string written = format_line(*entry);
                ASSERT_EQ(parse_line(written.substr(0, written.size() - 1)).value(), *entry) << changed;
            }
        }
    }
}

}  // namespace
}  // namespace octoskin::candump
