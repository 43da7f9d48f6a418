// The command line of `octoskin flash`: with Debian's OpenOCD and no adapter; with another `openocd` on the
// PATH that says what the real one says; and with the real one running the whole script on hardware that its
// Tcl pretends.
#include <gmock/gmock.h>

#include <cstdlib>

#include "tests/support/image/elf_builder.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

class FlashTest : public ProgramTest {
  protected:
    FlashTest() {
        std::filesystem::create_directories(path("bin"));
        write(path("image.elf"), test::ElfBuilder().text());
    }
    /// `more`: options, as typed.
    [[nodiscard]] Said flash(const std::string& more = "") const {
        return run("PATH=" + path("bin") + ":$PATH " + typed(arguments() + more));
    }
    /// The failure of the same.
    [[nodiscard]] Failure fail_to_flash(const std::string& more = "") const {
        return failure_in(run("PATH=" + path("bin") + ":$PATH " + typed_for_error(arguments() + more)));
    }
    void put_openocd(const std::string& script) const {
        write(path("bin/openocd"), "#!/bin/sh\n" + script);
        std::filesystem::permissions(path("bin/openocd"), std::filesystem::perms::owner_all);
    }
    /// The real OpenOCD, with Tcl in the place of what needs hardware.
    void put_pretended_chip(const std::string& device_word, const std::string& option_word) const {
        write(path("chip.tcl"), "set optr " + option_word + "\nset idcode " + device_word + R"(
proc init {} {}
proc reset {mode} { echo "chip: reset $mode" }
proc read_memory {address width count} {
    global optr idcode
    if {$address == 0xE0042000} { return $idcode }
    if {$address == 0x40022020} { return $optr }
    error "no memory at $address"
}
proc flash {command args} {
    if {$command eq "bank"} { return }
    if {[lindex $args 0] ne "erase"} { error "not erased" }
    if {![file exists [lindex $args 1]]} { error "no such file" }
    echo "chip: write_image $args"
}
proc verify_image {file} { echo "chip: verify_image $file" }
proc stm32l4x {command bank args} {
    global optr
    echo "chip: $command $bank $args"
    if {$command eq "option_write"} {
        set mask [lindex $args 2]
        set optr [expr {($optr & ~$mask & 0xFFFFFFFF) | [lindex $args 1]}]
    }
    if {$command eq "option_load"} { error "the chip was reset meanwhile" }
}
)");
        put_openocd("exec /usr/bin/openocd -f " + path("chip.tcl") + " \"$@\"\n");
    }
    [[nodiscard]] static bool has_openocd() { return std::filesystem::exists("/usr/bin/openocd"); }

  private:
    [[nodiscard]] std::string arguments() const {
        return "flash --rig " + source("hw/rigs/bench_one_board.yaml") + " --node bench --elf " +
               path("image.elf") + " --out " + path("out") + " ";
    }
};

TEST_F(FlashTest, programs_nothing_where_its_files_could_not_be_kept) {
    put_openocd("touch " + path("was_run") + "\n");
    for (const char* name : {"openocd.log", "record.yaml"}) {
        std::filesystem::create_directories(path(std::string("out/") + name));
        EXPECT_THAT(fail_to_flash(),
                    fails_with(73, path_is(path(std::string("out/") + name)), remedy_is(HasSubstr("move"))));
        EXPECT_FALSE(std::filesystem::exists(path("was_run"))) << name;
        std::filesystem::remove_all(path("out"));
    }
}

TEST_F(FlashTest, a_dry_run_does_everything_but_the_adapter) {
    if (!has_openocd()) GTEST_SKIP() << "openocd is not installed";
    const Said said = flash("--dry-run");
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output, AllOf(HasSubstr("fit for nucleo_g474re, 548 bytes"),
                                   HasSubstr("4 sensors, node_hash"), HasSubstr("nothing was programmed")));
    EXPECT_THAT(said.output,
                AllOf(HasSubstr("must contain BOR_LEV 4, BFB2 0, DBANK 1, nSWBOOT0 0, nBOOT0 1\n"),
                      HasSubstr("they would not be written: --write-option-bytes does that")));
    EXPECT_THAT(flash("--dry-run --write-option-bytes").output,
                HasSubstr("0x08000400 would be written under the mask 0x0C100700 (all of these but DBANK)"));
    EXPECT_THAT(content(path("out/record.yaml")), HasSubstr("is_programmed: false"));
    EXPECT_THAT(content(path("out/flash.hex")), HasSubstr(":00000001FF"));
}

