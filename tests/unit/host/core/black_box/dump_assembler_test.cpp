// How pieces of dumps find together, and what becomes of those that do not.
#include "host/core/black_box/dump_assembler.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "common/wire/black_box.hpp"

namespace octoskin {
namespace {

/// A dump of `bytes` bytes behind its length, each its own number modulo 256.
std::vector<std::uint8_t> dump_bytes(std::uint16_t bytes) {
    std::vector<std::uint8_t> all(2U + bytes);
    std::iota(all.begin(), all.end(), std::uint8_t{0});
    const auto header = wire::encode(wire::DumpHeader{.length = bytes, .frozen = NodeTime{99}});
    std::copy(header.begin(), header.end(), all.begin());
    return all;
}
std::vector<wire::BlackBox> pieces_of(const std::vector<std::uint8_t>& bytes, std::uint8_t bus,
                                      std::uint8_t dump) {
    std::vector<wire::BlackBox> pieces;
    for (std::size_t at = 0; at < bytes.size(); at += 5) {
        wire::BlackBox piece{.bus = bus, .dump = dump, .index = static_cast<std::uint16_t>(at / 5)};
        for (std::size_t i = 0; i < 5 && at + i < bytes.size(); ++i) piece.bytes.at(i) = bytes[at + i];
        pieces.push_back(piece);
    }
    return pieces;
}

TEST(DumpAssembler, ends_a_dump_of_any_length_with_its_last_piece) {
    for (std::uint16_t length = 4; length < 1'600; ++length) {
        const auto bytes = dump_bytes(length);
        const auto pieces = pieces_of(bytes, 3, 2);
        DumpAssembler assembler;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const auto dump = assembler.take(7, pieces[i]);
            ASSERT_EQ(dump.has_value(), i + 1 == pieces.size()) << length;
            if (!dump) continue;
            EXPECT_TRUE(dump->is_complete);
            EXPECT_EQ(dump->node, 7);
            EXPECT_EQ(dump->bus, 3);
            EXPECT_EQ(dump->number, 2);
            EXPECT_EQ(dump->bytes, bytes);
        }
        EXPECT_TRUE(assembler.finish().empty());
    }
}

TEST(DumpAssembler, keeps_the_dumps_of_two_nodes_apart) {
    const auto a = pieces_of(dump_bytes(100), 0, 0);
    const auto b = pieces_of(dump_bytes(100), 1, 1);
    DumpAssembler assembler;
    std::size_t complete = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (const auto dump = assembler.take(1, a[i])) complete += dump->is_complete ? 1U : 0U;
        if (const auto dump = assembler.take(2, b[i])) complete += dump->is_complete ? 1U : 0U;
    }
    EXPECT_EQ(complete, 2U);
}

TEST(DumpAssembler, gives_what_came_before_a_gap_and_ignores_what_follows_it) {
    const auto bytes = dump_bytes(100);
    const auto pieces = pieces_of(bytes, 0, 0);
    for (std::size_t lost = 1; lost < pieces.size() - 1; ++lost) {
        DumpAssembler assembler;
        std::vector<Dump> dumps;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            if (i == lost) continue;
            if (const auto dump = assembler.take(1, pieces[i])) dumps.push_back(*dump);
        }
        ASSERT_EQ(dumps.size(), 1U) << lost;
        EXPECT_FALSE(dumps[0].is_complete);
        EXPECT_EQ(dumps[0].bytes,
                  std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + 5 * static_cast<int>(lost)));
        EXPECT_TRUE(assembler.finish().empty());
    }
}

TEST(DumpAssembler, gives_up_a_dump_when_another_begins_or_the_log_ends) {
    const auto first = pieces_of(dump_bytes(100), 0, 0);
    const auto second = pieces_of(dump_bytes(100), 0, 1);
    DumpAssembler assembler;
    EXPECT_FALSE(assembler.take(1, first[0]));
    EXPECT_FALSE(assembler.take(1, first[1]));
    const auto given_up = assembler.take(1, second[0]);
    ASSERT_TRUE(given_up);
    EXPECT_FALSE(given_up->is_complete);
    EXPECT_EQ(given_up->bytes.size(), 10U);
    const auto rest = assembler.finish();
    ASSERT_EQ(rest.size(), 1U);
    EXPECT_EQ(rest[0].number, 1);
    EXPECT_FALSE(rest[0].is_complete);
}

}  // namespace
}  // namespace octoskin
