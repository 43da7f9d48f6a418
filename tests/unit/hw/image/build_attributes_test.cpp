#include "hw/image/build_attributes.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/image/elf_builder.hpp"

namespace octoskin::image {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A section with these file attributes of the vendor "aeabi".
Bytes section(const Bytes& attributes) {
    const auto file_size = static_cast<std::uint8_t>(5 + attributes.size());
    const auto part_size = static_cast<std::uint8_t>(4 + 6 + file_size);
    const Bytes head = {'A', part_size, 0, 0, 0, 'a', 'e', 'a', 'b', 'i', 0, 1, file_size, 0, 0, 0};
    Bytes bytes;
    for (const Bytes& part : {head, attributes}) {
        for (const std::uint8_t byte : part) bytes.push_back(byte);
    }
    return bytes;
}

TEST(BuildAttributes, are_as_readelf_shows_them) {
    const auto attributes = build_attributes(test::ElfBuilder().attributes);
    ASSERT_TRUE(attributes);
    const std::map<std::uint32_t, std::uint32_t> expected = {{6, 13}, {7, 'M'}, {9, 2},  {10, 6}, {18, 4},
                                                             {20, 1}, {21, 1},  {23, 3}, {24, 1}, {26, 1},
                                                             {27, 1}, {28, 1},  {30, 4}, {34, 1}};
    EXPECT_EQ(*attributes, expected);
}

TEST(BuildAttributes, texts_are_passed_over_whatever_is_in_them) {
    // Tag 5 a name, 32 a number and a name, 67 a name (odd, over 32), 66 a number.
    const auto attributes =
        build_attributes(section({5, 6, 13, 0, 32, 1, 'g', 0, 67, '2', '.', 0, 66, 2, 6, 13}));
    ASSERT_TRUE(attributes);
    EXPECT_EQ(*attributes, (std::map<std::uint32_t, std::uint32_t>{{6, 13}, {32, 1}, {66, 2}}));
}

TEST(BuildAttributes, numbers_of_several_bytes_are_read) {
    EXPECT_EQ(build_attributes(section({6, 0x8D, 0x01}))->at(6), 141U);
    EXPECT_EQ(build_attributes(section({0x86, 0x00, 13}))->at(6), 13U);
    EXPECT_EQ(build_attributes(section({6, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F}))->at(6), 0xFFFF'FFFFU);
    EXPECT_FALSE(build_attributes(section({6, 0xFF, 0xFF, 0xFF, 0xFF, 0x1F})));        // over 32 bits
    EXPECT_FALSE(build_attributes(section({6, 0x80, 0x80, 0x80, 0x80, 0x80, 0x00})));  // never ends in time
}

TEST(BuildAttributes, another_vendors_are_not_ours) {
    Bytes foreign = section({6, 13});
    foreign[5] = 'g';
    EXPECT_FALSE(build_attributes(foreign));
    Bytes both = foreign;
    const Bytes ours = section({6, 10});
    both.insert(both.end(), ours.begin() + 1, ours.end());
    EXPECT_EQ(build_attributes(both)->at(6), 10U);
}

TEST(BuildAttributes, every_truncation_is_refused) {
    const Bytes whole = test::ElfBuilder().attributes;
    for (std::size_t length = 0; length < whole.size(); ++length)
        EXPECT_FALSE(build_attributes(std::span(whole).first(length))) << length;
}

TEST(BuildAttributes, every_byte_may_be_anything) {
    const Bytes whole = test::ElfBuilder().attributes;
    for (std::size_t at = 0; at < whole.size(); ++at) {
        for (int value = 0; value < 256; ++value) {
            Bytes bytes = whole;
            bytes[at] = static_cast<std::uint8_t>(value);
            (void)build_attributes(bytes);  // must return: sanitizers see the rest
        }
    }
}

}  // namespace
}  // namespace octoskin::image
