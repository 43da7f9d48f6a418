// docs/bring-up.md shows the board's pins as a table, which must be the board's file, and has a remedy for
// every name of a fault.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>

#include "common/wire/names.hpp"
#include "tests/unit/hw/boards/shipped_board.hpp"

namespace octoskin::rig {
namespace {

std::string expected_table() {
    std::string text = "\n| Signal | Pin | Connector | Function |\n|---|---|---|---|\n";
    for (const BoardSignal& signal : nucleo().signals) {
        const std::string alternate = signal.alternate ? fmt::format(" (AF{})", *signal.alternate) : "";
        text +=
            fmt::format("| {} | {} | {} | {}{}{}{} |\n", signal.signal, octoskin::rig::text(signal.pin),
                        signal.connector, signal.function, alternate,
                        signal.is_open_drain ? ", open drain" : "", signal.is_pulled_up ? ", pulled up" : "");
    }
    return text;
}

std::string document() {
    std::ifstream stream(OCTOSKIN_SOURCE_DIR "/docs/bring-up.md");
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Every name of the table but the harmless ones is in `part`, as code.
template <class Table>
void expect_names(const std::string& part, const Table& table, const std::set<std::string>& harmless) {
    for (const auto& [value, name] : table) {
        if (harmless.contains(name)) continue;
        EXPECT_NE(part.find(fmt::format("`{}`", name)), std::string::npos) << name;
    }
}

TEST(BringUpDocument, has_a_remedy_for_every_fault_by_its_name_on_the_wire) {
    const std::string text = document();
    const auto from = text.find("## When something is missing");
    const auto to = text.find("## Bench procedures");
    ASSERT_LT(from, to);
    ASSERT_NE(to, std::string::npos);
    const std::string remedies = text.substr(from, to - from);
    expect_names(remedies, wire::tables::kNodeState, {"ranging"});
    expect_names(remedies, wire::tables::kFaultKind, {"none", "unknown"});
    expect_names(remedies, wire::tables::kSensorState, {"starting", "ranging"});
    expect_names(remedies, wire::tables::kSensorFault, {"none"});
}

TEST(BringUpDocument, has_the_wiring_table_of_the_boards_file) {
    const std::string text = document();
    const std::string begin = "<!-- wiring table: begin -->";
    const auto from = text.find(begin);
    const auto to = text.find("<!-- wiring table: end -->");
    ASSERT_NE(from, std::string::npos);
    ASSERT_NE(to, std::string::npos);
    EXPECT_EQ(text.substr(from + begin.size(), to - from - begin.size()), expected_table());
}

}  // namespace
}  // namespace octoskin::rig
