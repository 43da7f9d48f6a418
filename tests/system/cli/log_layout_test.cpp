// One log in every layout that people's programs write: the same map, or a refusal that says what to do.
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <functional>
#include <regex>
#include <vector>

#include "host/io/candump/log_reader.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using candump::LogEntry;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::what_is;

std::vector<LogEntry> entries_of(const std::string& file) {
    auto reader = candump::LogReader::open(file);
    EXPECT_TRUE(reader);
    std::vector<LogEntry> entries;
    while (true) {  // ends with the file
        const auto entry = reader->next();
        if (!entry || !*entry) return entries;
        entries.push_back(**entry);
    }
}

std::string compact(const LogEntry& entry) {
    const std::string line = candump::format_line(entry);
    return line.substr(line.find(' ') + 1);
}

/// As candump shows it on a screen, without its time.
std::string shown(const LogEntry& entry) {
    const wire::CanFrame& frame = entry.frame;
    const std::string length =
        frame.is_fd ? fmt::format("[{:02}]", frame.payload_len) : fmt::format(" [{}]", frame.payload_len);
    std::string line = fmt::format(" {}  {:03X}  {} ", entry.interface, frame.can_id, length);
    for (const std::uint8_t byte : frame.payload()) line += fmt::format(" {:02X}", byte);
    return line + "\n";
}

class LogLayout : public ProgramTest {
  protected:
    void SetUp() override {
        record_short("rec");
        std::filesystem::remove(path("rec/depth.oni"));
        std::filesystem::remove(path("rec/depth.epoch.yaml"));
        entries_ = entries_of(path("rec/can.log"));
        ASSERT_GT(entries_.size(), 500U);
        ASSERT_EQ(octoskin("replay " + path("rec")).exit_code, 0);
        map_ = content(path("rec/maps/proximity.ot"));
        ASSERT_GT(map_.size(), 500U);
    }
    /// The recording with this line for each entry in place of its own.
    void rewrite(const std::function<std::string(const LogEntry&)>& line) {
        std::string log;
        for (const LogEntry& entry : entries_) log += line(entry);
        write(path("rec/can.log"), log);
    }
    std::uint64_t used_readings() {
        std::smatch found;
        const Said said = octoskin("replay " + path("rec") + " --out " + path("out"));
        const std::regex row(R"(readings +\d+ in = (\d+) used)");
        EXPECT_TRUE(std::regex_search(said.output, found, row)) << said.output;
        return found.empty() ? 0 : std::stoull(found[1]);
    }
    void expect_the_same_map(const std::string& what) {
        const Said said = octoskin("replay " + path("rec"));
        EXPECT_EQ(said.exit_code, 0) << what << "\n" << said.output;
        EXPECT_EQ(content(path("rec/maps/proximity.ot")), map_) << what;
    }

    std::vector<LogEntry> entries_;
    std::string map_;
};

TEST_F(LogLayout, of_candump_is_read_whichever_it_is) {
    const auto us = [](const LogEntry& entry) { return entry.stamp.ns / 1000; };
    const auto seconds = [](std::int64_t time_us, int digits) {
        return fmt::format("({:0{}}.{:06})", time_us / 1'000'000, digits, time_us % 1'000'000);
    };
    const std::int64_t first = us(entries_.front());
    rewrite([&](const LogEntry& e) { return " " + seconds(us(e), 10) + " " + shown(e); });
    expect_the_same_map("candump -t a");
    rewrite([&](const LogEntry& e) { return " " + seconds(us(e) - first, 3) + " " + shown(e); });
    expect_the_same_map("candump -t z");
    std::int64_t before = first;
    rewrite([&](const LogEntry& e) {
        return " " + seconds(us(e) - std::exchange(before, us(e)), 3) + " " + shown(e);
    });
    expect_the_same_map("candump -t d");
    before = first;
    rewrite([&](const LogEntry& e) {
        return seconds(us(e) - std::exchange(before, us(e)), 3) + " " + compact(e);
    });
    expect_the_same_map("differences in compact lines");
    rewrite([&](const LogEntry& e) {
        const std::chrono::sys_seconds whole{std::chrono::seconds(us(e) / 1'000'000)};
        return fmt::format("({:%Y-%m-%d %H:%M:%S}.{:06}) ", whole, us(e) % 1'000'000) + compact(e);
    });
    expect_the_same_map("candump -t A");
    rewrite([&](const LogEntry& e) {
        return fmt::format("({}.{:08}) ", us(e) / 1'000'000, us(e) % 1'000'000 * 100) + compact(e);
    });
    expect_the_same_map("8 decimals");
    rewrite([&](const LogEntry& e) {
        std::string line = seconds(us(e), 10) + "  " + compact(e);
        line.insert(line.size() - 1, "  R ");
        return line;
    });
    expect_the_same_map("blanks and a direction");
    std::string utf_16 = "\xFF\xFE";
    for (const LogEntry& e : entries_) {
        for (const char c : seconds(us(e), 10) + " " + compact(e)) utf_16 += {c, '\0'};
    }
    write(path("rec/can.log"), utf_16);
    expect_the_same_map("UTF-16");
}

TEST_F(LogLayout, of_others_is_refused_with_the_line_or_the_command) {
    rewrite([](const LogEntry& e) { return " " + shown(e); });
    EXPECT_THAT(failure_of("replay " + path("rec")),
                fails_with(65, code_is(ErrorCode::foreign_format), path_is(path("rec/can.log")), line_is(1),
                           what_is(HasSubstr("does not begin with a time in parentheses"))));
    write(path("rec/can.log"), "date Mon Jun 30 15:02:57 2025\nbase hex  timestamps absolute\n");
    EXPECT_THAT(failure_of("replay " + path("rec")),
                fails_with(65, code_is(ErrorCode::foreign_format), path_is(path("rec/can.log")),
                           remedy_is(HasSubstr("asc2log -I can.log -O candump.log"))));
}

TEST_F(LogLayout, of_stamps_in_batches_up_to_16_ms_loses_nothing_and_names_what_mends_it) {
    const std::uint64_t used = used_readings();
    ASSERT_GT(used, 100U);
    const auto batched = [&](std::int64_t step_ns, bool is_up) {
        rewrite([&](const LogEntry& e) {
            LogEntry late = e;
            late.stamp.ns = (e.stamp.ns + (is_up ? step_ns - 1 : 0)) / step_ns * step_ns;
            return candump::format_line(late);
        });
    };
    for (const std::int64_t ms : {10, 16}) {
        for (const bool is_up : {true, false}) {
            batched(ms * 1'000'000, is_up);
            EXPECT_GE(used_readings(), used * 98 / 100) << ms << is_up;
            const Said said = octoskin("replay " + path("rec"));
            EXPECT_THAT(said.output, HasSubstr(fmt::format("in steps of {} ms", ms)));
            EXPECT_THAT(said.output, HasSubstr("latency_timer"));
        }
    }
    batched(1'000'000'000, true);
    const Said seconds = octoskin("replay " + path("rec"));
    EXPECT_THAT(seconds.output, HasSubstr("latency_timer"));
    EXPECT_THAT(seconds.output, HasSubstr("over 16 ms"));
}

}  // namespace
}  // namespace octoskin
