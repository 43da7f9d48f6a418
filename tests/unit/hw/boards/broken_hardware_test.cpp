// A board's file with one thing wrong: refused with line, key and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <ostream>
#include <string>

#include "hw/rigfile/board_hardware.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::HasSubstr;

struct Change {
    const char* from;
    const char* to;
    const char* key;
    const char* words;
    friend std::ostream& operator<<(std::ostream& out, const Change& change) { return out << change.to; }
};

class BrokenHardware : public testing::TestWithParam<Change> {};

TEST_P(BrokenHardware, is_refused_by_name) {
    std::ifstream shipped(OCTOSKIN_SOURCE_DIR "/hw/boards/nucleo_g474re.hardware.yaml");
    std::string text{std::istreambuf_iterator<char>(shipped), {}};
    const std::string from = GetParam().from;
    ASSERT_NE(text.find(from), std::string::npos);
    text.replace(text.find(from), from.size(), GetParam().to);
    const testing_support::ScratchFolder folder;
    const auto file = folder.path() / "board.hardware.yaml";
    std::ofstream(file) << text;
    const auto board = read_board_hardware(file);
    ASSERT_FALSE(board);
    EXPECT_THAT(board.error().key, HasSubstr(GetParam().key));
    EXPECT_THAT(board.error().what, HasSubstr(GetParam().words));
    EXPECT_GT(board.error().line, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Changes, BrokenHardware,
    testing::Values(
        Change{"pin: PA15", "pin: PA16", "pins[0].pin", "from PA0 to PG15, found 'PA16'"},
        Change{"pin: PA15", "pin: PA05", "pins[0].pin", "found 'PA05'"},
        Change{"pin: PA15", "pin: PH1", "pins[0].pin", "found 'PH1'"},
        Change{"pin: PA15", "pin: PA", "pins[0].pin", "found 'PA'"},
        Change{"pin: PA15", "pin: PAx", "pins[0].pin", "found 'PAx'"},
        Change{"pin: PA15", "pin: PB7", "pins[1].pin", "i2c0_scl has it"},
        Change{"pin: PA15", "pin: PB8", "pins[0].pin", "found PB8: BOOT0"},
        Change{"pin: PA15", "pin: PB4", "pins[0].pin", "dead-battery"},
        Change{"pin: PA15", "pin: PA13", "pins[0].pin", "SWDIO"},
        Change{"pin: PA15", "pin: PF0", "pins[0].pin", "24 MHz crystal"},
        Change{"signal: i2c0_sda", "signal: i2c0_scl", "pins[1].signal", "found i2c0_scl again"},
        Change{"alternate: 4", "alternate: 16", "pins[0].alternate", "from 0 to 15"},
        Change{"function: I2C1_SCL, alternate: 4", "function: I2C1_SCL", "pins[0].function",
               "without `alternate`"},
        Change{"function: output", "function: output, alternate: 1", "pins[10].function",
               "without `alternate`"},
        Change{"function: input", "function: input, alternate: 1", "pins[16].function",
               "without `alternate`"},
        Change{"function: input", "function: input, drive: push_pull", "pins[16].function", "`pull` with"},
        Change{"drive: open_drain", "drive: open_drain, pull: up", "pins[0].function", "`pull` with"},
        Change{"pull: up", "pull: down", "pins[16].pull", "up or none"},
        Change{"drive: open_drain", "drive: strong", "pins[0].drive", "open_drain or push_pull"},
        Change{"address: 0x0807F800", "address: 0x08080000", "memory.configuration_page", "the end of flash"},
        Change{"address: 0x0807F800", "address: 0x0807F000", "memory.configuration_page", "the end of flash"},
        Change{"size_bytes: 0x80000}", "size_bytes: 0}", "memory.flash.size_bytes", "whole number from 1"},
        Change{"address: 0x20000000", "address: 0xFFFFFFFF", "memory.ram.size_bytes", "below 4 GiB"},
        Change{"device_id: 0x469", "device_id: 0x10006469", "device_id", "whole number"},
        Change{"core_hz", "core_mhz", "clocks", "known key"}));

TEST(BoardHardwareFile, absent_is_told) {
    const auto board = read_board_hardware("/nowhere/board.hardware.yaml");
    ASSERT_FALSE(board);
    EXPECT_THAT(board.error().message(), HasSubstr("/nowhere/board.hardware.yaml"));
}

}  // namespace
}  // namespace octoskin::rig
