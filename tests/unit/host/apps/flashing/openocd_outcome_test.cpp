// What OpenOCD 0.12 says when something is in the way, and the one sentence that becomes of it.
#include "host/apps/flashing/openocd_outcome.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

namespace octoskin::flashing {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kBanner =
    "Open On-Chip Debugger 0.12.0\nLicensed under GNU GPL v2\n"
    "Info : The selected transport took over low-level target control.\nInfo : clock speed 2000 kHz\n";
const std::string kProbe = "Info : STLINK V3J7M2 (API v3) VID:PID 0483:374E\n";
const std::string kDevice = "octoskin: device 0x469\n";
const std::string kOptions = "octoskin: options 0xFFEFF8AA\n";
const std::string kProgrammed = "octoskin: programmed\n";
const std::string kVerified = "octoskin: verified\n";
const std::string kStarted = "octoskin: started\nshutdown command invoked\n";
const std::string kGood = kBanner + kProbe + kDevice + kOptions + kProgrammed + kVerified + kStarted;

OpenocdRun ended(const std::string& output, int exit_code = 1) {
    return {.end = OpenocdRun::End::exited, .exit_code = exit_code, .output = output};
}
constexpr std::uint32_t kChip = 0x469;

TEST(OpenocdOutcome, a_run_that_told_every_step_is_believed) {
    const auto programmed = judge(ended(kGood, 0), {.device_id = kChip, .adapter_serial = ""});
    ASSERT_TRUE(programmed) << programmed.error().message;
    EXPECT_EQ(programmed->flash_optr, 0xFFEF'F8AAU);
}

TEST(OpenocdOutcome, a_run_that_lacks_a_step_is_not_whatever_its_exit_code) {
    for (const std::string& step : {kDevice, kOptions, kProgrammed, kVerified, kStarted}) {
        std::string output = kGood;
        output.erase(output.find(step), step.size());
        // The device is checked by the script itself, which then tells no later step.
        const bool is_done = judge(ended(output, 0), {.device_id = kChip, .adapter_serial = ""}).has_value();
        EXPECT_EQ(is_done, step == kDevice) << step;
    }
    EXPECT_FALSE(judge(ended(kGood, 1), {.device_id = kChip, .adapter_serial = ""}));
    EXPECT_FALSE(judge(ended("", 0), {.device_id = kChip, .adapter_serial = ""}));
}

TEST(OpenocdOutcome, the_option_bytes_last_read_count) {
    const auto programmed =
        judge(ended(kGood + "octoskin: options 0xFBEFFCAA\n", 0), {.device_id = kChip, .adapter_serial = ""});
    ASSERT_TRUE(programmed);
    EXPECT_EQ(programmed->flash_optr, 0xFBEF'FCAAU);
}

struct Case {
    const char* name;
    std::string output;
    ExitCode code;
    const char* words;
    friend std::ostream& operator<<(std::ostream& out, const Case& each) { return out << each.name; }
};
class OpenocdFault : public testing::TestWithParam<Case> {};

TEST_P(OpenocdFault, becomes_one_sentence) {
    const auto programmed = judge(ended(GetParam().output), {.device_id = kChip, .adapter_serial = ""});
    ASSERT_FALSE(programmed);
    EXPECT_EQ(programmed.error().code, GetParam().code);
    EXPECT_THAT(programmed.error().message, HasSubstr(GetParam().words));
    EXPECT_THAT(programmed.error().message, Not(HasSubstr("\n")));
}

INSTANTIATE_TEST_SUITE_P(
    Cases, OpenocdFault,
    testing::Values(
        Case{"no adapter", kBanner + "Error: open failed\n", ExitCode::unavailable, "no ST-LINK found"},
        Case{"no permission",
             kBanner + "Error: libusb_open() failed with LIBUSB_ERROR_ACCESS\nError: open failed\n",
             ExitCode::no_permission, "usermod -aG plugdev"},
        Case{"taken",
             kBanner + "Error: libusb_claim_interface() failed with LIBUSB_ERROR_BUSY\nError: open failed\n",
             ExitCode::unavailable, "in use by another program"},
        Case{"unplugged",
             kBanner + kProbe + kDevice + kOptions + "Error: jtag_libusb: LIBUSB_ERROR_NO_DEVICE\n",
             ExitCode::io_failed, "disconnected"},
        Case{"no supply",
             kBanner + kProbe +
                 "Info : Target voltage: 0.002\nError: target voltage may be too low for reliable debugging\n"
                 "Error: init mode failed (unable to connect to the target)\n",
             ExitCode::unavailable, "no supply voltage at the chip"},
        Case{"no answer",
             kBanner + kProbe +
                 "Info : Target voltage: 3.23\nError: init mode failed (unable to connect to the target)\n",
             ExitCode::unavailable, "the chip does not answer"},
        Case{"another chip", kBanner + kProbe + "octoskin: device 0x468\n", ExitCode::unavailable,
             "device id 0x468, expected 0x469"},
        Case{"read protection",
             kBanner + kProbe + kDevice + "octoskin: options 0xFFEFF8BB\nError: auto_probe failed\n",
             ExitCode::io_failed, "read-protected (RDP 0xBB)"},
        Case{"never halts", kBanner + kProbe + "Error: timed out while waiting for target halted\n",
             ExitCode::io_failed, "press its reset button"},
        Case{"flash unknown", kBanner + kProbe + kDevice + kOptions + "Error: auto_probe failed\n",
             ExitCode::io_failed, "did not recognise the chip's flash"},
        Case{"programming",
             kBanner + kProbe + kDevice + kOptions + "Error: flash write failed\nError: more\n",
             ExitCode::io_failed, "programming failed (flash write failed): try again"},
        Case{"verification",
             kBanner + kProbe + kDevice + kOptions + kProgrammed +
                 "Error: checksum mismatch - attempting binary compare\n",
             ExitCode::io_failed, "differs from what was written (checksum mismatch"},
        Case{"start", kBanner + kProbe + kDevice + kOptions + kProgrammed + kVerified, ExitCode::io_failed,
             "verified, but not started (exit code 1, last line of its output: octoskin: verified): press"},
        Case{"no such board", kBanner + "Can't find board/st_nucleo_g4.cfg\n", ExitCode::unavailable,
             "no script for the board"},
        Case{"anything else", kBanner + "Error: \nError: the moon is full\nError: later\n",
             ExitCode::io_failed, "OpenOCD failed before anything was written (the moon is full): try again"},
        Case{"no error line", kBanner + "invalid command name \"frob\"\n\n \t\n", ExitCode::io_failed,
             "(exit code 1, last line of its output: invalid command name \"frob\"): try again"},
        Case{"not a word", "", ExitCode::io_failed,
             "(exit code 1, last line of its output: nothing): try again"}));

TEST(OpenocdOutcome, a_serial_number_that_nobody_has_is_named) {
    const auto programmed =
        judge(ended(kBanner + "Error: open failed\n"), {.device_id = kChip, .adapter_serial = "0042003"});
    ASSERT_FALSE(programmed);
    EXPECT_THAT(programmed.error().message, HasSubstr("no ST-LINK with the serial number 0042003 found"));
}

TEST(OpenocdOutcome, what_kept_it_from_running_is_told) {
    const Expected expected{.device_id = kChip, .adapter_serial = ""};
    OpenocdRun run;
    run.end = OpenocdRun::End::not_found;
    EXPECT_EQ(judge(run, expected).error().code, ExitCode::unavailable);
    EXPECT_THAT(judge(run, expected).error().message, HasSubstr("apt install openocd"));
    EXPECT_EQ(judge_dry_run(run)->code, ExitCode::unavailable);
    run.end = OpenocdRun::End::timed_out;
    EXPECT_EQ(judge(run, expected).error().code, ExitCode::io_failed);
    run.end = OpenocdRun::End::no_process;
    run.output = "Permission denied";
    EXPECT_THAT(judge(run, expected).error().message,
                HasSubstr("cannot be started (Permission denied): does"));
}

TEST(OpenocdOutcome, a_dry_run_must_have_listed_the_flash) {
    EXPECT_FALSE(judge_dry_run(ended("{name stm32g4x.flash driver stm32l4x base 134217728}\n", 0)));
    EXPECT_TRUE(judge_dry_run(ended("", 0)));
    EXPECT_TRUE(judge_dry_run(ended("stm32l4x\n", 1)));
    EXPECT_THAT(judge_dry_run(ended("flash.cfg:3: Error: invalid command name \"gdb_port\"\n", 1))->message,
                HasSubstr("cannot read the script (invalid command name \"gdb_port\"): install Debian's"));
}

}  // namespace
}  // namespace octoskin::flashing
