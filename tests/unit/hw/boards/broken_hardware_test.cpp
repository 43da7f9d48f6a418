// A board's file with one thing wrong: refused with line, key and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <ostream>
#include <string>

#include "hw/rigfile/board_hardware.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::has_its_fields;
using testing_support::key_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

struct Change {
    const char* from;
    const char* to;
    const char* key;
    ErrorCode code;
    const char* value;
    const char* also = "";  ///< part of the rule or of the remedy
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
    const Error& error = board.error();
    EXPECT_EQ(error.file, file);
    EXPECT_THAT(error, AllOf(key_is(HasSubstr(GetParam().key)), code_is(GetParam().code),
                             value_is(GetParam().value)));
    EXPECT_THAT(error, AnyOf(what_is(HasSubstr(GetParam().also)), remedy_is(HasSubstr(GetParam().also))));
    EXPECT_GT(error.line, 0);
    EXPECT_TRUE(has_its_fields(error));
}

INSTANTIATE_TEST_SUITE_P(
    Changes, BrokenHardware,
    testing::Values(
        Change{"pin: PA15", "pin: PA16", "pins[0].pin", ErrorCode::bad_name, "'PA16'", "from PA0 to PG15"},
        Change{"pin: PA15", "pin: PA05", "pins[0].pin", ErrorCode::bad_name, "'PA05'"},
        Change{"pin: PA15", "pin: PH1", "pins[0].pin", ErrorCode::bad_name, "'PH1'"},
        Change{"pin: PA15", "pin: PA", "pins[0].pin", ErrorCode::bad_name, "'PA'"},
        Change{"pin: PA15", "pin: PAx", "pins[0].pin", ErrorCode::bad_name, "'PAx'"},
        Change{"pin: PA15", "pin: PB7", "pins[1].pin", ErrorCode::duplicate, "PB7", "i2c0_scl has it"},
        Change{"pin: PA15", "pin: PB8", "pins[0].pin", ErrorCode::conflict, "PB8", "BOOT0"},
        Change{"pin: PA15", "pin: PB4", "pins[0].pin", ErrorCode::conflict, "PB4", "dead-battery"},
        Change{"pin: PA15", "pin: PA13", "pins[0].pin", ErrorCode::conflict, "PA13", "SWDIO"},
        Change{"pin: PA15", "pin: PF0", "pins[0].pin", ErrorCode::conflict, "PF0", "24 MHz crystal"},
        Change{"signal: i2c0_sda", "signal: i2c0_scl", "pins[1].signal", ErrorCode::duplicate,
               "i2c0_scl again"},
        Change{"alternate: 4", "alternate: 16", "pins[0].alternate", ErrorCode::out_of_range, "'16'",
               "from 0 to 15"},
        Change{"function: I2C1_SCL, alternate: 4", "function: I2C1_SCL", "pins[0].function",
               ErrorCode::conflict, "", "without `alternate`"},
        Change{"function: output", "function: output, alternate: 1", "pins[10].function", ErrorCode::conflict,
               "", "without `alternate`"},
        Change{"function: input", "function: input, alternate: 1", "pins[16].function", ErrorCode::conflict,
               "", "without `alternate`"},
        Change{"function: input", "function: input, drive: push_pull", "pins[16].function",
               ErrorCode::conflict, "", "`pull` with"},
        Change{"drive: open_drain", "drive: open_drain, pull: up", "pins[0].function", ErrorCode::conflict,
               "", "`pull` with"},
        Change{"pull: up", "pull: down", "pins[16].pull", ErrorCode::unknown_word, "'down'", "up or none"},
        Change{"drive: open_drain", "drive: strong", "pins[0].drive", ErrorCode::unknown_word, "'strong'",
               "open_drain or push_pull"},
        Change{"address: 0x0807F800", "address: 0x08080000", "memory.configuration_page",
               ErrorCode::bad_value, "another place", "the end of flash"},
        Change{"address: 0x0807F800", "address: 0x0807F000", "memory.configuration_page",
               ErrorCode::bad_value, "another place", "the end of flash"},
        Change{"size_bytes: 0x80000}", "size_bytes: 0}", "memory.flash.size_bytes", ErrorCode::out_of_range,
               "'0'", "whole number from 1"},
        Change{"address: 0x20000000", "address: 0xFFFFFFFF", "memory.ram.size_bytes", ErrorCode::out_of_range,
               "one that ends above", "below 4 GiB"},
        Change{"device_id: 0x469", "device_id: 0x10006469", "device_id", ErrorCode::out_of_range,
               "'0x10006469'", "whole number"},
        Change{"core_hz", "core_mhz", "clocks", ErrorCode::unknown_key, "", "known key"}));

TEST(BoardHardwareFile, absent_is_told) {
    const auto board = read_board_hardware("/nowhere/board.hardware.yaml");
    ASSERT_FALSE(board);
    EXPECT_EQ(board.error().code, ErrorCode::not_found);
    EXPECT_EQ(board.error().file, "/nowhere/board.hardware.yaml");
}

}  // namespace
}  // namespace octoskin::rig
