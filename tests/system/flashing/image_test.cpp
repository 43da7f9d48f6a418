// The image that the firmware's build left: fit for the board, and read the same by GNU objcopy.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "common/wire/crc.hpp"
#include "hw/image/flash_contents.hpp"
#include "hw/image/image_check.hpp"
#include "tests/system/cli/program.hpp"
#include "tests/unit/hw/boards/shipped_board.hpp"

namespace octoskin {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class BuiltImage : public ProgramTest {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(OCTOSKIN_IMAGE))
            GTEST_SKIP() << "the preset firmware-release is not built";
        if (run("command -v arm-none-eabi-objcopy").exit_code != 0)
            GTEST_SKIP() << "binutils-arm-none-eabi is not installed";
    }
    [[nodiscard]] std::vector<std::uint8_t> bytes_of(const std::string& name) const {
        const std::string text = content(path(name));
        return {text.begin(), text.end()};
    }
};

TEST_F(BuiltImage, is_fit_for_the_board) {
    const auto image = image::ElfImage::load(OCTOSKIN_IMAGE);
    ASSERT_TRUE(image) << image.error().what;
    EXPECT_THAT(image::faults_of(*image, rig::nucleo()), ElementsAre());
}

TEST_F(BuiltImage, is_what_objcopy_makes_of_it) {
    const auto image = image::ElfImage::load(OCTOSKIN_IMAGE);
    ASSERT_TRUE(image);
    // Zeros between sections, as they are in the file; between segments, where ours are 0xFF, there is no
    // gap.
    ASSERT_EQ(run("arm-none-eabi-objcopy -O binary " OCTOSKIN_IMAGE " " + path("image.bin")).exit_code, 0);
    EXPECT_EQ(image::binary(*image, rig::nucleo()), bytes_of("image.bin"));
    // By way of objcopy's own Intel HEX, too.
    ASSERT_EQ(
        run("arm-none-eabi-objcopy -O ihex " OCTOSKIN_IMAGE " " + path("image.hex") +
            " && arm-none-eabi-objcopy -I ihex -O binary " + path("image.hex") + " " + path("again.bin"))
            .exit_code,
        0);
    EXPECT_EQ(bytes_of("again.bin"), bytes_of("image.bin"));
}

TEST_F(BuiltImage, is_flashed_as_objcopy_reads_it_with_each_nodes_own_block) {
    const auto image = image::ElfImage::load(OCTOSKIN_IMAGE);
    ASSERT_TRUE(image);
    const rig::BoardHardware board = rig::nucleo();
    const auto rig = rig::read_rig(source("hw/rigs/experiment.yaml"));
    ASSERT_TRUE(rig);
    for (const rig::Node& node : rig->nodes) {
        const Said said = octoskin("flash --dry-run --rig " + source("hw/rigs/experiment.yaml") + " --node " +
                                   node.name + " --elf " OCTOSKIN_IMAGE " --out " + path(node.name));
        if (said.exit_code == 69) GTEST_SKIP() << said.output;
        ASSERT_EQ(said.exit_code, 0) << said.output;
        // Flash as the emulated board fills it: erased, the image's segments, the block at its page.
        std::vector<std::uint8_t> flash(board.flash.size_bytes, 0xFF);
        for (const image::ElfSegment& segment : image->segments()) {
            std::copy(segment.bytes.begin(), segment.bytes.end(),
                      flash.begin() + (segment.physical_address - board.flash.address));
        }
        std::array<std::uint8_t, kNodeConfigBytesMax> page{};
        const auto block = encode(node.config, page);
        std::copy(block.begin(), block.end(),
                  flash.begin() + (board.configuration_page.address - board.flash.address));
        ASSERT_EQ(run("arm-none-eabi-objcopy -I ihex -O binary --gap-fill 0xff --pad-to 0x08080000 " +
                      path(node.name + "/flash.hex") + " " + path("flash.bin"))
                      .exit_code,
                  0);
        EXPECT_EQ(bytes_of("flash.bin"), flash) << node.name;
        const auto crc = crc32(image::binary(*image, board));
        EXPECT_THAT(content(path(node.name + "/record.yaml")),
                    HasSubstr(fmt::format("image_crc32: 0x{:08x}", crc)));
    }
}

}  // namespace
}  // namespace octoskin
