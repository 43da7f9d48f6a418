// An image that is fit, and one for each thing that can be wrong with it, made on purpose.
#include "hw/image/image_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <ostream>

#include "common/config/image_identity.hpp"
#include "tests/support/image/elf_builder.hpp"
#include "tests/unit/hw/boards/shipped_board.hpp"

namespace octoskin::image {
namespace {

using test::ElfBuilder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> faults_of(const ElfBuilder& builder) {
    const auto image = ElfImage::parse(builder.bytes());
    if (!image) return {"unreadable: " + image.error().what};
    return faults_of(*image, rig::nucleo());
}

TEST(ImageCheck, finds_nothing_wrong_with_a_fit_image) {
    EXPECT_THAT(faults_of(ElfBuilder()), IsEmpty());
}

struct Defect {
    const char* name;
    std::function<void(ElfBuilder&)> make;
    const char* words;
    friend std::ostream& operator<<(std::ostream& out, const Defect& defect) { return out << defect.name; }
};

class DefectiveImage : public testing::TestWithParam<Defect> {};

TEST_P(DefectiveImage, is_refused_for_just_that) {
    ElfBuilder builder;
    GetParam().make(builder);
    EXPECT_THAT(faults_of(builder), ElementsAre(HasSubstr(GetParam().words)));
}

constexpr std::uint32_t kPage = 0x0807'F800;

INSTANTIATE_TEST_SUITE_P(
    Defects, DefectiveImage,
    testing::Values(
        Defect{"data in RAM", [](ElfBuilder& b) { b.segments[1].physical_address = 0x2000'2A40; },
               "12 bytes at 0x20002A40 are outside flash (0x08000000 to 0x0807FFFF)"},
        Defect{"data below flash", [](ElfBuilder& b) { b.segments[1].physical_address = 0x07FF'FFF0; },
               "outside flash"},
        Defect{"data over the end of flash",
               [](ElfBuilder& b) { b.segments[1].physical_address = 0x0807'FFF8; }, "outside flash"},
        Defect{"data round the end of the address space",
               [](ElfBuilder& b) { b.segments[1].physical_address = 0xFFFF'FFF8; }, "outside flash"},
        Defect{"the last byte in the configuration page",
               [](ElfBuilder& b) { b.segments[1].physical_address = kPage - 11; },
               "reach into the configuration page at 0x0807F800"},
        Defect{"data in the configuration page",
               [](ElfBuilder& b) { b.segments[1].physical_address = kPage; },
               "reach into the configuration page"},
        Defect{"overlapping segments", [](ElfBuilder& b) { b.segments[1].physical_address -= 1; },
               "two segments overlap"},
        Defect{"stack pointer in flash", [](ElfBuilder& b) { b.set_vector(0, 0x0800'1000); },
               "stack pointer 0x08001000 is outside RAM"},
        Defect{"stack pointer at the bottom of RAM", [](ElfBuilder& b) { b.set_vector(0, 0x2000'0000); },
               "outside RAM"},
        Defect{"stack pointer above RAM", [](ElfBuilder& b) { b.set_vector(0, 0x2001'8008); }, "outside RAM"},
        Defect{"stack pointer of 4 bytes", [](ElfBuilder& b) { b.set_vector(0, 0x2000'2804); },
               "not a multiple of 8"},
        Defect{"reset vector beside the entry", [](ElfBuilder& b) { b.set_vector(1, 0x0800'01DB); },
               "reset vector 0x080001DB is not the entry 0x080001D9"},
        Defect{"ARM code at a vector", [](ElfBuilder& b) { b.set_vector(3, 0x0800'01E0); },
               "vector 3 is 0x080001E0: not Thumb code"},
        Defect{"an empty vector", [](ElfBuilder& b) { b.set_vector(21 + 16, 0); }, "vector 37 is 0x00000000"},
        Defect{"an erased vector", [](ElfBuilder& b) { b.set_vector(117, 0xFFFF'FFFF); }, "vector 117"},
        Defect{"a vector into RAM", [](ElfBuilder& b) { b.set_vector(20, 0x2000'0001); }, "vector 20"},
        Defect{"a vector behind the image", [](ElfBuilder& b) { b.set_vector(20, 0x0800'1001); },
               "vector 20"},
        Defect{"no build attributes", [](ElfBuilder& b) { b.attributes.clear(); }, "no ARM build attributes"},
        Defect{"for Cortex-M3", [](ElfBuilder& b) { b.set_attribute(6, 10); },
               "not compiled for ARMv7E-M: build attribute 6 is 10, expected 13"},
        Defect{"without an FPU", [](ElfBuilder& b) { b.set_attribute(10, 0); }, "not compiled for FPv4-D16"},
        Defect{"in double precision", [](ElfBuilder& b) { b.set_attribute(27, 3); }, "single precision"},
        Defect{"of the layout before", [](ElfBuilder& b) { b.set_layout(kNodeConfigLayout - 1); },
               "it reads configuration blocks of layout 4, but this octoskin writes layout 5"},
        Defect{"of the next layout", [](ElfBuilder& b) { b.set_layout(kNodeConfigLayout + 1); },
               "of layout 6"},
        Defect{"without a layout", [](ElfBuilder& b) { b.set_layout(0); },
               "its layout of configuration block is unknown"},
        Defect{"with a damaged layout", [](ElfBuilder& b) { b.segments[0].bytes.back() ^= 1U; },
               "its layout of configuration block is unknown"},
        Defect{"with soft arguments", [](ElfBuilder& b) { b.set_attribute(28, 0); },
               "not compiled with arguments in floating-point registers"}));

TEST(ImageCheck, the_last_fit_places_are_fit) {
    ElfBuilder builder;
    builder.segments[1].physical_address = kPage - 12;
    builder.set_vector(0, 0x2001'8000);  // an empty stack at the end of RAM
    for (const std::uint32_t reserved : {7U, 8U, 9U, 10U, 13U, 101U}) builder.set_vector(reserved, 0);
    EXPECT_THAT(faults_of(builder), IsEmpty());
}

TEST(ImageCheck, every_other_vector_of_zero_is_told) {
    for (std::uint32_t i = 2; i < 118; ++i) {
        if (i == 7 || i == 8 || i == 9 || i == 10 || i == 13 || i == 101) continue;
        ElfBuilder builder;
        builder.set_vector(i, 0);
        EXPECT_THAT(faults_of(builder), ElementsAre(HasSubstr("vector " + std::to_string(i) + " is")));
    }
}

TEST(ImageCheck, a_table_that_is_cut_off_is_told) {
    for (const std::size_t bytes : {0UL, 4UL, 7UL, 8UL, 471UL}) {
        ElfBuilder builder;
        builder.segments[0].bytes.resize(bytes);
        EXPECT_THAT(faults_of(builder), testing::Not(IsEmpty())) << bytes;
    }
    ElfBuilder nothing;
    nothing.segments.clear();
    EXPECT_THAT(faults_of(nothing), testing::Contains(HasSubstr("nothing to program")));
}

TEST(ImageCheck, an_image_for_another_place_has_no_vector_table) {
    ElfBuilder builder;
    builder.segments[0].physical_address = 0x0800'4000;
    EXPECT_THAT(faults_of(builder), testing::Contains(HasSubstr("no vector table at 0x08000000")));
}

}  // namespace
}  // namespace octoskin::image
