// docs/hardware/wiring.md shows the board's pins as a table, which must equal the board's file;
// docs/hardware/fault-table.md has a remedy for every name of a fault.
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

std::string document(const std::string& name) {
    std::ifstream stream(OCTOSKIN_SOURCE_DIR "/docs/hardware/" + name);
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

TEST(FaultTableDocument, has_a_remedy_for_every_fault_by_its_name_on_the_wire) {
    const std::string text = document("fault-table.md");
    const auto from = text.find("## Node and bus");
    const auto to = text.find("## Registers that read back differently");
    ASSERT_LT(from, to);
    ASSERT_NE(to, std::string::npos);
    const std::string remedies = text.substr(from, to - from);
    expect_names(remedies, wire::tables::kNodeState, {"ranging"});
    expect_names(remedies, wire::tables::kFaultKind, {"none", "unknown"});
    expect_names(remedies, wire::tables::kSensorState, {"starting", "ranging"});
    expect_names(remedies, wire::tables::kSensorFault, {"none"});
}

TEST(WiringDocument, has_the_wiring_table_of_the_boards_file) {
    const std::string text = document("wiring.md");
    const std::string begin = "<!-- wiring table: begin -->";
    const auto from = text.find(begin);
    const auto to = text.find("<!-- wiring table: end -->");
    ASSERT_NE(from, std::string::npos);
    ASSERT_NE(to, std::string::npos);
    EXPECT_EQ(text.substr(from + begin.size(), to - from - begin.size()), expected_table());
}

}  // namespace
}  // namespace octoskin::rig
