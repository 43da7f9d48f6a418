// Collision geometry of a URDF as capsules.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "hw/rigfile/robot_description.hpp"
#include "tests/support/errors/error_fields.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::has_its_fields;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;
using Padding = std::map<std::string, double>;

const std::filesystem::path kPanda = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/robots/panda.urdf";

class Capsules : public testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(file_); }
    /// The capsules of a robot with one link, "hull", and this in it.
    Result<std::vector<Capsule>, Error> read(const std::string& collisions, const Padding& padding = {}) {
        write_robot(collisions);
        return read_capsules(file_, padding);
    }
    void write_robot(const std::string& collisions) const {
        std::ofstream(file_) << "<robot name=\"r\">\n  <link name=\"hull\">\n"
                             << collisions << "  </link>\n</robot>\n";
    }
    std::filesystem::path file_ =
        std::filesystem::path(testing::TempDir()) /
        (std::string("octoskin-") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".urdf");
};

std::string sphere(const std::string& xyz, const std::string& radius) {
    return "<collision><origin xyz=\"" + xyz + "\"/><geometry><sphere radius=\"" + radius +
           "\"/></geometry></collision>\n";
}
std::string cylinder(const std::string& origin, const std::string& radius, const std::string& length) {
    return "<collision><origin " + origin + "/><geometry><cylinder radius=\"" + radius + "\" length=\"" +
           length + "\"/></geometry></collision>\n";
}

TEST(PandaBody, is_the_eight_capsules_between_the_joint_frames) {
    const auto capsules = read_capsules(kPanda, {});
    ASSERT_TRUE(capsules) << capsules.error().message();
    struct Expected {
        const char* link;
        Eigen::Vector3d a, b;
        double radius_m;
    };
    // The links' frames are the joint frames; frame 2 shares frame 1's origin, 0.333 above the base.
    const Expected expected[] = {
        {"panda_link0", {0, 0, 0.07}, {0, 0, 0.25}, 0.085},
        {"panda_link1", {0, 0, 0.25 - 0.333}, {0, 0, 0}, 0.08},
        {"panda_link2", {0, 0, 0}, {0, -0.316, 0}, 0.07},
        {"panda_link3", {0, 0, 0}, {0.0825, 0, 0}, 0.07},
        {"panda_link4", {0, 0, 0}, {-0.0825, 0.384, 0}, 0.06},
        {"panda_link6", {0, 0, 0}, {0.088, 0, 0}, 0.06},
        {"panda_link7", {0, 0, 0}, {0, 0, 0.107}, 0.055},
        {"panda_link8", {0, 0, 0}, {0, 0, 0.08}, 0.055},
    };
    ASSERT_EQ(capsules->size(), std::size(expected));
    for (std::size_t i = 0; i < std::size(expected); ++i) {
        const Capsule& capsule = (*capsules)[i];
        EXPECT_EQ(capsule.link, expected[i].link);
        EXPECT_EQ(capsule.radius_m, expected[i].radius_m) << capsule.link;
        const bool is_turned = (capsule.p_link_a - expected[i].a).norm() > 1e-9;
        EXPECT_LT(((is_turned ? capsule.p_link_b : capsule.p_link_a) - expected[i].a).norm(), 1e-15)
            << capsule.link;
        EXPECT_LT(((is_turned ? capsule.p_link_a : capsule.p_link_b) - expected[i].b).norm(), 1e-15)
            << capsule.link;
    }
}

TEST_F(Capsules, cylinder_with_a_sphere_at_each_end_is_one_capsule) {
    const auto capsules =
        read(sphere("0 0 0", "0.1") + cylinder("xyz=\"0 0 0.2\"", "0.1", "0.4") + sphere("0 0 0.4", "0.1"));
    ASSERT_TRUE(capsules) << capsules.error().message();
    ASSERT_EQ(capsules->size(), 1U);
    EXPECT_EQ((*capsules)[0].p_link_a, Eigen::Vector3d(0, 0, 0));
    EXPECT_EQ((*capsules)[0].p_link_b, Eigen::Vector3d(0, 0, 0.4));
    EXPECT_EQ((*capsules)[0].radius_m, 0.1);
}

TEST_F(Capsules, lone_cylinder_is_padded_to_a_capsule) {
    const auto capsules = read(cylinder("xyz=\"1 0 0\" rpy=\"0 1.5707963267948966 0\"", "0.1", "0.4"));
    ASSERT_EQ(capsules->size(), 1U);
    EXPECT_TRUE((*capsules)[0].p_link_a.isApprox(Eigen::Vector3d(0.8, 0, 0)));
    EXPECT_TRUE((*capsules)[0].p_link_b.isApprox(Eigen::Vector3d(1.2, 0, 0)));
}

TEST_F(Capsules, lone_sphere_is_a_capsule_without_length) {
    const auto capsules = read(sphere("0.1 0.2 0.3", "0.05"));
    ASSERT_EQ(capsules->size(), 1U);
    EXPECT_EQ((*capsules)[0].p_link_a, Eigen::Vector3d(0.1, 0.2, 0.3));
    EXPECT_EQ((*capsules)[0].p_link_b, Eigen::Vector3d(0.1, 0.2, 0.3));
}

