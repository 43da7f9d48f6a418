#include "hw/image/flash_contents.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <sstream>

#include "hw/rigfile/rig.hpp"
#include "tests/support/image/elf_builder.hpp"
#include "tests/unit/hw/boards/shipped_board.hpp"

namespace octoskin::image {
namespace {

NodeConfig bench_node() {
    const auto rig = rig::read_rig(OCTOSKIN_SOURCE_DIR "/hw/rigs/bench_one_board.yaml");
    if (!rig) throw std::runtime_error(rig.error().message());
    return rig->nodes.at(0).config;
}

/// A reader by the letter of Intel's specification, written apart from the writer.
std::map<std::uint32_t, std::uint8_t> read_hex(const std::string& text) {
    std::map<std::uint32_t, std::uint8_t> memory;
    std::istringstream lines(text);
    std::uint32_t upper = 0;
    bool has_ended = false;
    for (std::string line; std::getline(lines, line);) {
        EXPECT_FALSE(has_ended) << "a record after the last one";
        EXPECT_EQ(line.at(0), ':');
        std::vector<std::uint32_t> bytes;
        std::uint32_t sum = 0;
        for (std::size_t i = 1; i < line.size(); i += 2)
            sum += bytes.emplace_back(static_cast<std::uint32_t>(std::stoul(line.substr(i, 2), nullptr, 16)));
        EXPECT_EQ(sum & 0xFFU, 0U) << line;
        EXPECT_EQ(bytes.size(), bytes[0] + 5U) << line;
        const std::uint32_t address = bytes[1] << 8U | bytes[2];
        if (bytes[3] == 4) upper = (bytes[4] << 8U | bytes[5]) << 16U;
        if (bytes[3] == 1) has_ended = true;
        for (std::uint32_t i = 0; bytes[3] == 0 && i < bytes[0]; ++i) {
            EXPECT_LE(address + i, 0xFFFFU) << "a record that crosses a 64 KiB line";
            EXPECT_TRUE(memory.emplace(upper + address + i, bytes[4 + i]).second) << "a byte twice";
        }
    }
    EXPECT_TRUE(has_ended);
    return memory;
}

TEST(IntelHex, is_as_the_specification_has_it) {
    // The example of the specification's own arithmetic: 0x100 - (02+00+00+04+08+07) = 0xEB, and so on.
    EXPECT_EQ(intel_hex({{0x0807'FFFE, {0x12, 0x34}}}),
              ":020000040807EB\n"
              ":02FFFE001234BB\n"
              ":00000001FF\n");
    EXPECT_EQ(intel_hex({}), ":00000001FF\n");
}

TEST(IntelHex, a_part_over_a_64_kib_line_reads_back) {
    std::mt19937 random(20261121);
    for (const std::uint32_t start : {0x0800'FFF0U, 0x0800'FFF1U, 0x0800'FFFFU, 0x0800'0000U}) {
        for (const std::size_t size : {1U, 15U, 16U, 17U, 33U, 70'000U}) {
            FlashPart part{start, {}};
            for (std::size_t i = 0; i < size; ++i) part.bytes.push_back(static_cast<std::uint8_t>(random()));
            const auto memory = read_hex(intel_hex({part, {0x0807'F800, {7}}}));
            ASSERT_EQ(memory.size(), size + 1);
            for (std::uint32_t i = 0; i < size; ++i) ASSERT_EQ(memory.at(start + i), part.bytes[i]);
            EXPECT_EQ(memory.at(0x0807'F800), 7);
        }
    }
}

TEST(FlashContents, are_the_image_and_the_nodes_block) {
    test::ElfBuilder builder;
    builder.segments[1].physical_address += 5;  // a gap
    const auto image = ElfImage::parse(builder.bytes());
    ASSERT_TRUE(image);
    const NodeConfig config = bench_node();
    const FlashContents contents = merge(*image, config, rig::nucleo());
    ASSERT_EQ(contents.size(), 2U);
    EXPECT_EQ(contents[0].address, 0x0800'0000U);
    // 536 of program, a gap of 5, 12 of data, up to a multiple of 8.
    ASSERT_EQ(contents[0].bytes.size(), 560U);
    EXPECT_EQ(contents[0].bytes[527], 0xBF);
    for (std::size_t gap = 536; gap < 541; ++gap) EXPECT_EQ(contents[0].bytes[gap], 0xFF);
    EXPECT_EQ(contents[0].bytes[541], 1);
    EXPECT_EQ(contents[0].bytes[552], 12);
    for (std::size_t end = 553; end < 560; ++end) EXPECT_EQ(contents[0].bytes[end], 0xFF);

    EXPECT_EQ(contents[1].address, 0x0807'F800U);
    EXPECT_EQ(contents[1].bytes.size() % 8, 0U);
    EXPECT_EQ(std::string(contents[1].bytes.begin(), contents[1].bytes.begin() + 4), "OSKC");
    const auto decoded = decode_node_config(contents[1].bytes);
    ASSERT_TRUE(decoded);
    EXPECT_EQ(*decoded, config);
}

TEST(FlashContents, the_binary_is_the_image_alone) {
    const auto image = ElfImage::parse(test::ElfBuilder().bytes());
    ASSERT_TRUE(image);
    EXPECT_EQ(binary(*image, rig::nucleo()).size(), 548U);  // no filling at the end: as objcopy does
}

}  // namespace
}  // namespace octoskin::image
