// Command line and configuration block: what fits is taken as it is, everything else is refused in words.
#include "firmware/app/linux_node/configuration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "firmware/app/linux_node/arguments.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::linux_node {
namespace {

using linux_port::ExitCode;
using testing::HasSubstr;

std::variant<Arguments, ExitCode> parse(std::vector<const char*> words) {
    words.insert(words.begin(), "octoskin-node");
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    auto parsed = parse_arguments(static_cast<int>(words.size()), words.data(), 0x1234ABCD);
    (void)testing::internal::GetCapturedStderr();
    (void)testing::internal::GetCapturedStdout();
    return parsed;
}

TEST(LinuxNodeArguments, are_taken_in_the_rigs_order) {
    const auto parsed = parse({"--config", "a.block", "--can", "can1", "--i2c", "/dev/i2c-1", "/dev/i2c-3",
                               "--xshut", "gpiochip0:17,4", "gpiochip2:1", "--data-ready", "gpiochip0:5,6",
                               "--i2c-lateness-ms", "7", "--uid", "00112233445566778899aAbB"});
    ASSERT_TRUE(std::holds_alternative<Arguments>(parsed));
    const auto& arguments = std::get<Arguments>(parsed);
    EXPECT_EQ(arguments.config, "a.block");
    EXPECT_EQ(arguments.can, "can1");
    EXPECT_THAT(arguments.i2c, testing::ElementsAre("/dev/i2c-1", "/dev/i2c-3"));
    ASSERT_EQ(arguments.xshut.size(), 3U);
    EXPECT_EQ(arguments.xshut[1], (linux_port::LineName{"gpiochip0", 4}));
    EXPECT_EQ(arguments.xshut[2], (linux_port::LineName{"gpiochip2", 1}));
    EXPECT_EQ(arguments.data_ready.size(), 2U);
    EXPECT_EQ(arguments.i2c_lateness, Microseconds{7'000});
    EXPECT_EQ(arguments.uid, (Uid{0x00, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88, 0x99, 0xAA, 0xBB}));
}

TEST(LinuxNodeArguments, that_are_wrong_are_a_usage_error) {
    const std::vector<const char*> good{"--config", "a", "--i2c", "b", "--xshut", "c:1"};
    ASSERT_TRUE(std::holds_alternative<Arguments>(parse(good)));
    const auto with = [&good](std::vector<const char*> more) {
        more.insert(more.begin(), good.begin(), good.end());
        const auto parsed = parse(more);
        const auto* code = std::get_if<ExitCode>(&parsed);
        return code != nullptr && *code == ExitCode::usage;
    };
    EXPECT_TRUE(with({"--unknown"}));
    for (const char* name : {"can#0", "123#00", "a b", "", "sixteen_letters_"})
        EXPECT_TRUE(with({"--can", name})) << name;
    EXPECT_TRUE(with({"--data-ready", "c:1,1"}));
    EXPECT_TRUE(with({"--data-ready", "17"}));
    EXPECT_TRUE(with({"--uid", "0011"}));
    EXPECT_TRUE(with({"--uid", "00112233445566778899aag0"}));
    EXPECT_TRUE(with({"--i2c-lateness-ms", "0"}));
    EXPECT_EQ(std::get<ExitCode>(parse({"--config", "a", "--i2c", "b"})), ExitCode::usage);
    EXPECT_EQ(std::get<ExitCode>(parse({"--help"})), ExitCode::ok);
    EXPECT_EQ(std::get<ExitCode>(parse({"--version"})), ExitCode::ok);
}

class LinuxNodeConfiguration : public testing::Test {
  protected:
    LinuxNodeConfiguration() {
        arguments_.config = folder_.path() / "node.block";
        arguments_.i2c = {"/dev/i2c-1", "/dev/i2c-3"};
        arguments_.xshut = {{"gpiochip0", 1}, {"gpiochip0", 2}, {"gpiochip0", 3}};
        arguments_.data_ready = {{"gpiochip0", 4}, {"gpiochip0", 5}};
        config_.board_type = 2;
        config_.data_ready_buses = 0b10;
        config_.sensor_count = 2;
        config_.sensors[0] = {.bus = 0, .xshut_line = 0, .address = 0x30};
        config_.sensors[1] = {.bus = 1, .xshut_line = 2, .address = 0x31};
    }
    void write(std::size_t bytes_left_out = 0, std::size_t bytes_more = 0) {
        std::array<std::uint8_t, kNodeConfigBytesMax> memory{};
        const auto block = encode(config_, memory);
        std::ofstream stream(arguments_.config, std::ios::binary);
        stream.write(reinterpret_cast<const char*>(block.data()),
                     static_cast<std::streamsize>(block.size() - bytes_left_out));
        stream << std::string(bytes_more, '\xFF');
    }
    void expect_refused(ExitCode code, const std::string& why) {
        const auto loaded = load_configuration(arguments_);
        ASSERT_FALSE(loaded) << why;
        EXPECT_EQ(loaded.error().code, code);
        EXPECT_THAT(loaded.error().what, HasSubstr(arguments_.config.string()));
        EXPECT_THAT(loaded.error().what, HasSubstr(why));
    }

    testing_support::ScratchFolder folder_;
    Arguments arguments_;
    NodeConfig config_;
};

TEST_F(LinuxNodeConfiguration, is_read_as_it_was_written) {
    write();
    const auto loaded = load_configuration(arguments_);
    ASSERT_TRUE(loaded) << loaded.error().what;
    EXPECT_EQ(*loaded, config_);
}

TEST_F(LinuxNodeConfiguration, is_refused_if_it_is_not_there_or_not_whole) {
    expect_refused(ExitCode::no_input, "cannot be read");
    write(1);
    expect_refused(ExitCode::bad_config, "truncated");
    std::ofstream(arguments_.config) << "name: bench_one_board\n# a rig is no block\n";
    expect_refused(ExitCode::bad_config, "no configuration block");
}

TEST_F(LinuxNodeConfiguration, is_not_waited_for_at_a_pipe) {
    ASSERT_EQ(::mkfifo(arguments_.config.c_str(), 0600), 0);
    expect_refused(ExitCode::no_input, "not an ordinary file");
    std::filesystem::remove(arguments_.config);
    std::filesystem::create_directory(arguments_.config);
    expect_refused(ExitCode::no_input, "not an ordinary file");
}

TEST_F(LinuxNodeConfiguration, is_refused_for_another_type_of_board) {
    config_.board_type = 1;
    write();
    expect_refused(ExitCode::bad_config, "for boards of type 1");
}

TEST_F(LinuxNodeConfiguration, is_refused_if_the_command_line_lacks_a_device) {
    write();
    arguments_.i2c.pop_back();
    expect_refused(ExitCode::bad_config, "sensor 1 is on bus 1, but --i2c names 1");
    arguments_.i2c.emplace_back("/dev/i2c-3");
    arguments_.xshut.pop_back();
    expect_refused(ExitCode::bad_config, "sensor 1 is on xshut_line 2, but --xshut names 2");
    arguments_.xshut.push_back({"gpiochip0", 3});
    arguments_.data_ready.pop_back();
    expect_refused(ExitCode::bad_config, "bus 1 has a data-ready line, but --data-ready names 1");
}

}  // namespace
}  // namespace octoskin::linux_node