TEST_F(Capsules, sphere_where_two_cylinders_meet_ends_both) {
    const auto capsules = read(cylinder("xyz=\"0 0 0.2\"", "0.1", "0.4") + sphere("0 0 0.4", "0.1") +
                               cylinder("xyz=\"0 0 0.5\"", "0.1", "0.2"));
    EXPECT_EQ(capsules->size(), 2U);
}

// Each is within the tolerance of the one before.
TEST_F(Capsules, spheres_do_not_shorten_a_cylinder_step_by_step) {
    std::string spheres;
    for (int i = 0; i < 500; ++i) spheres += sphere(fmt::format("0 0 {}", 0.4 - 0.00009 * i), "0.1");
    const auto capsules = read(cylinder("xyz=\"0 0 0.2\"", "0.1", "0.4") + sphere("0 0 0", "0.1") + spheres);
    ASSERT_TRUE(capsules);
    EXPECT_EQ(capsules->front().p_link_a, Eigen::Vector3d(0, 0, 0));
    EXPECT_EQ(capsules->front().p_link_b, Eigen::Vector3d(0, 0, 0.4));
}

TEST_F(Capsules, sphere_of_another_size_or_place_stands_for_itself) {
    EXPECT_EQ(read(cylinder("xyz=\"0 0 0.2\"", "0.1", "0.4") + sphere("0 0 0.4", "0.12"))->size(), 2U);
    EXPECT_EQ(read(cylinder("xyz=\"0 0 0.2\"", "0.1", "0.4") + sphere("0 0 0.41", "0.1"))->size(), 2U);
}

TEST_F(Capsules, padding_of_a_link_is_added_to_its_radius) {
    const auto capsules = read(sphere("0 0 0", "0.05"), {{"hull", 0.02}});
    EXPECT_DOUBLE_EQ((*capsules)[0].radius_m, 0.07);
}

TEST_F(Capsules, padding_of_an_unknown_link_is_refused) {
    const auto capsules = read(sphere("0 0 0", "0.05"), {{"hall", 0.02}});
    ASSERT_FALSE(capsules);
    EXPECT_THAT(capsules.error(), AllOf(code_is(ErrorCode::unknown_name), key_is("link hall")));
}

TEST_F(Capsules, box_and_mesh_are_refused_by_link_and_name) {
    const auto box = read("<collision name=\"lid\"><geometry><box size=\"1 1 1\"/></geometry></collision>\n");
    ASSERT_FALSE(box);
    EXPECT_THAT(box.error(), AllOf(code_is(ErrorCode::unsupported), key_is("link hull"), line_is(2),
                                   what_is(HasSubstr("<collision name=\"lid\">")), value_is("a box"),
                                   remedy_is(HasSubstr("fits_capsules: true"))));
    EXPECT_TRUE(has_its_fields(box.error()));
    const auto mesh = read("<collision><geometry><mesh filename=\"hull.stl\"/></geometry></collision>\n");
    ASSERT_FALSE(mesh);
    EXPECT_THAT(mesh.error(), AllOf(code_is(ErrorCode::unsupported), value_is("a mesh")));
    EXPECT_NE(mesh.error().remedy.find("octoskin robot FILE --out FITTED.urdf"), std::string::npos);
}

TEST_F(Capsules, box_is_the_capsule_around_it_if_the_rig_says_so) {
    std::ofstream(file_) << "<robot name=\"r\"><link name=\"hull\"><collision><origin xyz=\"1 0 0\"/>"
                            "<geometry><box size=\"0.06 0.4 0.08\"/></geometry></collision></link></robot>";
    const auto capsules = read_capsules(file_, {{"hull", 0.01}}, BoxRule::fitted);
    ASSERT_TRUE(capsules) << capsules.error().message();
    ASSERT_EQ(capsules->size(), 1U);
    EXPECT_TRUE((*capsules)[0].p_link_a.isApprox(Eigen::Vector3d(1.0, -0.2, 0)));
    EXPECT_TRUE((*capsules)[0].p_link_b.isApprox(Eigen::Vector3d(1.0, 0.2, 0)));
    EXPECT_NEAR((*capsules)[0].radius_m, 0.05 + 0.01, 1e-12) << "half the diagonal of 6 x 8 cm";
}

TEST_F(Capsules, mesh_is_refused_even_then) {
    std::ofstream(file_) << "<robot name=\"r\"><link name=\"hull\"><collision><geometry><mesh "
                            "filename=\"hull.stl\"/></geometry></collision></link></robot>";
    const auto capsules = read_capsules(file_, {}, BoxRule::fitted);
    ASSERT_FALSE(capsules);
    EXPECT_THAT(capsules.error(), AllOf(code_is(ErrorCode::unsupported), value_is("a mesh")));
}