TEST_F(FlashTest, scripts_that_lie_in_its_folder_or_in_the_working_directory_are_not_run) {
    if (!has_openocd()) GTEST_SKIP() << "openocd is not installed";
    const std::string trap = "exec touch " + path("was_run") + "\n";
    for (const std::string& folder : {path("out"), path("here")}) {
        for (const char* name : {"board/st_nucleo_g4.cfg", "interface/stlink.cfg", "target/stm32g4x.cfg",
                                 "target/swj-dp.tcl", "mem_helper.tcl", "openocd.cfg"}) {
            std::filesystem::create_directories(std::filesystem::path(folder + "/" + name).parent_path());
            write(folder + "/" + name, trap);
        }
    }
    const Said said = run("cd " + path("here") + " && " OCTOSKIN_PROGRAM " flash --rig " +
                          source("hw/rigs/bench_one_board.yaml") + " --elf " + path("image.elf") + " --out " +
                          path("out") + " --dry-run");
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(content(path("out/openocd.log")), HasSubstr("stm32l4x"));
    EXPECT_FALSE(std::filesystem::exists(path("was_run")));
}

TEST_F(FlashTest, without_an_adapter_it_says_so_in_one_sentence) {
    if (!has_openocd()) GTEST_SKIP() << "openocd is not installed";
    if (run("lsusb -d 0483: ").exit_code == 0) GTEST_SKIP() << "an ST-LINK may be connected";
    const Failure failure = fail_to_flash();
    EXPECT_THAT(failure, fails_with(69, code_is(ErrorCode::no_device), what_is(HasSubstr("no ST-LINK")),
                                    remedy_is(HasSubstr("lsusb"))));
    EXPECT_THAT(failure.output, Not(HasSubstr("Error:")));
    EXPECT_THAT(content(path("out/openocd.log")), HasSubstr("open failed"));
    EXPECT_THAT(fail_to_flash("--adapter-serial 0042003A"),
                fails_with(69, code_is(ErrorCode::no_device), key_is("--adapter-serial"),
                           value_is("0042003A"), remedy_is(HasSubstr("iSerial"))));
}

TEST_F(FlashTest, a_factory_board_is_programmed_and_its_option_bytes_are_told) {
    if (!has_openocd()) GTEST_SKIP() << "openocd is not installed";
    put_pretended_chip("0x20016469", "0xFFEFF8AA");
    const Failure failure = fail_to_flash();
    EXPECT_THAT(
        failure,
        fails_with(1, code_is(ErrorCode::mismatch), value_is("0xFFEFF8AA"),
                   what_is(AllOf(HasSubstr("BOR_LEV is 0, not 4"), HasSubstr("nSWBOOT0 is 1, not 0"))),
                   remedy_is(HasSubstr("--write-option-bytes"))))
        << content(path("out/openocd.log"));
    EXPECT_THAT(failure.output, HasSubstr("programmed, verified, started"));
    EXPECT_THAT(content(path("out/openocd.log")), Not(HasSubstr("option_write")));
    EXPECT_THAT(content(path("out/record.yaml")),
                AllOf(HasSubstr("is_programmed: true"), HasSubstr("flash_optr: 0xffeff8aa")));
}

TEST_F(FlashTest, option_bytes_are_written_when_told_and_read_again) {
    if (!has_openocd()) GTEST_SKIP() << "openocd is not installed";
    put_pretended_chip("0x20016469", "0xFFEFF8AA");
    const Said said = flash("--write-option-bytes");
    EXPECT_EQ(said.exit_code, 0) << said.output << content(path("out/openocd.log"));
    EXPECT_THAT(said.output, HasSubstr("option bytes 0xFBEFFCAA: as required"));
    EXPECT_THAT(content(path("out/openocd.log")),
                AllOf(HasSubstr("chip: option_write 0 0x20 0x08000400 0x0C100700"),
                      HasSubstr("chip: option_load 0")));
}

TEST_F(FlashTest, option_bytes_that_are_right_are_not_written_again) {
    if (!has_openocd()) GTEST_SKIP() << "openocd is not installed";
    put_pretended_chip("0x20016469", "0xFBEFFCAA");
    const Said said = flash("--write-option-bytes");
    EXPECT_EQ(said.exit_code, 0) << said.output << content(path("out/openocd.log"));
    EXPECT_THAT(content(path("out/openocd.log")), Not(HasSubstr("option_write")));
}

TEST_F(FlashTest, nothing_is_written_to_another_chip) {
    if (!has_openocd()) GTEST_SKIP() << "openocd is not installed";
    put_pretended_chip("0x20016468", "0xFFEFF8AA");
    EXPECT_THAT(fail_to_flash("--write-option-bytes"),
                fails_with(69, code_is(ErrorCode::mismatch), what_is(HasSubstr("device id 0x469")),
                           value_is("0x468"), remedy_is(HasSubstr("--adapter-serial"))));
    EXPECT_THAT(content(path("out/openocd.log")),
                AllOf(Not(HasSubstr("write_image")), Not(HasSubstr("option_write"))));
}

