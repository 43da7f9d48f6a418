#include "host/apps/query/joint_lines.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <sstream>
#include <streambuf>

#include "host/apps/query/query_request.hpp"

namespace octoskin {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string refused(std::string_view text) {
    const auto read = read_numbers(text);
    return read ? "taken" : "refused: " + read.error();
}

TEST(ReadNumbers, takes_plain_decimals_with_commas_or_blanks_between_them) {
    EXPECT_THAT(*read_numbers("0,-0.785,1e-3"), ElementsAre(0.0, -0.785, 0.001));
    EXPECT_THAT(*read_numbers(" 1 , 2,3\t4 \r\n"), ElementsAre(1.0, 2.0, 3.0, 4.0));
    EXPECT_THAT(*read_numbers(" \t"), ElementsAre());
}

TEST(ReadNumbers, refuses_everything_else_by_the_field_that_it_is_in) {
    for (const char* text : {"1,,2", "1,", ",1", ",", "1 , , 2", " ,"}) EXPECT_EQ(refused(text), "refused: ");
    EXPECT_EQ(refused("1;2"), "refused: 1;2");
    for (const char* word : {"0x10", "0x1p3", "nan", "-nan", "NaN", "inf", "-infinity", "1e999", "1.5rad",
                             "a", "--1", "1-", "1_0"}) {
        EXPECT_EQ(refused(std::string("0,") + word + " ,3"), std::string("refused: ") + word);
    }
}

TEST(ReadNumbers, takes_any_bytes) {
    std::mt19937 random(7);
    constexpr std::string_view kOften = "0123456789.,, -+eEnaif;x\t\r\n";
    for (int round = 0; round < 20'000; ++round) {
        std::string text(random() % 24, ' ');
        for (char& c : text)
            c = random() % 8 == 0 ? static_cast<char>(random() % 256) : kOften[random() % kOften.size()];
        const auto read = read_numbers(text);
        if (!read) continue;
        for (const double number : *read) EXPECT_TRUE(std::isfinite(number)) << text;
    }
}

Result<JointPath, AppError> path_of(const std::string& text) {
    std::istringstream stream(text);
    return read_joint_path(stream, "way.txt");
}

TEST(ReadJointPath, has_a_configuration_a_line_and_knows_of_each_where_it_is) {
    const auto path = path_of("# home\n0,1\n\n  \r\n2 3\r\n4,5");
    ASSERT_TRUE(path) << path.error().message();
    EXPECT_THAT(path->configurations, ElementsAre(ElementsAre(0, 1), ElementsAre(2, 3), ElementsAre(4, 5)));
    EXPECT_THAT(path->lines, ElementsAre(2, 5, 6));
}

TEST(ReadJointPath, names_the_line_and_what_is_wrong_there) {
    const auto error = [](const std::string& text) { return path_of(text).error().error; };
    const Error not_finite = error("0,1\n# x\n0,nan\n");
    EXPECT_EQ(not_finite.code, ErrorCode::bad_syntax);
    EXPECT_EQ(not_finite.file, "way.txt");
    EXPECT_EQ(not_finite.line, 3);
    EXPECT_EQ(not_finite.value, "'nan'");
    EXPECT_THAT(not_finite.what, HasSubstr("expected a joint configuration"));
    const Error missing = error("0,1,\n");
    EXPECT_EQ(missing.line, 1);
    EXPECT_EQ(missing.value, "no number beside a comma");
    EXPECT_EQ(error(std::string("\x1b[0m\0", 5)).value, "'?[0m?'");
    const Error empty = error("# nothing\n");
    EXPECT_EQ(empty.code, ErrorCode::no_content);
    EXPECT_EQ(empty.file, "way.txt");
    EXPECT_EQ(empty.line, 0);
    EXPECT_EQ(path_of("x").error().exit, ExitCode::bad_data);
    std::string many;
    for (std::size_t i = 0; i < kConfigurationsMax; ++i) many += "0\n";
    EXPECT_TRUE(path_of(many));
    const Error over = error(many + "\n0");
    EXPECT_EQ(over.code, ErrorCode::limit_exceeded);
    EXPECT_EQ(over.file, "way.txt");
    EXPECT_EQ(over.line, 1002);
    EXPECT_THAT(over.what, HasSubstr("at most 1000 configurations"));
}

/// As /dev/zero is, and a pipe that somebody goes on writing to.
class Endless : public std::streambuf {
  public:
    std::size_t read = 0;

  protected:
    int_type underflow() override {
        read += block_.size();
        setg(block_.data(), block_.data(), block_.data() + block_.size());
        return traits_type::to_int_type(block_.front());
    }

  private:
    std::string block_ = std::string(4096, '#');
};

TEST(ReadJointPath, ends_where_the_text_does_not) {
    Endless endless;
    std::istream stream(&endless);
    const auto path = read_joint_path(stream, "zeros");
    ASSERT_FALSE(path);
    EXPECT_EQ(path.error().error.code, ErrorCode::too_large);
    EXPECT_EQ(path.error().error.file, "zeros");
    EXPECT_THAT(path.error().error.what, HasSubstr("at most 1048576 bytes"));
    EXPECT_LE(endless.read, kPathBytesMax + 2 * 4096);
    EXPECT_TRUE(path_of("0\n" + std::string(kPathBytesMax - 2, '#')));
    EXPECT_FALSE(path_of("0\n" + std::string(kPathBytesMax - 1, '#')));
}

}  // namespace
}  // namespace octoskin
