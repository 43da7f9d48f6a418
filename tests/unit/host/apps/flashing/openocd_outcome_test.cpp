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
    ASSERT_TRUE(programmed) << programmed.error().message();
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
    ExitCode exit;
    ErrorCode code;
    const char* found;   ///< in what is wrong, or in the value
    const char* remedy;  ///< in the remedy
    friend std::ostream& operator<<(std::ostream& out, const Case& each) { return out << each.name; }
};
class OpenocdFault : public testing::TestWithParam<Case> {};

TEST_P(OpenocdFault, becomes_one_sentence) {
    const auto programmed = judge(ended(GetParam().output), {.device_id = kChip, .adapter_serial = ""});
    ASSERT_FALSE(programmed);
    const Error& error = programmed.error().error;
    EXPECT_EQ(programmed.error().exit, GetParam().exit);
    EXPECT_EQ(error.code, GetParam().code);
    EXPECT_THAT(error.value.empty() ? error.what : error.value, HasSubstr(GetParam().found));
    EXPECT_THAT(error.remedy, HasSubstr(GetParam().remedy));
    EXPECT_THAT(programmed.error().message(), Not(HasSubstr("\n")));
}

INSTANTIATE_TEST_SUITE_P(
    Cases, OpenocdFault,
    testing::Values(
        Case{"no adapter", kBanner + "Error: open failed\n", ExitCode::unavailable, ErrorCode::no_device,
             "ST-LINK", "lsusb -d 0483:"},
        Case{"no permission",
             kBanner + "Error: libusb_open() failed with LIBUSB_ERROR_ACCESS\nError: open failed\n",
             ExitCode::no_permission, ErrorCode::no_permission, "ST-LINK", "usermod -aG plugdev"},
        Case{"taken",
             kBanner + "Error: libusb_claim_interface() failed with LIBUSB_ERROR_BUSY\nError: open failed\n",
             ExitCode::unavailable, ErrorCode::in_use, "ST-LINK", "debugger"},
        Case{"unplugged",
             kBanner + kProbe + kDevice + kOptions + "Error: jtag_libusb: LIBUSB_ERROR_NO_DEVICE\n",
             ExitCode::io_failed, ErrorCode::no_device, "disconnected", "cable"},
        Case{"no supply",
             kBanner + kProbe +
                 "Info : Target voltage: 0.002\nError: target voltage may be too low for reliable debugging\n"
                 "Error: init mode failed (unable to connect to the target)\n",
             ExitCode::unavailable, ErrorCode::no_device, "no supply voltage", "5V_STLK"},
        Case{"no answer",
             kBanner + kProbe +
                 "Info : Target voltage: 3.23\nError: init mode failed (unable to connect to the target)\n",
             ExitCode::unavailable, ErrorCode::no_answer, "the chip", "reset button"},
        Case{"another chip", kBanner + kProbe + "octoskin: device 0x468\n", ExitCode::unavailable,
             ErrorCode::mismatch, "0x468", "--adapter-serial"},
        Case{"read protection",
             kBanner + kProbe + kDevice + "octoskin: options 0xFFEFF8BB\nError: auto_probe failed\n",
             ExitCode::io_failed, ErrorCode::no_permission, "RDP 0xBB", "stm32l4x unlock 0"},
        Case{"never halts", kBanner + kProbe + "Error: timed out while waiting for target halted\n",
             ExitCode::io_failed, ErrorCode::no_answer, "halt", "reset button"},
        Case{"flash unknown", kBanner + kProbe + kDevice + kOptions + "Error: auto_probe failed\n",
             ExitCode::io_failed, ErrorCode::mismatch, "flash", "NUCLEO-G474RE"},
        Case{"programming",
             kBanner + kProbe + kDevice + kOptions + "Error: flash write failed\nError: more\n",
             ExitCode::io_failed, ErrorCode::no_device, "programming failed (flash write failed)",
             "openocd.log"},
        Case{"verification",
             kBanner + kProbe + kDevice + kOptions + kProgrammed +
                 "Error: checksum mismatch - attempting binary compare\n",
             ExitCode::io_failed, ErrorCode::damaged, "(checksum mismatch", "try again"},
        Case{"start", kBanner + kProbe + kDevice + kOptions + kProgrammed + kVerified, ExitCode::io_failed,
             ErrorCode::no_answer, "(exit code 1, last line of its output: octoskin: verified)",
             "reset button"},
        Case{"no such board", kBanner + "Can't find board/st_nucleo_g4.cfg\n", ExitCode::unavailable,
             ErrorCode::unsupported, "the board", "openocd 0.12"},
        Case{"anything else", kBanner + "Error: \nError: the moon is full\nError: later\n",
             ExitCode::io_failed, ErrorCode::no_device, "before anything was written (the moon is full)",
             "openocd.log"},
        Case{"no error line", kBanner + "invalid command name \"frob\"\n\n \t\n", ExitCode::io_failed,
             ErrorCode::no_device, "(exit code 1, last line of its output: invalid command name \"frob\")",
             "openocd.log"},
        Case{"not a word", "", ExitCode::io_failed, ErrorCode::no_device,
             "(exit code 1, last line of its output: nothing)", "openocd.log"}));

TEST(OpenocdOutcome, a_serial_number_that_nobody_has_is_named) {
    const auto programmed =
        judge(ended(kBanner + "Error: open failed\n"), {.device_id = kChip, .adapter_serial = "0042003"});
    ASSERT_FALSE(programmed);
    EXPECT_EQ(programmed.error().error.code, ErrorCode::no_device);
    EXPECT_EQ(programmed.error().error.key, "--adapter-serial");
    EXPECT_EQ(programmed.error().error.value, "0042003");
}

TEST(OpenocdOutcome, what_kept_it_from_running_is_told) {
    const Expected expected{.device_id = kChip, .adapter_serial = ""};
    OpenocdRun run;
    run.end = OpenocdRun::End::not_found;
    EXPECT_EQ(judge(run, expected).error().exit, ExitCode::unavailable);
    EXPECT_EQ(judge(run, expected).error().error.code, ErrorCode::no_program);
    EXPECT_THAT(judge(run, expected).error().error.remedy, HasSubstr("apt install openocd"));
    EXPECT_EQ(judge_dry_run(run)->exit, ExitCode::unavailable);
    run.end = OpenocdRun::End::timed_out;
    EXPECT_EQ(judge(run, expected).error().exit, ExitCode::io_failed);
    run.end = OpenocdRun::End::no_process;
    run.output = "Permission denied";
    EXPECT_THAT(judge(run, expected).error().error.what, HasSubstr("(Permission denied)"));
    EXPECT_THAT(judge(run, expected).error().error.remedy, HasSubstr("openocd --version"));
}

TEST(OpenocdOutcome, a_dry_run_must_have_listed_the_flash) {
    EXPECT_FALSE(judge_dry_run(ended("{name stm32g4x.flash driver stm32l4x base 134217728}\n", 0)));
    EXPECT_TRUE(judge_dry_run(ended("", 0)));
    EXPECT_TRUE(judge_dry_run(ended("stm32l4x\n", 1)));
    const auto refused = judge_dry_run(ended("flash.cfg:3: Error: invalid command name \"gdb_port\"\n", 1));
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->error.code, ErrorCode::unsupported);
    EXPECT_THAT(refused->error.what, HasSubstr("(invalid command name \"gdb_port\")"));
    EXPECT_THAT(refused->error.remedy, HasSubstr("openocd 0.12"));
}

}  // namespace
}  // namespace octoskin::flashing
