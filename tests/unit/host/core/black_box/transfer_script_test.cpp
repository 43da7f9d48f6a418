// The text that a dump becomes. Whether the driver runs on it: tests/sim/reliability/black_box_test.cpp.
#include "host/core/black_box/transfer_script.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/wire/black_box.hpp"

namespace octoskin {
namespace {

Dump dump_of(const std::vector<std::uint8_t>& transfers, bool is_complete = true) {
    const auto length = static_cast<std::uint16_t>(4 + transfers.size());
    const auto header = wire::encode(wire::DumpHeader{.length = length, .frozen = NodeTime{2'000}});
    Dump dump{.node = 5, .bus = 1, .number = 3, .bytes = {}, .is_complete = is_complete};
    for (const std::uint8_t byte : header) dump.bytes.push_back(byte);
    for (const std::uint8_t byte : transfers) dump.bytes.push_back(byte);
    return dump;
}

// By hand, byte for byte as docs/protocol.md has them.
const std::vector<std::uint8_t> kTransfers = {
    0xE8, 0x03, 0, 0, 0x29, 0, 2, 2,  0x01, 0x0F, 0xEA, 0xCC,  // 1000 us, identification, done
    0x4C, 0x04, 0, 0, 0x29, 2, 3, 0,  0x00, 0x01, 0x30,        // 1100 us, new address, nack_data
    0xB0, 0x04, 0, 0, 0x30, 3, 2, 17, 0x00, 0x89,              // 1200 us, result at the new address, timeout
};

TEST(TransferScript, is_one_line_a_transfer_in_the_language_of_the_test_scripts) {
    EXPECT_EQ(transfer_script(dump_of(kTransfers)),
              "# node 5, I2C bus 1, dump 3: recorded until 2000 us\n"
              "ADDRESS 29\n"
              "R 010F 2 -> EA CC  # 1000 us, +0\n"
              "W 0001 30 ! nack_data  # 1100 us, +100\n"
              "ADDRESS 30\n"
              "R 0089 17 ! timeout  # 1200 us, +100\n");
}

TEST(TransferScript, says_where_a_dump_was_cut_off_and_keeps_what_is_whole) {
    const std::string whole = transfer_script(dump_of(kTransfers));
    for (std::size_t kept = 0; kept < kTransfers.size(); ++kept) {
        const std::string text = transfer_script(
            dump_of({kTransfers.begin(), kTransfers.begin() + static_cast<int>(kept)}, false));
        const std::size_t last = text.rfind("# the rest never came: ");
        ASSERT_NE(last, std::string::npos) << kept;
        EXPECT_TRUE(text.ends_with(" pieces did, of 20 a second; keep candump running\n")) << kept;
        const std::string transfers = text.substr(0, last);
        EXPECT_EQ(whole.substr(0, transfers.size()), transfers) << kept;
    }
    Dump tiny = dump_of({});
    tiny.bytes.resize(5);
    EXPECT_EQ(transfer_script(tiny),
              "# node 5, I2C bus 1: the rest never came: 1 of an unknown number of pieces did, of 20 a "
              "second; keep "
              "candump running\n");
}

TEST(TransferScript, says_how_much_of_a_dump_came) {
    Dump cut = dump_of(kTransfers, false);
    ASSERT_EQ(cut.bytes.size(), 39U);
    cut.bytes.resize(15);
    const std::string text = transfer_script(cut);
    EXPECT_NE(text.find("the rest never came: 3 of 8 pieces did"), std::string::npos) << text;
}

TEST(TransferScript, calls_an_impossible_transfer_damaged) {
    for (const auto& [at, value] : {std::pair<std::size_t, int>{4, 0x80}, {5, 6}, {5, 255}}) {
        auto damaged = kTransfers;
        damaged.at(at) = static_cast<std::uint8_t>(value);
        EXPECT_TRUE(transfer_script(dump_of(damaged)).ends_with("# the rest is damaged\n"));
    }
}

TEST(TransferScript, makes_a_comment_of_a_transfer_that_the_language_does_not_have) {
    EXPECT_EQ(transfer_script(dump_of({0, 0, 0, 0, 0x29, 0, 1, 0, 0x55})),
              "# node 5, I2C bus 1, dump 3: recorded until 2000 us\n"
              "ADDRESS 29\n"
              "# not of our driver: wrote 55, read 0 bytes  # 0 us, +0\n");
}

TEST(TransferScript, survives_any_bytes) {
    std::mt19937 random(3);
    for (int i = 0; i < 20'000; ++i) {
        std::vector<std::uint8_t> bytes(random() % 200);
        for (auto& byte : bytes)
            byte = static_cast<std::uint8_t>(random() % 8 == 0 ? random() : random() % 4);
        Dump dump = dump_of({});
        dump.bytes = bytes;
        dump.is_complete = i % 2 == 0;
        EXPECT_FALSE(transfer_script(dump).empty());
    }
}

}  // namespace
}  // namespace octoskin
