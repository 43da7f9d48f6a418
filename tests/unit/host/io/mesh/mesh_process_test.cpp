#include "host/io/mesh/mesh_process.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "host/io/digest/sha256.hpp"
#include "host/io/mesh/mesh_bytes.hpp"
#include "host/io/mesh/mesh_copy.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/hw/mesh/shape_files.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;

Result<TriangleMesh, Error> read(const FilePlace& file,
                                 const std::optional<std::filesystem::path>& helper = {}) {
    const auto copy = copy_mesh(file);
    return copy ? read_mesh_in_process(*copy, helper) : unexpected(copy.error());
}

Result<std::string, Error> digest_of(const FilePlace& file, std::uintmax_t bytes_left = 2 * kMeshBytesMax) {
    return mesh_sha256(file, bytes_left);
}

TEST(MeshCopy, digests_take_from_the_bytes_that_are_left_for_all) {
    const ScratchFolder folder;
    const std::string wedge = testing_support::wedge_stl();
    const auto file = folder.write("a.stl", wedge);
    std::uintmax_t left = 2 * wedge.size() + 1;
    EXPECT_TRUE(mesh_sha256(file, left));
    EXPECT_TRUE(mesh_sha256(file, left));
    EXPECT_EQ(left, 1U);
    EXPECT_EQ(mesh_sha256(file, left).error().code, ErrorCode::too_large);
}

TEST(MeshProcess, gives_the_triangles_of_a_file_of_each_format) {
    const ScratchFolder folder;
    for (const auto& file : {folder.write("a.stl", testing_support::wedge_stl()),
                             folder.write("a.obj", testing_support::wedge_obj()),
                             folder.write("a.dae", testing_support::wedge_dae("Z_UP", 0.001))}) {
        const auto mesh = read(file);
        ASSERT_TRUE(mesh) << mesh.error().message();
        EXPECT_EQ(mesh->triangles.size(), 4U) << file;
    }
}

TEST(MeshProcess, names_the_file_that_is_missing_a_folder_or_not_a_mesh) {
    const ScratchFolder folder;
    EXPECT_EQ(read(folder / "none.stl").error().code, ErrorCode::not_found);
    std::filesystem::create_directory(folder / "dir.stl");
    EXPECT_EQ(read(folder / "dir.stl").error().code, ErrorCode::wrong_kind_of_file);
    const auto found = read(folder.write("text.stl", "nothing"));
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, ErrorCode::foreign_format);
    EXPECT_EQ(found.error().file, folder / "text.stl");
}

TEST(MeshProcess, says_that_its_helper_is_missing_or_failed) {
    const ScratchFolder folder;
    const auto file = folder.write("a.stl", testing_support::wedge_stl());
    EXPECT_EQ(read(file, folder / "no-helper").error().code, ErrorCode::no_program);
    EXPECT_EQ(read(file, "/bin/false").error().code, ErrorCode::foreign_format);
    EXPECT_EQ(read(file, "/bin/echo").error().code, ErrorCode::foreign_format);
}

TEST(MeshCopy, is_the_file_as_it_was) {
    const ScratchFolder folder;
    const std::string wedge = testing_support::wedge_stl();
    const auto file = folder.write("a.stl", wedge);
    const auto copy = copy_mesh(file);
    ASSERT_TRUE(copy);
    EXPECT_EQ(copy->sha256, sha256_of(wedge));
    EXPECT_EQ(*digest_of(file), copy->sha256);
    std::filesystem::resize_file(file, 100);
    const auto mesh = read_mesh_in_process(*copy);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->triangles.size(), 4U);
    EXPECT_NE(*digest_of(file), copy->sha256);
}

TEST(MeshCopy, of_a_pipe_or_a_file_beyond_the_limit_is_refused) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe.stl").c_str(), 0600), 0);
    const auto large = folder.write("large.stl", "");
    std::filesystem::resize_file(large, kMeshBytesMax + 1);
    for (const auto& [name, code] : {std::pair{"pipe.stl", ErrorCode::wrong_kind_of_file},
                                     std::pair{"large.stl", ErrorCode::too_large}}) {
        EXPECT_EQ(copy_mesh(folder / name).error().code, code);
        EXPECT_EQ(digest_of(folder / name).error().code, code);
        EXPECT_EQ(digest_of(folder / name).error().file, folder / name);
    }
}

TEST(MeshBytes, come_back_as_they_were_and_are_refused_cut_or_with_foreign_indices) {
    TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}}, {{0, 1, 2}, {2, 1, 0}}};
    const std::string bytes = to_bytes(mesh);
    const auto back = mesh_of(bytes);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->vertices, mesh.vertices);
    EXPECT_EQ(back->triangles, mesh.triangles);
    for (std::size_t length = 0; length < bytes.size(); ++length)
        EXPECT_FALSE(mesh_of(bytes.substr(0, length)));
    for (const int index : {-1, 3, 1 << 30}) {
        mesh.triangles[1][2] = index;
        EXPECT_FALSE(mesh_of(to_bytes(mesh)));
    }
    mesh.triangles[1][2] = 0;
    mesh.vertices[0].x() = std::nan("");
    EXPECT_FALSE(mesh_of(to_bytes(mesh)));
}

}  // namespace
}  // namespace octoskin
