// Whole files: the nasty ones in tests/data/candump, and the round trip through the writer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "host/io/candump/foreign_format.hpp"
#include "host/io/candump/log_reader.hpp"
#include "host/io/candump/log_source.hpp"
#include "host/io/candump/log_writer.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::candump {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::is_no_error;
using testing_support::line_is;
using testing_support::no_error;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

const std::filesystem::path kData = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "tests/data/candump";

struct ReadBack {
    std::vector<LogEntry> entries;
    InputCounters<LineFault> inputs;
    std::array<std::uint64_t, 9> first_lines{};
};

ReadBack read_all(const std::filesystem::path& file) {
    auto reader = LogReader::open(file);
    EXPECT_TRUE(reader.has_value());
    ReadBack back;
    while (true) {
        const auto entry = reader->next();
        EXPECT_TRUE(entry.has_value());
        if (!entry || !entry->has_value()) {
            break;
        }
        back.entries.push_back(**entry);
    }
    EXPECT_FALSE(reader->next()->has_value()) << "an end stays an end";
    back.inputs = reader->inputs();
    for (std::size_t i = 0; i < back.first_lines.size(); ++i) {
        back.first_lines[i] = reader->first_line(static_cast<LineFault>(i));
    }
    EXPECT_TRUE(back.inputs.is_balanced());
    EXPECT_EQ(back.inputs.used(), back.entries.size());
    return back;
}

