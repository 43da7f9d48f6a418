#include "host/apps/flashing/openocd_outcome.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "host/apps/flashing/openocd_script.hpp"
#include "hw/image/option_bytes.hpp"

namespace octoskin::flashing {
namespace {

/// A text of OpenOCD 0.12, its meaning and the remedy. The first match counts: causes come before their
/// consequences.
struct Symptom {
    std::string_view words;
    ExitCode exit;
    ErrorCode code;
    std::string_view what;
    std::string_view remedy;

    [[nodiscard]] AppError error() const {
        return {exit, {.code = code, .what = std::string(what), .remedy = std::string(remedy)}};
    }
};
constexpr auto kSymptoms = std::to_array<Symptom>({
    {"LIBUSB_ERROR_ACCESS", ExitCode::no_permission, ErrorCode::no_permission,
     "no permission to use the ST-LINK",
     "the Debian package openocd brings a udev rule for the group plugdev; run "
     "`sudo usermod -aG plugdev $USER`, log in again, and unplug the board and plug it in again"},
    {"LIBUSB_ERROR_BUSY", ExitCode::unavailable, ErrorCode::in_use,
     "the ST-LINK is in use by another program", "end the other OpenOCD, debugger or virtual machine"},
    {"LIBUSB_ERROR_NO_DEVICE", ExitCode::io_failed, ErrorCode::no_device, "the ST-LINK disconnected",
     "check the USB cable, and try again"},
    {"LIBUSB_ERROR_IO", ExitCode::io_failed, ErrorCode::no_device, "USB errors between host and ST-LINK",
     "try another cable or port"},
    {"target voltage may be too low", ExitCode::unavailable, ErrorCode::no_device,
     "the ST-LINK measures no supply voltage at the chip",
     "power the board (its 5V jumper at 5V_STLK for supply by USB)"},
    {"unable to connect to the target", ExitCode::unavailable, ErrorCode::no_answer,
     "the ST-LINK is connected, but the chip does not answer",
     "is it powered? If its program prevents an answer, hold the reset button, start again, and release the "
     "button when `clock speed` appears"},
    {"Can't find board/", ExitCode::unavailable, ErrorCode::unsupported,
     "this OpenOCD has no script for the board", "install Debian's openocd 0.12 or newer"},
    {"auto_probe failed", ExitCode::io_failed, ErrorCode::mismatch,
     "OpenOCD did not recognise the chip's flash", "is this board a NUCLEO-G474RE?"},
    {"timed out while waiting for target", ExitCode::io_failed, ErrorCode::no_answer,
     "the chip does not halt", "press its reset button and try again"},
});

bool says(const OpenocdRun& run, std::string_view words) {
    return run.output.find(words) != std::string::npos;
}

/// The last value that the script printed after this prefix.
std::optional<std::uint32_t> last_value(const OpenocdRun& run, std::string_view words) {
    const std::size_t at = run.output.rfind(words);
    if (at == std::string::npos) return std::nullopt;
    const char* first = run.output.data() + at + words.size();
    const char* end = run.output.data() + run.output.size();
    if (!std::string_view(first, end).starts_with("0x")) return std::nullopt;
    std::uint32_t value = 0;
    if (std::from_chars(first + 2, end, value, 16).ec != std::errc{}) return std::nullopt;
    return value;
}

/// The last line of the output that is not blank.
std::string last_line(const OpenocdRun& run) {
    std::string_view rest = run.output;
    while (!rest.empty()) {
        const std::size_t begin = rest.find_last_of('\n') + 1;  // 0 if there is none
        const std::string_view line = rest.substr(begin);
        if (line.find_first_not_of(" \t\r") != std::string_view::npos) return std::string(line);
        rest = rest.substr(0, begin == 0 ? 0 : begin - 1);
    }
    return "nothing";
}

/// The first non-empty line that OpenOCD marks as an error, for failures without an entry in the table.
std::string first_error(const OpenocdRun& run) {
    constexpr std::string_view kMark = "Error: ";
    for (std::size_t at = 0; (at = run.output.find(kMark, at)) != std::string::npos;) {
        at += kMark.size();
        const std::size_t end = std::min(run.output.find('\n', at), run.output.size());
        if (end > at) return run.output.substr(at, end - at);
    }
    return fmt::format("exit code {}, last line of its output: {}", run.exit_code, last_line(run));
}

AppError no_adapter(const std::string& serial) {
    Error error{.code = ErrorCode::no_device,
                .what = "no ST-LINK found",
                .remedy =
                    "connect the NUCLEO's own USB connector with a cable that carries data; `lsusb -d 0483:` "
                    "lists it"};
    if (!serial.empty()) {
        error.what = "expected the serial number of a connected ST-LINK";
        error.value = serial;
        error.key = "--adapter-serial";
        error.remedy += ", and `lsusb -v` its number (iSerial)";
    }
    return {ExitCode::unavailable, std::move(error)};
}

/// The error if OpenOCD did not run to its end.
std::optional<AppError> run_fault(const OpenocdRun& run) {
    switch (run.end) {
        case OpenocdRun::End::not_found:
            return AppError{ExitCode::unavailable,
                            {.code = ErrorCode::no_program,
                             .what = "openocd is not installed",
                             .remedy = "`sudo apt install openocd`"}};
        case OpenocdRun::End::no_process:
            return AppError{ExitCode::unavailable,
                            {.code = ErrorCode::system_error,
                             .what = fmt::format("openocd cannot be started ({})", run.output),
                             .remedy = "does `openocd --version` run?"}};
        case OpenocdRun::End::timed_out:
            return AppError{ExitCode::io_failed,
                            {.code = ErrorCode::time_limit,
                             .what = "OpenOCD did not end in time",
                             .remedy = "unplug the board, plug it in again, and try again"}};
        case OpenocdRun::End::exited:
            break;
    }
    return std::nullopt;
}

AppError failed_run(const OpenocdRun& run, const Expected& expected) {
    const auto device = last_value(run, kSaysDevice);
    if (device && *device != expected.device_id) {
        return {ExitCode::unavailable,
                {.code = ErrorCode::mismatch,
                 .what = fmt::format(
                     "the chip is another one, and nothing was written: expected the device id 0x{:03X}",
                     expected.device_id),
                 .value = fmt::format("0x{:03X}", *device),
                 .remedy = "is it this board's ST-LINK? Select one with --adapter-serial"}};
    }
    const auto options = last_value(run, kSaysOptions);
    if (options && image::is_read_protected(*options)) {
        return {ExitCode::io_failed,
                {.code = ErrorCode::no_permission,
                 .what = "the chip is read-protected and cannot be programmed",
                 .value = fmt::format("RDP 0x{:02X}", *options & 0xFFU),
                 .remedy = "removing the protection erases the chip (`stm32l4x unlock 0` in OpenOCD)"}};
    }
    for (const Symptom& symptom : kSymptoms) {
        if (says(run, symptom.words)) return symptom.error();
    }
    if (says(run, "open failed")) return no_adapter(expected.adapter_serial);
    const auto failed = [reason = first_error(run)](ErrorCode code, const char* what, const char* remedy) {
        return AppError{ExitCode::io_failed,
                        {.code = code, .what = fmt::format("{} ({})", what, reason), .remedy = remedy}};
    };
    if (says(run, kSaysVerified)) {
        return failed(ErrorCode::no_answer, "programmed and verified, but not started",
                      "press the board's reset button");
    }
    if (says(run, kSaysProgrammed)) {
        return failed(ErrorCode::damaged, "the flash content differs from what was written",
                      "try again; if it persists, the chip's flash is worn or its supply is poor");
    }
    return failed(ErrorCode::no_device,
                  options ? "programming failed" : "OpenOCD failed before anything was written",
                  "try again; if it persists, use another USB cable or port; its full output is in "
                  "openocd.log");
}

}  // namespace

Result<Programmed, AppError> judge(const OpenocdRun& run, const Expected& expected) {
    if (const auto fault = run_fault(run)) return unexpected(*fault);
    const auto options = last_value(run, kSaysOptions);
    // The exit code alone is not sufficient: the output must confirm each step.
    const bool is_done = run.exit_code == 0 && options && says(run, kSaysProgrammed) &&
                         says(run, kSaysVerified) && says(run, kSaysStarted);
    if (!is_done) return unexpected(failed_run(run, expected));
    return Programmed{*options};
}

std::optional<AppError> judge_dry_run(const OpenocdRun& run) {
    if (const auto fault = run_fault(run)) return fault;
    if (run.exit_code == 0 && says(run, "stm32l4x")) return std::nullopt;
    for (const Symptom& symptom : kSymptoms) {
        if (says(run, symptom.words)) return symptom.error();
    }
    return AppError{ExitCode::unavailable,
                    {.code = ErrorCode::unsupported,
                     .what = fmt::format("OpenOCD cannot read the script ({})", first_error(run)),
                     .remedy = "install Debian's openocd 0.12 or newer; its full output is in openocd.log"}};
}

}  // namespace octoskin::flashing
