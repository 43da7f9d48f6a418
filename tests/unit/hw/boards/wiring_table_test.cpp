// docs/bring-up.md shows the board's pins as a table: it must be the board's file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/unit/hw/boards/shipped_board.hpp"

namespace octoskin::rig {
namespace {

std::string expected_table() {
    std::string text = "\n| Signal | Pin | Connector | Function |\n|---|---|---|---|\n";
    for (const BoardSignal& signal : nucleo().signals) {
        const std::string alternate = signal.alternate ? fmt::format(" (AF{})", *signal.alternate) : "";
        text += fmt::format("| {} | {} | {} | {}{}{} |\n", signal.signal, octoskin::rig::text(signal.pin),
                            signal.connector, signal.function, alternate,
                            signal.is_open_drain ? ", open drain" : "");
    }
    return text;
}

TEST(BringUpDocument, has_the_wiring_table_of_the_boards_file) {
    std::ifstream stream(OCTOSKIN_SOURCE_DIR "/docs/bring-up.md");
    const std::string document{std::istreambuf_iterator<char>(stream), {}};
    const std::string begin = "<!-- wiring table: begin -->";
    const auto from = document.find(begin);
    const auto to = document.find("<!-- wiring table: end -->");
    ASSERT_NE(from, std::string::npos);
    ASSERT_NE(to, std::string::npos);
    EXPECT_EQ(document.substr(from + begin.size(), to - from - begin.size()), expected_table());
}

}  // namespace
}  // namespace octoskin::rig
