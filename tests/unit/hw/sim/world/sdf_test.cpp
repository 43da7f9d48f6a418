// SDF files: what is read, how poses compose, and what each kind of bad file is told. Oracle: numbers worked
// out by hand from the file's text.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "host/io/folder/open_folder.hpp"
#include "hw/sim/world/model_folders.hpp"
#include "hw/sim/world/solids_bytes.hpp"
#include "hw/sim/world/world.hpp"
#include "hw/sim/world/world_copy.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::key_is;
using testing_support::value_is;
using testing_support::what_is;

const std::filesystem::path kData = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "tests/data/worlds";
const std::filesystem::path kWorlds = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/worlds";

Error error_of(const std::string& name) {
    const auto world = World::read(kData / name);
    EXPECT_FALSE(world.has_value()) << name << " was accepted";
    const Error error = error_in(world);
    EXPECT_EQ(error.file, kData / name);
    EXPECT_TRUE(has_its_fields(error));
    return error;
}

TEST(Sdf, composes_the_poses_of_model_link_and_visual) {
    // Model at (1 2 3) turned 90 degrees about z; link at (1 0 0) in it; visual at (0 0 0.5) turned 90
    // degrees about x: a box of 0.2 x 0.4 x 0.6 that ends up centred at (1, 3, 3.5) with sides 0.6 x 0.2 x
    // 0.4.
    const auto world = World::read(kData / "composed-poses.sdf");
    ASSERT_TRUE(world) << world.error().message();
    ASSERT_EQ(world->solids().size(), 1u);
    EXPECT_EQ(world->solids()[0].name, "turned/arm/box");
    EXPECT_EQ(world->solids()[0].model, "turned");
    Eigen::AlignedBox3d bounds;
    for (const auto& vertex : world->solids()[0].vertices) {
        bounds.extend(vertex);
    }
    EXPECT_NEAR((bounds.min() - Eigen::Vector3d(0.7, 2.9, 3.3)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((bounds.max() - Eigen::Vector3d(1.3, 3.1, 3.7)).norm(), 0.0, 1e-12);
}

TEST(Sdf, resolves_poses_relative_to_frames_and_models_within_models) {
    // Frame 'table' at z = 0.7; model 'tray' 0.1 above it; nested model 'cup' at x = 0.3 in that.
    const auto world = World::read(kData / "nested-models-and-frames.sdf");
    ASSERT_TRUE(world) << world.error().message();
    ASSERT_EQ(world->solids().size(), 2u);
    EXPECT_EQ(world->solids()[1].name, "tray::cup/body/ball");
    EXPECT_EQ(world->solids()[1].model, "tray");
    const auto hit = world->cast({0.3, 0.0, 5.0}, -Eigen::Vector3d::UnitZ(), 10.0);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->range_m, 5.0 - (0.7 + 0.1 + 0.05), 1e-4);
}

TEST(Sdf, reads_every_supported_shape_from_a_file_with_a_single_model) {
    const auto world = World::read(kData / "every-shape.sdf");
    ASSERT_TRUE(world) << world.error().message();
    std::vector<std::string> names;
    for (const auto& solid : world->solids()) {
        names.push_back(solid.name);
        EXPECT_EQ(solid.is_closed, solid.name != "zoo/body/plane");
        EXPECT_EQ(solid.model, "zoo");
    }
    EXPECT_THAT(names, testing::ElementsAre("zoo/body/box", "zoo/body/cylinder", "zoo/body/sphere",
                                            "zoo/body/capsule", "zoo/body/ellipsoid", "zoo/body/plane",
                                            "zoo/body/mesh"));
    EXPECT_TRUE(world->is_inside({6.0, 0.0, 0.19})) << "a mirrored mesh keeps its interior";
    EXPECT_FALSE(world->is_inside({6.0, 0.0, 0.21}));
}

TEST(Sdf, names_the_element_with_an_unsupported_shape_and_the_supported_ones) {
    EXPECT_THAT(error_of("heightmap.sdf"),
                AllOf(key_is("model 'hill', link 'body', visual 'slope'"),
                      what_is(AllOf(HasSubstr("'heightmap'"), HasSubstr("box, cylinder, sphere")))));
    EXPECT_THAT(error_of("cone-element.sdf"),
                AllOf(key_is(StartsWith("model '")), what_is(AllOf(HasSubstr("line 7"), HasSubstr("'cone'"),
                                                                   HasSubstr("box, cylinder, sphere")))));
    EXPECT_THAT(error_of("empty-geometry.sdf"),
                AllOf(key_is(HasSubstr("visual 'nothing'")), what_is(HasSubstr("empty"))));
}

TEST(Sdf, passes_on_the_parsers_message_for_a_broken_file) {
    EXPECT_THAT(error_of("broken-xml.sdf"), AllOf(code_is(ErrorCode::bad_syntax), key_is("line 6"),
                                                  what_is(HasSubstr("not well-formed XML"))));
    EXPECT_THAT(error_of("robot-instead.sdf"),
                AllOf(code_is(ErrorCode::foreign_format), what_is(HasSubstr("'sdf'")), value_is("'robot'")));
    EXPECT_THAT(error_of("misspelt-element.sdf"), what_is(AllOf(HasSubstr("line 5"), HasSubstr("poze"))));
    EXPECT_THAT(error_of("text-for-a-number.sdf"), what_is(AllOf(StartsWith("line 7"), HasSubstr("left"))));
    EXPECT_THAT(error_of("no-such-file.sdf"),
                AllOf(code_is(ErrorCode::not_found), what_is(HasSubstr("no such file"))));
    EXPECT_THAT(error_of("empty.sdf"), Not(what_is("")));
}

/// A world with a box of 0.2 m, something else in its link and visual, and in the world.
std::string world_with(const std::string& in_link, const std::string& in_world = "") {
    return "<?xml version='1.0'?>\n<sdf version='1.9'><world name='w'>" + in_world +
           "\n<model name='crate'><link name='l'>" + in_link +
           "<visual name='v'><geometry><box><size>0.2 0.2 0.2</size></box></geometry></visual></link></model>"
           "</world></sdf>\n";
}

std::string inertia(double izz) {
    return "<inertial><mass>1</mass><inertia><ixx>1</ixx><ixy>0</ixy><ixz>0</ixz><iyy>1</iyy><iyz>0</iyz>"
           "<izz>" +
           std::to_string(izz) + "</izz></inertia></inertial>";
}

TEST(Sdf, warns_of_what_the_parser_does_not_know_and_rays_do_not_need) {
    const testing_support::ScratchFolder scratch;
    struct Case {
        std::string text;
        std::string named;
    };
    const std::string lamp = "<light name='lamp' type='point'><visualize>false</visualize></light>";
    for (const Case& each :
         {Case{world_with("<inertial auto='true'><density>600</density></inertial>"), "line 3, "},
          Case{world_with("<inertial auto='true'><density>600</density></inertial>"),
               "<density> in <inertial>"},
          Case{world_with("", lamp), "<visualize> in <light>"},
          Case{world_with("<sensor name='s' type='of_tomorrow'/>"),
               "a sensor without a type or of unknown type"},
          Case{world_with("<fluid_added_mass/>"), "model[@name=\"crate\"]"},
          Case{world_with("<collision name='c'><geometry><cone/></geometry></collision>"),
               "<cone> in <geometry>"},
          Case{world_with(inertia(5.0)), "model 'crate', link 'l': its inertia"}}) {
        const auto world = World::read(scratch.write("w.sdf", each.text));
        ASSERT_TRUE(world) << world.error().message();
        EXPECT_EQ(world->solids().size(), 1U);
        ASSERT_EQ(world->warnings().size(), 1U) << each.text;
        EXPECT_THAT(world->warnings()[0], AllOf(HasSubstr("w.sdf: "), HasSubstr(each.named)));
    }
    const std::string other = "<light name='other' type='point'><visualize>true</visualize></light>";
    const auto twice = World::read(scratch.write("w.sdf", world_with("", lamp + other)));
    ASSERT_TRUE(twice) << twice.error().message();
    ASSERT_EQ(twice->warnings().size(), 1U);
    EXPECT_THAT(twice->warnings()[0], HasSubstr("(2 in all)"));
    const auto sound = World::read(scratch.write("w.sdf", world_with(inertia(1.5))));
    ASSERT_TRUE(sound) << sound.error().message();
    EXPECT_TRUE(sound->warnings().empty());
}

TEST(Sdf, takes_a_ground_of_any_use_and_refuses_one_beyond_all_measure) {
    const testing_support::ScratchFolder scratch;
    const auto ground = [&](const std::string& size) {
        return World::read(scratch.write(
            "w.sdf", world_with("<visual name='ground'><geometry><plane><normal>0 0 1</normal><size>" + size +
                                "</size></plane></geometry></visual>")));
    };
    EXPECT_TRUE(ground("10000 10000"));
    EXPECT_TRUE(ground("1e9 1e9"));
    for (const char* const size : {"3e9 1", "1 1e200", "1e308 1e308"}) {
        const auto world = ground(size);
        ASSERT_FALSE(world) << size;
        EXPECT_THAT(world.error(), AllOf(key_is(HasSubstr("visual 'ground'")), what_is(HasSubstr("1e9 m"))));
    }
}

TEST(Sdf, refuses_an_unknown_element_that_may_decide_what_is_seen) {
    const testing_support::ScratchFolder scratch;
    const auto visual = [](const std::string& inside) {
        return world_with("<visual name='w'>" + inside + "</visual>");
    };
    const std::string box = "<geometry><box><size>1 1 1</size></box></geometry>";
    for (const std::string& text :
         {visual("<geometry><box><siez>1 1 1</siez><size>1 1 1</size></box></geometry>"),
          visual(box + "<poze>1 0 0 0 0 0</poze>"), visual(box + "<posse>1 0 0 0 0 0</posse>"),
          world_with("<visal name='x'>" + box + "</visal>"), world_with("", "<mode name='x'/>")}) {
        const auto world = World::read(scratch.write("w.sdf", text));
        ASSERT_FALSE(world) << text;
        EXPECT_THAT(world.error(), what_is(HasSubstr("not defined in SDF")));
    }
}

/// Has only these folders in an environment's variable while it lives.
class ModelFolders {
  public:
    ModelFolders(const char* variable, const std::string& folders) : variable_(variable) {
        for (const char* each : kModelFolderVariables) ::unsetenv(each);
        ::setenv(variable, folders.c_str(), 1);
    }
    ModelFolders(const ModelFolders&) = delete;
    ModelFolders& operator=(const ModelFolders&) = delete;
    ~ModelFolders() { ::unsetenv(variable_); }

  private:
    const char* variable_;
};

class ModelUri : public testing::Test {
  protected:
    ModelUri() {
        std::filesystem::create_directories(scratch_ / "models/crate/meshes");
        std::filesystem::create_directories(scratch_ / "others/crate/meshes");
        scratch_.write("models/crate/model.config",
                       "<model><name>crate</name><sdf version='1.6'>model.sdf</sdf></model>");
        scratch_.write("models/crate/model.sdf",
                       "<sdf version='1.6'><model name='crate'><static>true</static><link name='l'>" +
                           inertia(5.0) + mesh_visual("model://crate/meshes/a.obj") +
                           "</link></model></sdf>");
        scratch_.write("models/crate/meshes/a.obj",
                       "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    }
    static std::string mesh_visual(const std::string& uri) {
        return "<visual name='v'><geometry><mesh><uri>" + uri + "</uri></mesh></geometry></visual>";
    }
    static std::string mesh_collision(const std::string& uri) {
        return "<collision name='c'><geometry><mesh><uri>" + uri + "</uri></mesh></geometry></collision>";
    }
    std::filesystem::path world(const std::string& inside) {
        return scratch_.write("w.sdf", "<sdf version='1.6'><world name='w'>" + inside + "</world></sdf>");
    }
    std::string models() const { return (scratch_ / "models").string(); }

    testing_support::ScratchFolder scratch_;
};

TEST_F(ModelUri, is_found_for_includes_and_meshes_by_every_variable) {
    const auto included = world(
        "<include><uri>model://crate</uri><pose>0.6 0 0 0 0 0</pose></include><model name='m'><link "
        "name='l'>" +
        mesh_visual("model://crate/meshes/a.obj") + "</link></model>");
    for (const char* variable : kModelFolderVariables) {
        for (const std::string& folders : {models(), "/nonexistent:" + models() + ":/tmp"}) {
            const ModelFolders set(variable, folders);
            const auto read = World::read(included);
            ASSERT_TRUE(read) << variable << ": " << read.error().message();
            ASSERT_EQ(read->solids().size(), 2U);
            EXPECT_EQ(read->solids()[0].model, "crate");
            EXPECT_EQ(read->solids()[0].vertices.size(), 4U);
            ASSERT_EQ(read->warnings().size(), 1U);
            EXPECT_THAT(read->warnings()[0], HasSubstr("model 'crate', link 'l': its inertia"));
        }
    }
}

TEST_F(ModelUri, of_what_is_included_is_in_the_world_that_is_written_out) {
    const ModelFolders set("SDF_PATH", models());
    std::filesystem::create_directory(scratch_ / "models/box");
    scratch_.write("models/box/model.config",
                   "<model><name>box</name><sdf version='1.5'>b.sdf</sdf></model>");
    scratch_.write(
        "models/box/b.sdf",
        "<sdf version='1.5'><model name='box'><link name='l'><pose>0.1 0.123456789012 0 0 0.7 0</pose>" +
            mesh_visual("../crate/meshes/a.obj") + mesh_collision("../../secret.json") +
            "</link></model></sdf>");
    const auto file = world(
        "<include><uri>model://crate</uri><name>one</name><pose>0.6 0 0 0.1 0.2 "
        "0.333333333333</pose></include>"
        "<model name='m'><pose>0 0 1 0 0 1.5</pose><include><uri>model://box</uri></include><link name='l'>" +
        mesh_visual("models/crate/meshes/a.obj") + "</link></model>");
    const auto read = World::read(file);
    ASSERT_TRUE(read) << read.error().message();
    ASSERT_EQ(read->solids().size(), 3U);
    const auto copy = copy_of_world(file, read->meshes(), read->written_out());
    ASSERT_TRUE(copy) << copy.error();
    EXPECT_EQ(copy->sdf.find("include"), std::string::npos);
    EXPECT_EQ(copy->meshes.size(), 3U) << "by as many names";
    EXPECT_EQ(copy->left_out.size(), 1U) << "which no sensor sees";
    std::filesystem::create_directory(scratch_ / "rec");
    for (const MeshCopy& mesh : copy->meshes) scratch_.write("rec/" + mesh.name, mesh.bytes);
    scratch_.write("rec/world.sdf", copy->sdf);
    std::filesystem::remove_all(scratch_ / "models");
    const auto again =
        World::read(FilePlace(OpenFolder::open(scratch_ / "rec", FolderAccess::read).value(), "world.sdf"));
    ASSERT_TRUE(again) << again.error().message();
    EXPECT_EQ(to_bytes(SolidsOfFile{again->solids()}), to_bytes(SolidsOfFile{read->solids()}));
    EXPECT_EQ(again->written_out(), "");
}

TEST_F(ModelUri, is_known_of_a_mesh_that_was_read_and_of_no_other) {
    scratch_.write("secret.json", "{}");
    const std::string secret = (scratch_ / "secret.json").string();
    const std::string in_a_visual = mesh_visual(secret);
    const auto file =
        world("<plugin name='p' filename='p.so'>" + in_a_visual + "</plugin><model name='m'><link name='l'>" +
              mesh_collision(secret) + mesh_visual("file://models/crate/meshes/a.obj") +
              "</link><plugin name='p' filename='p.so'>" + in_a_visual + "</plugin></model>");
    const auto read = World::read(file);
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->meshes(), std::vector<std::string>{"file://models/crate/meshes/a.obj"});
    const auto copy = copy_of_world(file, read->meshes(), read->written_out());
    ASSERT_TRUE(copy) << copy.error();
    EXPECT_EQ(copy->meshes.size(), 1U);
    EXPECT_EQ(copy->left_out, std::vector<std::string>{secret});
    EXPECT_EQ(World::read(scratch_.write("copy.sdf", copy->sdf)).has_value(), false)
        << "its mesh is not there";
    scratch_.write(copy->meshes[0].name, copy->meshes[0].bytes);
    EXPECT_TRUE(World::read(scratch_ / "copy.sdf"));
}

TEST_F(ModelUri, of_an_earlier_folder_hides_that_of_a_later_one) {
    scratch_.write("others/crate/meshes/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const auto mesh = world("<model name='m'><link name='l'>" + mesh_visual("model://crate/meshes/a.obj") +
                            "</link></model>");
    const std::string others = (scratch_ / "others").string();
    const ModelFolders set("GZ_SIM_RESOURCE_PATH", models());
    put_model_folders_first({others});
    EXPECT_EQ(World::read(mesh)->solids()[0].vertices.size(), 3U);
    ::setenv("SDF_PATH", (models() + ":" + others).c_str(), 1);
    EXPECT_EQ(World::read(mesh)->solids()[0].vertices.size(), 4U);
    ::unsetenv("SDF_PATH");
}

TEST_F(ModelUri, that_is_nowhere_is_refused_with_what_would_help) {
    const ModelFolders set("SDF_PATH", "/nonexistent");
    const auto error_of_world = [&](const std::string& inside) {
        return error_in(World::read(world(inside)));
    };
    EXPECT_THAT(error_of_world("\n<include><uri>model://crate</uri></include>"),
                AllOf(file_is("w.sdf"), what_is(AllOf(HasSubstr("line 2: "), HasSubstr("model://crate"),
                                                      HasSubstr("--model-path")))));
    EXPECT_THAT(error_of_world("<include><uri>https://fuel.example/1.0/a/models/b</uri></include>"),
                what_is(AllOf(HasSubstr("octoskin fetches nothing"), HasSubstr("--model-path"))));
    EXPECT_THAT(
        error_of_world("<model name='m'><link name='l'>" + mesh_visual("https://fuel.example/a/files/b.dae") +
                       "</link></model>"),
        AllOf(key_is("model 'm', link 'l', visual 'v'"), what_is(HasSubstr("octoskin fetches nothing"))));
    EXPECT_THAT(error_of_world("<model name='m'><link name='l'>" + mesh_visual("model://crate/meshes/a.obj") +
                               "</link></model>"),
                AllOf(key_is("model 'm', link 'l', visual 'v'"),
                      what_is(AllOf(HasSubstr("model://crate/meshes/a.obj"), HasSubstr("--model-path")))));
}

TEST_F(ModelUri, of_a_world_inside_a_recording_is_never_looked_for) {
    const ModelFolders set("SDF_PATH", models());
    (void)world("<model name='m'><link name='l'>" + mesh_visual("model://crate/meshes/a.obj") +
                "</link></model>");
    const FilePlace inside(OpenFolder::open(scratch_.path(), FolderAccess::read).value(), "w.sdf");
    const auto mesh = World::read(inside);
    ASSERT_FALSE(mesh);
    EXPECT_THAT(mesh.error(), what_is(HasSubstr("is not supported")));
    (void)world("<include><uri>model://crate</uri></include>");
    EXPECT_FALSE(World::read(inside));
}

TEST(Sdf, refuses_sizes_and_meshes_that_make_no_solid) {
    EXPECT_THAT(error_of("negative-radius.sdf"), AllOf(key_is("model 'ball', link 'body', visual 'ball'"),
                                                       what_is(HasSubstr("above 0 and up to 100"))));
    EXPECT_THAT(error_of("nan-pose.sdf"), Not(what_is("")));
    EXPECT_THAT(error_of("missing-mesh.sdf"),
                AllOf(key_is(HasSubstr("visual 'shell'")), what_is(HasSubstr("no-such-mesh.obj"))));
    EXPECT_THAT(error_of("mesh-without-triangles.sdf"), what_is(HasSubstr("points-only.obj")));
    EXPECT_THAT(error_of("nothing-to-see.sdf"), what_is(HasSubstr("no visual")));
}

TEST(Sdf, survives_every_truncation_of_a_good_file) {
    std::ifstream input(kData / "composed-poses.sdf");
    const std::string text(std::istreambuf_iterator<char>(input), {});
    const testing_support::ScratchFolder scratch;
    for (std::size_t length = 0; length + 2 < text.size(); length += 7) {
        const auto cut_file = scratch.write("cut.sdf", text.substr(0, length));
        EXPECT_FALSE(World::read(cut_file).has_value()) << "cut at " << length;
    }
}

class ExperimentWorld : public testing::Test {
  protected:
    void SetUp() override {
        auto read = World::read(kWorlds / "experiment.sdf");
        ASSERT_TRUE(read) << read.error().message();
        world_ = std::make_unique<World>(std::move(*read));
    }
    double range(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
        const auto hit = world_->cast(origin, direction, 20.0);
        return hit ? hit->range_m : -1.0;
    }
    std::unique_ptr<World> world_;
};

TEST_F(ExperimentWorld, consists_of_closed_solids_of_the_five_models) {
    std::set<std::string> models;
    for (const auto& solid : world_->solids()) {
        EXPECT_TRUE(solid.is_closed) << solid.name;
        models.insert(solid.model);
    }
    EXPECT_THAT(models, testing::ElementsAre("cone", "crate", "floor", "shelf_left", "shelf_right"));
    EXPECT_EQ(world_->solids().size(), 15u);
}

TEST_F(ExperimentWorld, has_floor_and_crate_where_the_scene_says) {
    EXPECT_NEAR(range({-0.5, 0.0, 1.0}, -Eigen::Vector3d::UnitZ()), 1.02, 1e-9);
    EXPECT_NEAR(range({0.67, 0.34, 1.0}, -Eigen::Vector3d::UnitZ()), 0.70, 1e-9);
    EXPECT_NEAR(range({0.0, 0.34, 0.1}, Eigen::Vector3d::UnitX()), 0.58, 1e-9);
    EXPECT_NEAR(range({0.67, 0.0, 0.1}, Eigen::Vector3d::UnitY()), 0.24, 1e-9);
}

TEST_F(ExperimentWorld, has_the_cone_with_its_apex_above_its_middle) {
    // Half way up, the cone's radius is half of 0.13; its facets lie up to 0.07 mm inside.
    EXPECT_NEAR(range({0.0, -0.32, 0.18}, Eigen::Vector3d::UnitX()), 0.66 - 0.065, 1e-4);
    EXPECT_NEAR(range({0.66, -0.32, 1.0}, -Eigen::Vector3d::UnitZ()), 1.0 - 0.38, 1e-5);
    EXPECT_TRUE(world_->is_inside({0.66, -0.32, 0.37}));
    EXPECT_FALSE(world_->is_inside({0.66, -0.32, 0.39}));
}

TEST_F(ExperimentWorld, has_shelves_open_towards_the_robot_and_closed_towards_the_camera) {
    for (const double y : {-0.5, 0.5}) {
        for (const double z : {0.25, 0.7}) {
            // From the robot into a compartment: nothing up to the back panel's inner face.
            EXPECT_NEAR(range({0.8, y, z}, Eigen::Vector3d::UnitX()), 1.165 - 0.8, 1e-9);
            EXPECT_NEAR(range({2.0, y, z}, -Eigen::Vector3d::UnitX()), 2.0 - 1.195, 1e-9);
        }
        EXPECT_NEAR(range({1.0, y, 2.0}, -Eigen::Vector3d::UnitZ()), 2.0 - 0.98, 1e-9);
        EXPECT_NEAR(range({1.0, y, 0.9}, -Eigen::Vector3d::UnitZ()), 0.9 - 0.495, 1e-9);
        EXPECT_NEAR(range({1.0, y, 0.4}, -Eigen::Vector3d::UnitZ()), 0.4 - 0.01, 1e-9);
    }
    EXPECT_NEAR(range({1.0, 0.0, 0.3}, Eigen::Vector3d::UnitY()), 0.085, 1e-9);
    EXPECT_NEAR(range({1.0, 0.0, 0.3}, -Eigen::Vector3d::UnitY()), 0.085, 1e-9);
    EXPECT_NEAR(range({1.0, 2.0, 0.3}, -Eigen::Vector3d::UnitY()), 2.0 - 0.93, 1e-9);
}

}  // namespace
}  // namespace octoskin::sim
