#include "host/apps/flashing/flashing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/apps/flashing/openocd_script.hpp"
#include "tests/support/image/elf_builder.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/hw/boards/shipped_board.hpp"

namespace octoskin::flashing {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

rig::Rig read(const std::string& name) {
    const auto rig = rig::read_rig(OCTOSKIN_SOURCE_DIR "/hw/rigs/" + name);
    if (!rig) throw std::runtime_error(rig.error().message());
    return *rig;
}

class FlashingTest : public testing::Test {
  protected:
    [[nodiscard]] Order order(const test::ElfBuilder& elf = {}) const {
        return {.elf = folder_.write("image.elf", elf.text()),
                .node = read("bench_one_board.yaml").nodes.at(0),
                .board = rig::nucleo(),
                .folder = folder_ / "out/bench",
                .adapter_serial = "",
                .writes_option_bytes = false};
    }
    testing_support::ScratchFolder folder_;
};

TEST_F(FlashingTest, a_fit_image_becomes_two_files) {
    const auto prepared = prepare(order());
    ASSERT_TRUE(prepared) << prepared.error().message();
    EXPECT_EQ(prepared->image_bytes, 548U);
    EXPECT_EQ(testing_support::ScratchFolder::read(folder_ / "out/bench/flash.hex"),
              intel_hex(prepared->contents));
    EXPECT_THAT(testing_support::ScratchFolder::read(folder_ / "out/bench/flash.cfg"),
                HasSubstr("source [find board/st_nucleo_g4.cfg]"));
}

TEST_F(FlashingTest, every_fault_of_an_image_is_named_and_nothing_is_written) {
    test::ElfBuilder elf;
    elf.set_vector(0, 1);
    elf.set_attribute(6, 10);
    const auto prepared = prepare(order(elf));
    ASSERT_FALSE(prepared);
    EXPECT_EQ(prepared.error().exit, ExitCode::bad_data);
    EXPECT_EQ(prepared.error().error.code, ErrorCode::mismatch);
    EXPECT_EQ(prepared.error().error.file, folder_ / "image.elf");
    for (const char* const fault : {"outside RAM", "not a multiple of 8", "ARMv7E-M"})
        EXPECT_THAT(prepared.error().error.what, HasSubstr(fault));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(FlashingTest, what_is_missing_or_in_the_way_has_its_own_code) {
    Order absent = order();
    absent.elf = folder_ / "nowhere.elf";
    EXPECT_EQ(prepare(absent).error().exit, ExitCode::no_input);
    EXPECT_EQ(prepare(absent).error().error.code, ErrorCode::not_found);
    EXPECT_EQ(prepare(absent).error().error.file, absent.elf);
    EXPECT_THAT(prepare(absent).error().error.remedy,
                testing::AllOf(HasSubstr("`firmware/flash`"), HasSubstr("--elf")));
    Order blocked = order();
    blocked.folder = blocked.elf / "below";
    EXPECT_EQ(prepare(blocked).error().exit, ExitCode::cannot_create);
    Order other = order();
    other.board.name = "another_board";
    EXPECT_EQ(prepare(other).error().exit, ExitCode::bad_config);
    Order impossible = order();
    impossible.node.config.node_id = 0;  // no board would accept it
    EXPECT_EQ(prepare(impossible).error().exit, ExitCode::bad_config);
    EXPECT_EQ(prepare(impossible).error().error.code, ErrorCode::bad_value);
    EXPECT_EQ(prepare(impossible).error().error.key, "node bench");
}

TEST(ChooseNode, by_name_or_number_and_alone_if_there_is_one) {
    const rig::Rig bench = read("bench_one_board.yaml");
    EXPECT_EQ(choose_node(bench, "")->name, "bench");
    EXPECT_EQ(choose_node(bench, "1")->name, "bench");
    EXPECT_EQ(choose_node(bench, "bench")->name, "bench");
    EXPECT_EQ(choose_node(bench, "2").error().exit, ExitCode::usage);
    EXPECT_EQ(choose_node(bench, "2").error().error.code, ErrorCode::unknown_name);
    EXPECT_EQ(choose_node(bench, "2").error().error.value, "'2'");
    const rig::Rig experiment = read("experiment.yaml");
    ASSERT_GT(experiment.nodes.size(), 1U);
    EXPECT_EQ(choose_node(experiment, "").error().error.key, "--node");
    EXPECT_THAT(choose_node(experiment, "").error().error.remedy, HasSubstr(experiment.nodes[1].name));
    EXPECT_EQ(choose_node(experiment, experiment.nodes[1].name)->config, experiment.nodes[1].config);
}

TEST(OpenocdScript, touches_option_bytes_and_chooses_an_adapter_only_when_told) {
    const ScriptPlan plan{.openocd_board = "board/x.cfg",
                          .device_id = 0x469,
                          .adapter_serial = "",
                          .writes_option_bytes = false};
    EXPECT_THAT(openocd_script(plan), Not(HasSubstr("option_write")));
    EXPECT_THAT(openocd_script(plan), Not(HasSubstr("adapter serial")));
    EXPECT_THAT(openocd_script(plan),
                ContainsRegex("\nreset_config srst_only srst_nogate connect_assert_srst\n(.*\n)*    init\n"))
        << "a sleeping core is met under reset";
    ScriptPlan all = plan;
    all.adapter_serial = "0042";
    all.writes_option_bytes = true;
    EXPECT_THAT(openocd_script(all), HasSubstr("adapter serial 0042\n"));
    EXPECT_THAT(openocd_script(all), HasSubstr("option_write 0 0x20 0x08000400 0x0C100700"));
}

}  // namespace
}  // namespace octoskin::flashing
