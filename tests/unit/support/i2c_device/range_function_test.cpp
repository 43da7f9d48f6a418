#include "tests/support/i2c_device/range_function.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/support/scratch_folder.hpp"

namespace octoskin::test {
namespace {

double range_mm_at(const std::string& text, std::int64_t us) {
    return true_range_mm(text, {us}).value().value();
}

TEST(RangeFunction, a_wall_stays_where_it_is) {
    EXPECT_EQ(range_mm_at("constant:412", 0), 412.0);
    EXPECT_EQ(range_mm_at("constant:412", 9'999'999'999), 412.0);
}

TEST(RangeFunction, a_triangle_goes_from_near_to_far_and_back_in_its_period) {
    const std::string text = "triangle:200:1000:4000";
    EXPECT_EQ(range_mm_at(text, 0), 200.0);
    EXPECT_EQ(range_mm_at(text, 1'000'000), 600.0);
    EXPECT_EQ(range_mm_at(text, 2'000'000), 1000.0);
    EXPECT_EQ(range_mm_at(text, 3'000'000), 600.0);
    EXPECT_EQ(range_mm_at(text, 4'000'000), 200.0);
    EXPECT_EQ(range_mm_at(text, 400'000'500'000), 400.0);
}

TEST(RangeFunction, nothing_in_sight_is_no_range) {
    ASSERT_TRUE(true_range_mm("none", {}));
    EXPECT_FALSE(*true_range_mm("none", {}));
    EXPECT_FALSE(scene_of("none")(0, {}, {}).range_m);
}

TEST(RangeFunction, a_file_may_change_while_it_is_served) {
    const testing_support::ScratchFolder folder;
    const std::string path = (folder / "range").string();
    EXPECT_FALSE(true_range_mm("file:" + path, {}));
    std::ofstream(path) << "constant:300\n";
    const auto scene = scene_of("file:" + path);
    EXPECT_EQ(scene(0, {}, {}).range_m, 0.3);
    std::ofstream(path) << "none\n";
    EXPECT_FALSE(scene(1, {}, {}).range_m);
    std::ofstream(path) << "file:" << path << '\n';
    EXPECT_FALSE(true_range_mm("file:" + path, {})) << "a file that names itself";
}

TEST(RangeFunction, refuses_what_it_does_not_understand) {
    for (const char* text : {"", "constant", "constant:", "constant:-1", "constant:1:2", "constant:1x",
                             "constant:1.5", "none:1", "triangle:1:2", "triangle:2:1:1000", "triangle:1:2:0",
                             "triangle:1:2:3:4", "wall:3", "constant:1000001"}) {
        EXPECT_FALSE(true_range_mm(text, {})) << text;
    }
}

}  // namespace
}  // namespace octoskin::test
