#include "host/io/mesh/mesh_process.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "host/io/mesh/mesh_bytes.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/hw/mesh/shape_files.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;

TEST(MeshProcess, gives_the_triangles_of_a_file_of_each_format) {
    const ScratchFolder folder;
    for (const auto& file : {folder.write("a.stl", testing_support::wedge_stl()),
                             folder.write("a.obj", testing_support::wedge_obj()),
                             folder.write("a.dae", testing_support::wedge_dae("Z_UP", 0.001))}) {
        const auto mesh = read_mesh_in_process(file);
        ASSERT_TRUE(mesh) << mesh.error().message();
        EXPECT_EQ(mesh->triangles.size(), 4U) << file;
    }
}

TEST(MeshProcess, names_the_file_that_is_missing_a_folder_or_not_a_mesh) {
    const ScratchFolder folder;
    EXPECT_EQ(read_mesh_in_process(folder / "none.stl").error().code, ErrorCode::not_found);
    std::filesystem::create_directory(folder / "dir.stl");
    EXPECT_EQ(read_mesh_in_process(folder / "dir.stl").error().code, ErrorCode::wrong_kind_of_file);
    const auto found = read_mesh_in_process(folder.write("text.stl", "nothing"));
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, ErrorCode::foreign_format);
    EXPECT_EQ(found.error().file, folder / "text.stl");
}

TEST(MeshProcess, says_that_its_helper_is_missing_or_failed) {
    const ScratchFolder folder;
    const auto file = folder.write("a.stl", testing_support::wedge_stl());
    EXPECT_EQ(read_mesh_in_process(file, folder / "no-helper").error().code, ErrorCode::no_program);
    EXPECT_EQ(read_mesh_in_process(file, "/bin/false").error().code, ErrorCode::foreign_format);
    EXPECT_EQ(read_mesh_in_process(file, "/bin/echo").error().code, ErrorCode::foreign_format);
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
