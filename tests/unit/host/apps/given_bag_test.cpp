// MCAP files that a person names, and folders of `ros2 bag`.
#include "host/apps/recording/given_bag.hpp"

#include <gmock/gmock.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// The path of the bag, or nothing; an error fails the test.
std::optional<fs::path> found_in(const fs::path& named) {
    const auto bag = find_bag(named);
    EXPECT_TRUE(bag);
    return bag && *bag ? std::optional((*bag)->shown()) : std::nullopt;
}

class GivenBag : public testing::Test {
  protected:
    fs::path write_bag() const {
        (void)folder_.write("metadata.yaml", "");
        return folder_.write("x.mcap", "bag");
    }
    testing_support::ScratchFolder folder_;
};

TEST_F(GivenBag, is_the_only_mcap_file_of_a_folder_with_metadata) {
    const fs::path file = folder_.write("x.mcap", "bag");
    EXPECT_EQ(found_in(folder_.path()), std::nullopt);
    EXPECT_FALSE(given_bag(folder_.path()));
    (void)write_bag();
    EXPECT_EQ(found_in(folder_.path()), file);
    const auto bag = given_bag(folder_.path());
    ASSERT_TRUE(bag);
    EXPECT_EQ(bag->read(10).value(), "bag");
    (void)folder_.write("y.mcap", "");
    EXPECT_THAT(find_bag(folder_.path()).error().error.what, HasSubstr("several files"));
    fs::remove(folder_ / "y.mcap");
    (void)folder_.write("can.log", "");
    EXPECT_EQ(found_in(folder_.path()), std::nullopt);
}

TEST_F(GivenBag, is_a_file_of_any_name_where_only_a_bag_can_be) {
    const fs::path file = folder_.write("x.bag", "bag");
    EXPECT_EQ(found_in(file), std::nullopt);
    EXPECT_EQ(given_bag(file).value().shown(), file);
    EXPECT_EQ(found_in(folder_ / "x.mcap"), folder_ / "x.mcap");
}

TEST_F(GivenBag, follows_no_link_in_its_folder) {
    const testing_support::ScratchFolder other;
    (void)folder_.write("metadata.yaml", "");
    fs::create_symlink(other.write("secret", "text"), folder_ / "x.mcap");
    const auto bag = given_bag(folder_.path());
    ASSERT_TRUE(bag);
    EXPECT_EQ(bag->open().error().fault, FolderFault::link);
    EXPECT_TRUE(FilePlace(folder_ / "x.mcap").open());  // as typed
}

TEST_F(GivenBag, has_its_maps_beside_it_and_not_where_a_link_leads) {
    const testing_support::ScratchFolder other;
    (void)write_bag();
    const auto bag = given_bag(folder_.path());
    ASSERT_TRUE(bag);
    const FilePlace maps = maps_beside(*bag);
    EXPECT_EQ(maps.shown(), folder_ / "x.maps");
    fs::create_symlink(other.path(), folder_ / "x.maps");
    const auto refused = maps.make_folder();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().fault, FolderFault::link);
    fs::remove(folder_ / "x.maps");
    EXPECT_TRUE(maps.make_folder());
    EXPECT_EQ(maps_beside(FilePlace(folder_ / "x.mcap")).shown(), folder_ / "x.maps");
}

}  // namespace
}  // namespace octoskin
