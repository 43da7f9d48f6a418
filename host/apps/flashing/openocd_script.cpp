#include "host/apps/flashing/openocd_script.hpp"

#include <fmt/format.h>

#include "hw/image/option_bytes.hpp"

namespace octoskin::flashing {
namespace {

/// DBGMCU_IDCODE: RM0440, "MCU device ID code".
constexpr std::uint32_t kDeviceRegister = 0xE004'2000;

std::string write_options_if_they_differ() {
    const image::MaskedWord wanted = image::wanted_option_bytes();
    // Loading the option bytes resets the chip in the middle of the command, which OpenOCD may report as an
    // error. The option bytes are read again; only that value counts.
    return fmt::format(
        "    if {{($options & 0x{0:08X}) != 0x{1:08X}}} {{\n"
        "        stm32l4x option_write 0 0x{2:X} 0x{1:08X} 0x{0:08X}\n"
        "        catch {{stm32l4x option_load 0}}\n"
        "        sleep 500\n"
        "        reset init\n"
        "        octoskin_options\n"
        "    }}\n",
        wanted.mask, wanted.value, image::kOptionRegisterOffset);
}

}  // namespace

std::string openocd_script(const ScriptPlan& plan) {
    std::string text = fmt::format(
        "# Made by `octoskin flash`. By hand: cd /; openocd -f FOLDER/{}\n"
        "set octoskin_hex [file join [file dirname [info script]] {}]\n"
        "source [find {}]\n"
        "gdb_port disabled\n"
        "tcl_port disabled\n"
        "telnet_port disabled\n",
        kScriptFile, kHexFile, plan.openocd_board);
    // The node sleeps (WFI) nearly all the time, and its debug port has no clock meanwhile
    // (DBGMCU_CR.DBG_SLEEP would cost the power that sleeping saves). Therefore OpenOCD connects under reset,
    // which also works with a broken image. OpenOCD sets the bit itself after connecting.
    text += "reset_config srst_only srst_nogate connect_assert_srst\n";
    if (!plan.adapter_serial.empty()) text += fmt::format("adapter serial {}\n", plan.adapter_serial);
    text += fmt::format(
        "\n"
        "proc octoskin_options {{}} {{\n"
        "    set options [read_memory 0x{:08X} 32 1]\n"
        "    echo [format \"{}0x%08X\" $options]\n"
        "    return $options\n"
        "}}\n",
        image::kOptionRegister, kSaysOptions);
    text += fmt::format(
        "\n"
        "proc octoskin_flash {{}} {{\n"
        "    global octoskin_hex\n"
        "    init\n"
        "    reset init\n"
        "    set device [expr {{[read_memory 0x{0:08X} 32 1] & 0xFFF}}]\n"
        "    echo [format \"{1}0x%03X\" $device]\n"
        "    if {{$device != 0x{2:03X}}} {{ error \"another chip\" }}\n"
        "    set options [octoskin_options]\n"
        "    flash write_image erase $octoskin_hex\n"
        "    echo \"{3}\"\n"
        "    verify_image $octoskin_hex\n"
        "    echo \"{4}\"\n",
        kDeviceRegister, kSaysDevice, plan.device_id, kSaysProgrammed, kSaysVerified);
    if (plan.writes_option_bytes) text += write_options_if_they_differ();
    text += fmt::format(
        "    reset run\n"
        "    echo \"{}\"\n"
        "}}\n"
        "\n"
        "if {{[info exists octoskin_dry_run]}} {{\n"
        "    noinit\n"
        "    echo [flash banks]\n"
        "}} else {{\n"
        "    octoskin_flash\n"
        "}}\n"
        "shutdown\n",
        kSaysStarted);
    return text;
}

}  // namespace octoskin::flashing