TEST_F(FlashTest, what_the_real_one_says_becomes_a_sentence_and_a_code) {
    const struct {
        const char* says;
        int exit_code;
        ErrorCode code;
        const char* what;
        const char* remedy;
    } cases[] = {
        {"Error: libusb_open() failed with LIBUSB_ERROR_ACCESS\\nError: open failed", 77,
         ErrorCode::no_permission, "ST-LINK", "plugdev"},
        {"Error: open failed", 69, ErrorCode::no_device, "no ST-LINK", "lsusb"},
        {"Info : Target voltage: 3.2\\nError: init mode failed (unable to connect to the target)", 69,
         ErrorCode::no_answer, "the chip does not answer", "reset button"},
        {"octoskin: device 0x469\\noctoskin: options 0xFFEFF8AA\\nError: flash write failed", 74,
         ErrorCode::no_device, "programming failed (flash write failed)", "openocd.log"},
    };
    for (const auto& each : cases) {
        put_openocd(std::string("printf '") + each.says + "\\n' >&2\nexit 1\n");
        EXPECT_THAT(fail_to_flash(),
                    fails_with(each.exit_code, code_is(each.code), what_is(HasSubstr(each.what)),
                               remedy_is(HasSubstr(each.remedy))));
        EXPECT_THAT(content(path("out/record.yaml")), HasSubstr("is_programmed: false"));
    }
}

TEST_F(FlashTest, without_openocd_it_names_the_package) {
    EXPECT_THAT(
        failure_in(run("PATH=" + path("bin") + " " OCTOSKIN_PROGRAM " --json-errors flash --dry-run --rig " +
                       source("hw/rigs/bench_one_board.yaml") + " --elf " + path("image.elf") + " --out " +
                       path("out"))),
        fails_with(69, code_is(ErrorCode::no_program), what_is(HasSubstr("openocd")),
                   remedy_is(HasSubstr("apt install openocd"))));
}

TEST_F(FlashTest, a_folder_that_takes_no_files_is_named_with_the_reason_and_a_remedy) {
    write(path("out"), "a file where the folder should be");
    EXPECT_THAT(fail_to_flash("--dry-run"),
                fails_with(73, path_is(path("out")), what_is(HasSubstr("(Not a directory)")),
                           remedy_is(HasSubstr("--out"))));
    std::filesystem::remove(path("out"));
    std::filesystem::create_directories(path("out/flash.hex"));
    EXPECT_THAT(fail_to_flash("--dry-run"),
                fails_with(73, code_is(ErrorCode::already_exists), path_is(path("out/flash.hex")),
                           remedy_is(HasSubstr("move it away"))));
    std::filesystem::remove_all(path("out"));
    std::filesystem::create_directories(path("out"));
    std::filesystem::create_symlink("/dev/full", path("out/flash.cfg"));
    const Said linked = flash("--dry-run");
    EXPECT_EQ(linked.exit_code, 0) << linked.output;
    EXPECT_FALSE(std::filesystem::is_symlink(path("out/flash.cfg")))
        << "a link there is replaced, not followed";
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST_F(FlashTest, bad_input_has_its_code_and_is_never_programmed) {
    put_openocd("touch " + path("was_started") + "\n");
    EXPECT_THAT(failure_of("flash --node nobody --rig " + source("hw/rigs/bench_one_board.yaml")),
                fails_with(64, code_is(ErrorCode::unknown_name), key_is("--node"), value_is("'nobody'")));
    EXPECT_THAT(
        fail_to_flash("--adapter-serial 'a; b'"),
        fails_with(64, code_is(ErrorCode::bad_argument), key_is("--adapter-serial"), value_is("'a; b'")));
    std::filesystem::rename(path("image.elf"), path("aside.elf"));
    EXPECT_THAT(fail_to_flash(), fails_with(66, code_is(ErrorCode::not_found), path_is(path("image.elf"))));
    write(path("image.elf"), content(path("aside.elf")).substr(0, 300));
    EXPECT_THAT(fail_to_flash(), fails_with(65, path_is(path("image.elf"))));
    test::ElfBuilder soft;
    soft.set_attribute(28, 0);
    write(path("image.elf"), soft.text());
    EXPECT_THAT(fail_to_flash(), fails_with(65, code_is(ErrorCode::mismatch), path_is(path("image.elf")),
                                            what_is(HasSubstr("floating-point registers"))));
    EXPECT_THAT(failure_of("flash --rig " + source("tests/data/rigs/metres-for-millimetres.yaml")),
                fails_with(78, file_is("metres-for-millimetres.yaml"), line_is(3)));
    EXPECT_FALSE(std::filesystem::exists(path("was_started")));
}

}  // namespace
}  // namespace octoskin
