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
    ExitCode code;
    std::string_view meaning;
};
constexpr auto kSymptoms = std::to_array<Symptom>({
    {"LIBUSB_ERROR_ACCESS", ExitCode::no_permission,
     "no permission to use the ST-LINK: the Debian package openocd brings a udev rule for the group plugdev; "
     "run "
     "`sudo usermod -aG plugdev $USER`, log in again, and plug the board out and in"},
    {"LIBUSB_ERROR_BUSY", ExitCode::unavailable,
     "the ST-LINK is in use by another program: end the other OpenOCD, debugger or virtual machine"},
    {"LIBUSB_ERROR_NO_DEVICE", ExitCode::io_failed,
     "the ST-LINK disconnected: check the USB cable, and try again"},
    {"LIBUSB_ERROR_IO", ExitCode::io_failed,
     "USB errors between host and ST-LINK: try another cable or port"},
    {"target voltage may be too low", ExitCode::unavailable,
     "the ST-LINK measures no supply voltage at the chip: power the board (its 5V jumper at 5V_STLK for "
     "supply by USB)"},
    {"unable to connect to the target", ExitCode::unavailable,
     "the ST-LINK is connected, but the chip does not answer: is it powered? If its program prevents it, "
     "hold the reset button, start again, and release it at `clock speed`"},
    {"Can't find board/", ExitCode::unavailable,
     "this OpenOCD has no script for the board: install Debian's openocd 0.12 or newer"},
    {"auto_probe failed", ExitCode::io_failed,
     "OpenOCD did not recognise the chip's flash: is this board a NUCLEO-G474RE?"},
    {"timed out while waiting for target", ExitCode::io_failed,
     "the chip does not halt: press its reset button and try again"},
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
    constexpr const char* kRemedy =
        "connect the NUCLEO's own USB connector with a cable that carries data; `lsusb -d 0483:` lists it";
    if (serial.empty()) return {ExitCode::unavailable, fmt::format("no ST-LINK found: {}", kRemedy)};
    return {ExitCode::unavailable,
            fmt::format("no ST-LINK with the serial number {} found: {}, and `lsusb -v` its "
                        "number (iSerial)",
                        serial, kRemedy)};
}

/// The error if OpenOCD did not run to its end.
std::optional<AppError> run_fault(const OpenocdRun& run) {
    switch (run.end) {
        case OpenocdRun::End::not_found:
            return AppError{ExitCode::unavailable, "openocd is not installed: `sudo apt install openocd`"};
        case OpenocdRun::End::no_process:
            return AppError{
                ExitCode::unavailable,
                fmt::format("openocd cannot be started ({}): does `openocd --version` run?", run.output)};
        case OpenocdRun::End::timed_out:
            return AppError{ExitCode::io_failed,
                            "OpenOCD did not end in time: plug the board out and in, and try again"};
        case OpenocdRun::End::exited:
            break;
    }
    return std::nullopt;
}

AppError failed_run(const OpenocdRun& run, const Expected& expected) {
    const auto device = last_value(run, kSaysDevice);
    if (device && *device != expected.device_id) {
        return {ExitCode::unavailable,
                fmt::format("the chip is another one (device id 0x{:03X}, expected 0x{:03X}); nothing was "
                            "written: is it this board's ST-LINK? Select one with --adapter-serial",
                            *device, expected.device_id)};
    }
    const auto options = last_value(run, kSaysOptions);
    if (options && image::is_read_protected(*options)) {
        return {
            ExitCode::io_failed,
            fmt::format("the chip is read-protected (RDP 0x{:02X}) and cannot be programmed: removing the "
                        "protection erases it (`stm32l4x unlock 0` in OpenOCD)",
                        *options & 0xFFU)};
    }
    for (const Symptom& symptom : kSymptoms) {
        if (says(run, symptom.words)) return {symptom.code, std::string(symptom.meaning)};
    }
    if (says(run, "open failed")) return no_adapter(expected.adapter_serial);
    const std::string error = first_error(run);
    if (says(run, kSaysVerified))
        return {ExitCode::io_failed,
                fmt::format("programmed and verified, but not started ({}): press the board's reset "
                            "button",
                            error)};
    if (says(run, kSaysProgrammed))
        return {ExitCode::io_failed,
                fmt::format("the flash content differs from what was written ({}): try again; if it "
                            "persists, the chip's flash is worn or its supply is poor",
                            error)};
    constexpr const char* kRemedy =
        "try again; if it persists, use another USB cable or port; its full output is in openocd.log";
    if (options) return {ExitCode::io_failed, fmt::format("programming failed ({}): {}", error, kRemedy)};
    return {ExitCode::io_failed,
            fmt::format("OpenOCD failed before anything was written ({}): {}", error, kRemedy)};
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
        if (says(run, symptom.words)) return AppError{symptom.code, std::string(symptom.meaning)};
    }
    return AppError{ExitCode::unavailable,
                    fmt::format("OpenOCD cannot read the script ({}): install Debian's openocd 0.12 or "
                                "newer; its full output is in openocd.log",
                                first_error(run))};
}

}  // namespace octoskin::flashing
