#include "hw/image/elf_image.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/errors/error_fields.hpp"
#include "tests/support/image/elf_builder.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::image {
namespace {

using test::ElfBuilder;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::what_is;

TEST(ElfImage, has_what_is_programmed_and_nothing_else) {
    ElfBuilder builder;
    builder.segments.push_back(
        {.type = 0x7000'0001, .physical_address = 0x0800'0300, .bytes = {1, 2}});  // EXIDX
    const auto image = ElfImage::parse(builder.bytes());
    ASSERT_TRUE(image);
    EXPECT_EQ(image->entry(), 0x0800'01D9U);
    ASSERT_EQ(image->segments().size(), 2U);  // neither the stack, which has no contents, nor the index
    EXPECT_EQ(image->segments()[0].physical_address, 0x0800'0000U);
    EXPECT_EQ(image->segments()[0].bytes, builder.segments[0].bytes);
    EXPECT_EQ(image->segments()[1].physical_address, 0x0800'0218U);
    EXPECT_EQ(image->segments()[1].bytes.size(), 12U);
    EXPECT_EQ(image->attributes().size(), builder.attributes.size());
}

TEST(ElfImage, refuses_what_is_no_program_for_arm) {
    ElfBuilder x86;
    x86.machine = 62;
    EXPECT_FALSE(ElfImage::parse(x86.bytes()));
    ElfBuilder object;
    object.type = 1;
    EXPECT_FALSE(ElfImage::parse(object.bytes()));
    for (const std::size_t byte : {0U, 3U, 4U, 5U}) {  // magic, class, byte order
        auto file = ElfBuilder().bytes();
        file[byte] ^= 3U;
        EXPECT_FALSE(ElfImage::parse(file)) << byte;
    }
    const auto absent = ElfImage::load("/nowhere/image.elf");
    ASSERT_FALSE(absent);
    EXPECT_EQ(absent.error().file, "/nowhere/image.elf");
    EXPECT_EQ(absent.error().what, "cannot be read");
    EXPECT_TRUE(has_its_fields(absent.error()));
    EXPECT_THAT(ElfImage::load("/").error(), code_is(ErrorCode::wrong_kind_of_file));
}

TEST(ElfImage, reads_no_more_of_a_file_than_an_image_has) {
    const testing_support::ScratchFolder folder;
    const auto file = folder.write("image.elf", ElfBuilder().text());
    std::filesystem::resize_file(file, std::uintmax_t{64} << 20U);
    EXPECT_TRUE(ElfImage::load(file.string()));
    std::filesystem::resize_file(file, std::uintmax_t{1} << 40U);  // of holes
    EXPECT_THAT(ElfImage::load(file.string()).error(),
                AllOf(code_is(ErrorCode::too_large), file_is("image.elf"), what_is(HasSubstr("67108864"))));
}

TEST(ElfImage, refuses_more_segments_than_an_image_has) {
    ElfBuilder builder;
    builder.segments.resize(64, {.physical_address = 0x0800'0400, .bytes = {1}});
    EXPECT_TRUE(ElfImage::parse(builder.bytes()));
    builder.segments.resize(65, {.physical_address = 0x0800'0400, .bytes = {1}});
    const auto image = ElfImage::parse(builder.bytes());
    ASSERT_FALSE(image);
    EXPECT_THAT(image.error(), AllOf(code_is(ErrorCode::limit_exceeded),
                                     what_is(AllOf(HasSubstr("65 segments"), HasSubstr("64")))));
}

TEST(ElfImage, every_truncation_is_refused_or_has_all_that_is_programmed) {
    const auto whole = ElfBuilder().bytes();
    const auto image = ElfImage::parse(whole);
    ASSERT_TRUE(image);
    for (std::size_t length = 0; length < whole.size(); ++length) {
        const auto cut = ElfImage::parse(std::span(whole).first(length));
        if (!cut) continue;
        ASSERT_EQ(cut->segments().size(), 2U) << length;
        EXPECT_EQ(cut->segments()[1].bytes, image->segments()[1].bytes) << length;
    }
}

TEST(ElfImage, every_byte_of_the_headers_may_be_anything) {
    const auto whole = ElfBuilder().bytes();
    for (std::size_t at = 0; at < 52 + 3 * 32; ++at) {
        for (const int value : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
            auto file = whole;
            file[at] = static_cast<std::uint8_t>(value);
            (void)ElfImage::parse(file);  // must return: sanitizers see the rest
        }
    }
    for (std::size_t at = whole.size() - 80; at < whole.size(); ++at) {  // the section headers
        for (const int value : {0x00, 0x02, 0x7F, 0xFF}) {
            auto file = whole;
            file[at] = static_cast<std::uint8_t>(value);
            (void)ElfImage::parse(file);
        }
    }
}

}  // namespace
}  // namespace octoskin::image