class TemporaryFile {
  public:
    explicit TemporaryFile(const std::string& name)
        : path_(std::filesystem::temp_directory_path() /
                (name + "-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) + "-" +
                 std::to_string(reinterpret_cast<std::uintptr_t>(this)))) {}
    ~TemporaryFile() { std::filesystem::remove(path_); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

TEST(LogReader, reads_every_form_of_a_line) {
    const ReadBack back = read_all(kData / "every-form.log");
    EXPECT_EQ(back.inputs.in(), 10U);
    EXPECT_EQ(back.entries.size(), 10U);
}

TEST(LogReader, tolerates_carriage_returns) {
    const ReadBack back = read_all(kData / "crlf.log");
    ASSERT_EQ(back.entries.size(), 2U);
    EXPECT_EQ(back.entries[1].frame.data[0], 0x2B);
    EXPECT_EQ(back.inputs.rejected(LineFault::blank), 1U);
}

TEST(LogReader, counts_a_line_the_file_ends_in) {
    for (const char* file : {"truncated-in-data.log", "truncated-in-stamp.log"}) {
        const ReadBack back = read_all(kData / file);
        EXPECT_EQ(back.entries.size(), 1U) << file;
        EXPECT_EQ(back.inputs.rejected(LineFault::truncated), 1U) << file;
    }
}

TEST(LogReader, leaves_a_line_cut_between_bytes_to_the_frames_checksum) {
    const ReadBack back = read_all(kData / "cut-between-bytes.log");
    ASSERT_EQ(back.entries.size(), 2U);
    EXPECT_EQ(back.entries[1].frame.payload_len, 2);
}

TEST(LogReader, steps_over_lines_of_other_programs) {
    const ReadBack back = read_all(kData / "foreign-lines.log");
    EXPECT_EQ(back.entries.size(), 1U);
    EXPECT_EQ(back.inputs.rejected(LineFault::foreign), 5U);
}

TEST(LogReader, counts_each_fault_once_with_the_number_of_its_first_line) {
    const ReadBack back = read_all(kData / "every-fault.log");
    EXPECT_TRUE(back.entries.empty());
    for (std::size_t i = 0; i < 9; ++i) {
        EXPECT_EQ(back.inputs.rejected(static_cast<LineFault>(i)), 1U) << names_of(LineFault{})[i];
        EXPECT_EQ(back.first_lines[i], i + 1) << names_of(LineFault{})[i];
    }
}

TEST(LogReader, holds_no_more_of_a_line_without_end_than_its_bound_and_goes_on_after_it) {
    TemporaryFile file("long-line");
    std::ofstream(file.path()) << "(1436509053.850870) vcan0 044#" << std::string(1'000'000, 'A')
                               << "\n(1436509053.850871) vcan0 044#2A\n";
    const ReadBack back = read_all(file.path());
    EXPECT_EQ(back.entries.size(), 1U);
    EXPECT_EQ(back.inputs.rejected(LineFault::too_long), 1U);
    EXPECT_EQ(back.inputs.in(), 2U);
}

TEST(LogReader, takes_the_longest_line_that_is_allowed) {
    TemporaryFile file("edge");
    const std::string line = "(1436509053.850870) vcan0 044#";
    std::ofstream(file.path()) << line << std::string(kLineBytesMax - line.size(), 'A') << "\n"
                               << line << std::string(kLineBytesMax + 1 - line.size(), 'A') << "\n";
    const ReadBack back = read_all(file.path());
    EXPECT_EQ(back.inputs.rejected(LineFault::length), 1U) << "320 bytes are a line, if a bad one";
    EXPECT_EQ(back.inputs.rejected(LineFault::too_long), 1U);
}

TEST(LogReader, says_why_a_file_cannot_be_opened) {
    const auto absent = LogReader::open("/nowhere/can.log");
    ASSERT_FALSE(absent.has_value());
    EXPECT_THAT(absent.error(), AllOf(code_is(ErrorCode::not_found), what_is(HasSubstr("No such file"))));
    EXPECT_EQ(absent.error().file, "/nowhere/can.log");
    EXPECT_TRUE(has_its_fields(absent.error()));
    EXPECT_THAT(LogReader::open(kData).error(), code_is(ErrorCode::wrong_kind_of_file)) << "a directory";
}

TEST(LogSource, gives_the_frames_of_a_log_with_their_stamps_and_then_ends) {
    LogSource source(std::move(LogReader::open(kData / "foreign-lines.log")).value());
    const auto frame = source.next();
    ASSERT_TRUE(frame.has_value() && frame->has_value());
    EXPECT_EQ((*frame)->stamp.ns, 1'436'509'053'850'870'000);
    EXPECT_EQ((*frame)->frame.can_id, 0x44U);
    EXPECT_FALSE(source.next()->has_value());
    EXPECT_EQ(source.reader().inputs().rejected(LineFault::foreign), 5U);
}

TEST(LogWriter, writes_a_log_that_reads_back_equal) {
    TemporaryFile file("round-trip");
    const ReadBack expected = read_all(kData / "every-form.log");
    auto writer = LogWriter::create(file.path(), "vcan0");
    ASSERT_TRUE(writer.has_value());
    for (const LogEntry& entry : expected.entries) {
        ASSERT_TRUE(writer->write(entry.stamp, entry.frame).has_value());
    }
    ASSERT_TRUE(writer->close().has_value());
    const ReadBack back = read_all(file.path());
    ASSERT_EQ(back.entries.size(), 10U);
    for (std::size_t i = 0; i < 10; ++i) {
        EXPECT_EQ(back.entries[i].frame, expected.entries[i].frame);
        EXPECT_EQ(back.entries[i].stamp, expected.entries[i].stamp);
        EXPECT_EQ(back.entries[i].interface, "vcan0");
    }
}

TEST(LogWriter, reports_a_full_disk) {
    if (!std::filesystem::exists("/dev/full")) {
        GTEST_SKIP() << "no /dev/full here";
    }
    auto writer = LogWriter::create("/dev/full");
    ASSERT_TRUE(writer.has_value());
    const auto written = writer->write({0}, {.can_id = 1});
    EXPECT_FALSE(written.has_value() && writer->close().has_value());
}

TEST(LogWriter, makes_no_log_whose_lines_could_be_read_in_two_ways) {
    for (const char* name : {"can#0", "123#00", "a b", "", "sixteen_letters_", "can\t0", "can\x80"}) {
        TemporaryFile file("refused");
        EXPECT_THAT(error_in(LogWriter::create(file.path(), name)),
                    AllOf(code_is(ErrorCode::bad_name), value_is("'" + std::string(name) + "'")));
        EXPECT_FALSE(std::filesystem::exists(file.path())) << name;
    }
}

TEST(LogWriter, says_why_a_file_cannot_be_created) {
    const auto writer = LogWriter::create("/nowhere/can.log");
    ASSERT_FALSE(writer.has_value());
    EXPECT_THAT(writer.error(), AllOf(code_is(ErrorCode::not_found), what_is(HasSubstr("No such file"))));
    EXPECT_EQ(writer.error().file, "/nowhere/can.log");
}

/// The reader's error for a file with this text after it was read to its end; `no_error` if there is none.
Error foreign(const std::string& text) {
    const testing_support::ScratchFolder folder;
    auto reader = LogReader::open(folder.write("can.log", text));
    EXPECT_TRUE(reader.has_value());
    while (reader->next()->has_value()) {
    }
    return reader->foreign_file().value_or(no_error());
}

std::vector<std::int64_t> stamps_us(const std::string& text) {
    const testing_support::ScratchFolder folder;
    std::vector<std::int64_t> stamps;
    for (const LogEntry& entry : read_all(folder.write("can.log", text)).entries)
        stamps.push_back(entry.stamp.ns / 1000);
    return stamps;
}

TEST(LogReader, adds_differences_up_and_leaves_times_since_the_first_frame_alone) {
    const std::string of_t_d =
        "(000.000000) can0 044#\n(000.000270) can0 044#\n(000.010000) can0 044#\n(000.000270) can0 044#\n"
        "(bad) can0 044#\n(001.000000) can0 044#\n";
    EXPECT_EQ(stamps_us(of_t_d), (std::vector<std::int64_t>{0, 270, 10'270, 10'540, 1'010'540}));
    const std::string of_t_z =
        "(000.000000) can0 044#\n(000.000270) can0 044#\n(000.010270) can0 044#\n(000.010270) can0 044#\n";
    EXPECT_EQ(stamps_us(of_t_z), (std::vector<std::int64_t>{0, 270, 10'270, 10'270}));
    const std::string of_a_clock_set_back =
        "(1750000000.000000) can0 044#\n(1749999998.000270) can0 044#\n(1750000001.000000) can0 044#\n";
    EXPECT_EQ(stamps_us(of_a_clock_set_back).at(1), 1'749'999'998'000'270);
}

TEST(LogReader, differences_that_leave_63_bits_of_nanoseconds_are_no_times) {
    const std::string far = "(9223372035.999999) can0 044#\n";
    const std::string text = "(000.000000) can0 044#\n" + far + "(000.000002) can0 044#\n" + far + far +
                             "(000.000001) can0 044#\n";
    const std::int64_t after_us = 9'223'372'035'999'999;
    EXPECT_EQ(stamps_us(text), (std::vector<std::int64_t>{0, after_us, after_us + 2, after_us + 3}));
}

TEST(LogReader, one_frame_out_of_order_does_not_make_differences_of_times) {
    std::string text = "(000.000000) can0 044#\n(000.000300) can1 044#\n(000.000299) can0 044#\n";
    for (int i = 3; i < 50; ++i) text += "(000.0" + std::to_string(10'000 + i) + ") can0 044#\n";
    EXPECT_EQ(stamps_us(text).at(49), 10'049);
}

TEST(LogReader, reads_utf_16_as_powershell_writes_it) {
    std::string bytes = "\xFF\xFE";
    for (const char c : std::string("(1.000000) can0 044#2A\r\n(1.000001) can0 044#2B\r\n"))
        bytes += {c, '\0'};
    EXPECT_EQ(stamps_us(bytes), (std::vector<std::int64_t>{1'000'000, 1'000'001}));
    EXPECT_EQ(stamps_us("\xEF\xBB\xBF(1.000000) can0 044#2A\n"), (std::vector<std::int64_t>{1'000'000}));
}

struct Foreign {
    const char* name;
    const char* command;  ///< how it begins
    std::string text;
};
const Foreign kForeign[] = {
    {"Vector ASC", "asc2log -I can.log -O candump.log",
     "date Mon Jun 30 15:02:57.000 2025\nbase hex  timestamps absolute\n 0.1 1  44  Rx   d 1 2A\n"},
    {"Vector BLF", "can_logconvert can.log candump.log", std::string("LOGG\x90\0\0\0\1\2\n\3\n", 13)},
    {"PEAK TRC", "can_logconvert can.log candump.log", ";$FILEVERSION=1.1\n;   Start time: 1.2.2025\n"},
    {"ASAM MDF", "can_logconvert can.log candump.log", std::string("MDF     4.10\0\n", 14)},
    {"python-can CSV", "can_logconvert", "timestamp,arbitration_id,extended,remote,error,dlc,data\n"},
    {"python-can SQLite", "can_logconvert", "SQLite format 3\n"},
    {"gzip", "zcat can.log > candump.log", "\x1F\x8B\x08\n"},
    {"BUSMASTER", "awk",
     "***BUSMASTER Ver 2.4.0***\r\n***HEX***\r\n22:20:14:992 Rx 0 0000021A s 2 FE 36 \r\n"
     "22:20:15:2 Tx 0 0x12345678 x 1 07\r\n"},
    {"CRTD", "awk",
     "166.064000 CXX a log\n80414.992000 R11 0000021A FE 36 \n80415.002000 1T29 12345678 07\n"},
    {"GVRET CSV", "awk",
     "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3\n80414992000,0000021A,false,Rx,0,2,FE,36,00,\n"
     "80415002000,12345678,true,Tx,0,1,07,00,00,\n"},
};

TEST(LogFile, of_another_program_is_named_with_the_command_that_converts_it) {
    for (const Foreign& file : kForeign) {
        const Error error = foreign(file.text);
        EXPECT_THAT(error, AllOf(code_is(ErrorCode::foreign_format), file_is("can.log"),
                                 what_is(EndsWith(std::string(" ") + file.name)),
                                 remedy_is(HasSubstr(std::string(": ") + file.command))));
        EXPECT_TRUE(has_its_fields(error));
    }
}

TEST(LogFile, of_another_program_is_what_it_was_behind_the_command_if_that_is_awks) {
    const std::vector<LogEntry> expected{
        {{80'414'992'000'000}, "can0", {.can_id = 0x21A, .payload_len = 2, .data = {0xFE, 0x36}}},
        {{80'415'002'000'000},
         "can0",
         {.can_id = 0x12345678, .is_extended = true, .payload_len = 1, .data = {7}}}};
    for (const Foreign& file : kForeign) {
        if (file.command != std::string("awk")) continue;
        const testing_support::ScratchFolder folder;
        // Names that have in them what a command has in their places.
        const auto in = folder.write("IN_to_OUT", file.text);
        const auto out = folder / "OUT_of_IN";
        const std::string command = conversion(*foreign_format_of(file.text), in.string(), out.string());
        ASSERT_EQ(std::system(command.c_str()), 0) << command;
        EXPECT_EQ(read_all(out).entries, expected) << file.name << "\n" << command;
    }
}

TEST(LogFile, of_which_no_line_is_a_frame_says_how_to_record_one) {
    const std::string seen = "  can0  141   [8]  01 02 03 04 05 06 07 08\n";  // what candump shows without -L
    const Error error = foreign("\n" + seen + seen);
    EXPECT_THAT(error, AllOf(code_is(ErrorCode::foreign_format), file_is("can.log"), line_is(2),
                             what_is(HasSubstr("a time in parentheses")),
                             value_is("'  can0  141   [8]  01 02 03 04 05 06 07 08'"),
                             remedy_is(HasSubstr("`candump -L can0 > can.log`"))));
    EXPECT_TRUE(has_its_fields(error));
    EXPECT_THAT(foreign(seen + "(1436509053.850870) vcan0 044#2A\n"), is_no_error());
    EXPECT_THAT(foreign(""), is_no_error()) << "an empty log is a log";
    EXPECT_THAT(foreign("\n\n"), is_no_error());
}

}  // namespace
}  // namespace octoskin::candump