TEST_F(Capsules, what_the_rig_attaches_is_real_and_padded_like_its_link) {
    std::ofstream(file_) << "<robot name=\"r\"><link name=\"hull\"/></robot>";
    Rig rig;
    rig.urdf = file_;
    rig.link_padding_m["hull"] = 0.01;
    rig.attached_capsules.push_back({.name = "cable",
                                     .link = "hull",
                                     .p_link_a = {0, 0, 0.1},
                                     .p_link_b = {0, 0, 0.3},
                                     .radius_m = 0.02,
                                     .padding_m = 0.05});
    const auto real = real_body(rig);
    ASSERT_EQ(real->size(), 1U);
    EXPECT_EQ((*real)[0].link, "hull");
    EXPECT_EQ((*real)[0].p_link_b, Eigen::Vector3d(0, 0, 0.3));
    EXPECT_EQ((*real)[0].radius_m, 0.02);
    EXPECT_NEAR(padded_body(rig)->at(0).radius_m, 0.08, 1e-12);
}

/// Of the capsule's surface: how far the point furthest along `direction` reaches.
double reach_along(const Capsule& capsule, const Eigen::Vector3d& direction) {
    return std::max(capsule.p_link_a.dot(direction), capsule.p_link_b.dot(direction)) + capsule.radius_m;
}

TEST_F(Capsules, inner_ones_reach_the_flat_faces_and_no_further) {
    const auto inner = [this](const std::string& collisions) {
        write_robot(collisions);
        return read_inner_capsules(file_, BoxRule::fitted).value();
    };
    const Eigen::Vector3d up(0, 0, 1);
    const Eigen::Vector3d right(1, 0, 0);
    for (const double length : {0.4, 0.2, 0.05, 0.0}) {  // of a radius of 0.1: long, a ball's, a flat disc's
        const auto lone = inner(cylinder("xyz=\"0 0 0\"", "0.1", fmt::format("{}", length)));
        ASSERT_EQ(lone.size(), 1U);
        EXPECT_NEAR(reach_along(lone[0], up), length / 2, 1e-12) << length;
        EXPECT_NEAR(reach_along(lone[0], -up), length / 2, 1e-12) << length;
        EXPECT_NEAR(reach_along(lone[0], right), std::min(0.1, length / 2), 1e-12) << length;
        if (length == 0.0) continue;
        const auto one_round = inner(cylinder("xyz=\"0 0 0\"", "0.1", fmt::format("{}", length)) +
                                     sphere(fmt::format("0 0 {}", length / 2), "0.1"));
        ASSERT_EQ(one_round.size(), 1U);
        EXPECT_NEAR(reach_along(one_round[0], up), length / 2 + 0.1, 1e-12) << length;
        EXPECT_LE(reach_along(one_round[0], -up), length / 2 + 1e-12) << length;
        EXPECT_LE(one_round[0].radius_m, 0.1 + 1e-12);
    }
    const auto whole = inner(sphere("0 0 0", "0.1") + cylinder("xyz=\"0 0 0.2\"", "0.1", "0.4") +
                             sphere("0 0 0.4", "0.1") + sphere("1 1 1", "0.3"));
    ASSERT_EQ(whole.size(), 2U);
    EXPECT_NEAR(reach_along(whole[0], up), 0.5, 1e-12);
    EXPECT_NEAR(reach_along(whole[0], -up), 0.1, 1e-12);
    EXPECT_EQ(whole[1].radius_m, 0.3);
    const auto box = inner("<collision><geometry><box size=\"0.08 0.4 0.06\"/></geometry></collision>\n");
    ASSERT_EQ(box.size(), 1U);
    EXPECT_NEAR(reach_along(box[0], {0, 1, 0}), 0.2, 1e-12);
    EXPECT_NEAR(reach_along(box[0], up), 0.03, 1e-12);
    EXPECT_NEAR(reach_along(box[0], right), 0.03, 1e-12);
}

TEST_F(Capsules, what_is_certainly_the_robot_has_no_padding) {
    write_robot(sphere("0 0 0", "0.05"));
    Rig rig;
    rig.urdf = file_;
    rig.link_padding_m["hull"] = 0.1;
    rig.attached_capsules.push_back({.name = "hose", .link = "hull", .radius_m = 0.02, .padding_m = 0.2});
    const auto certain = certain_body(rig);
    ASSERT_TRUE(certain);
    ASSERT_EQ(certain->size(), 2U);
    EXPECT_EQ((*certain)[0].radius_m, 0.05);
    EXPECT_EQ((*certain)[1].radius_m, 0.02);
}

TEST_F(Capsules, absurd_size_is_refused) {
    for (const char* radius : {"0", "-0.1", "50"}) {
        const auto capsules = read(sphere("0 0 0", radius));
        ASSERT_FALSE(capsules) << radius;
        EXPECT_THAT(capsules.error(), AllOf(code_is(ErrorCode::out_of_range), key_is("link hull"),
                                            remedy_is(HasSubstr("metres?"))))
            << radius;
    }
    EXPECT_FALSE(read(cylinder("xyz=\"0 0 0\"", "0.1", "-1")));
    EXPECT_FALSE(read(sphere("0 0 0", "nan")));
    EXPECT_FALSE(read(sphere("0 nan 0", "0.1")));
}

TEST_F(Capsules, robot_without_collision_geometry_has_none) {
    EXPECT_TRUE(read("")->empty());
}

}  // namespace
}  // namespace octoskin::rig
