// How much an import may write.
#include "host/bridge/mcap/output_room.hpp"

#include <gmock/gmock.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin::bridge {
namespace {

constexpr std::uint64_t kMiB = OutputRoom::kMiB;
constexpr std::uint64_t kPiece = OutputRoom::kPieceBytes;

TEST(OutputRoom, is_a_thousand_bags_and_some_but_no_more_than_64_gib) {
    EXPECT_EQ(OutputRoom::bytes_max(0), 256 * kMiB);
    EXPECT_EQ(OutputRoom::bytes_max(kMiB), 1256 * kMiB);
    EXPECT_EQ(OutputRoom::bytes_max(kMiB << 10U), 64 * 1024 * kMiB);
    EXPECT_EQ(OutputRoom::bytes_max(~std::uint64_t{0}), 64 * 1024 * kMiB);
}

TEST(OutputRoom, is_measured_once_for_each_piece) {
    int measured = 0;
    OutputRoom room(0, [&measured]() -> Result<OutputRoom::Use, Error> {
        ++measured;
        return OutputRoom::Use{.bytes = 0, .free = OutputRoom::kFreeBytesMin};
    });
    for (std::uint64_t bytes = 0; bytes <= 4 * kPiece; bytes += kPiece / 4) EXPECT_TRUE(room.check(bytes));
    EXPECT_EQ(measured, 4);
}

TEST(OutputRoom, ends_at_its_limit_and_before_the_disk_is_full) {
    OutputRoom::Use use{.bytes = 256 * kMiB, .free = OutputRoom::kFreeBytesMin};
    OutputRoom room(0, [&use]() -> Result<OutputRoom::Use, Error> { return use; });
    EXPECT_TRUE(room.check(kPiece));
    ++use.bytes;
    EXPECT_EQ(room.check(2 * kPiece).error().code, ErrorCode::limit_exceeded);
    --use.bytes;
    --use.free;
    const auto full = room.check(3 * kPiece);
    ASSERT_FALSE(full);
    EXPECT_EQ(full.error().code, ErrorCode::limit_exceeded);
    EXPECT_THAT(full.error().what, testing::HasSubstr("256 MiB are left"));
}

TEST(OutputRoom, counts_the_files_of_a_folder_and_below_it) {
    const testing_support::ScratchFolder scratch;
    (void)scratch.write("a", "12345");
    std::filesystem::create_directory(scratch / "depth");
    (void)scratch.write("depth/b", "123");
    std::filesystem::create_symlink(scratch / "a", scratch / "link");
    const auto folder = OpenFolder::open(scratch.path(), FolderAccess::read);
    ASSERT_TRUE(folder);
    const auto use = use_of(*folder);
    ASSERT_TRUE(use);
    EXPECT_EQ(use->bytes, 8U);
    EXPECT_GT(use->free, 0U);
}

}  // namespace
}  // namespace octoskin::bridge
