#include "host/apps/rig/rig_picture.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <array>
#include <filesystem>
#include <map>
#include <string>

#include "hw/rigfile/rig.hpp"

namespace octoskin {
namespace {

HostSetup setup_of(const std::string& rig_file) {
    return make_host_setup(rig::read_rig(OCTOSKIN_SOURCE_DIR "/hw/rigs/" + rig_file).value()).value();
}

/// Elements by "tag.class".
void count(const tinyxml2::XMLElement& element, std::map<std::string, std::size_t>& counts) {
    const char* const css_class = element.Attribute("class");
    ++counts[std::string(element.Name()) + (css_class == nullptr ? "" : std::string(".") + css_class)];
    for (const auto* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement())
        count(*child, counts);
}

std::map<std::string, std::size_t> elements_of(const HostSetup& setup) {
    tinyxml2::XMLDocument document;
    EXPECT_EQ(document.Parse(rig_picture(setup, posture_at_rest(setup.robot)).c_str()),
              tinyxml2::XML_SUCCESS);
    std::map<std::string, std::size_t> counts;
    if (document.RootElement() != nullptr) count(*document.RootElement(), counts);
    return counts;
}

TEST(RigPicture, has_arm_sensors_cones_and_camera_in_three_views) {
    for (const char* file : {"experiment.yaml", "experiment_cone.yaml", "experiment_zones.yaml"}) {
        const HostSetup setup = setup_of(file);
        std::size_t sensors = 0, cones = 0, rays = 0;
        for (const HostNode& node : setup.rig.nodes) {
            for (const HostSensor& sensor : node.sensors) {
                ++sensors;
                for (const HostZone& zone : sensor.zones) (zone.optics.is_cone() ? cones : rays) += 1;
            }
        }
        auto elements = elements_of(setup);
        EXPECT_EQ(elements["circle"], 3 * sensors) << file;
        EXPECT_EQ(elements["title"], 3 * sensors) << file;
        EXPECT_EQ(elements["path.arm"], 3 * setup.rig.body.size()) << file;
        EXPECT_EQ(elements["path.cone"], 3 * cones) << file;
        EXPECT_EQ(elements["path.beam"], 3 * (6 * cones + rays)) << file;
        EXPECT_EQ(elements["path.camera"], 3U * 5) << file;
    }
    EXPECT_EQ(elements_of(setup_of("bench_one_board.yaml"))["path.camera"], 0U);
}

TEST(RigPicture, shows_each_of_several_cameras_with_its_name) {
    HostSetup setup = setup_of("experiment.yaml");
    const std::size_t titles = elements_of(setup)["title"];
    setup.rig.cameras.push_back(setup.rig.cameras.front());
    setup.rig.cameras[0].name = "left";
    setup.rig.cameras[1].name = "right";
    auto elements = elements_of(setup);
    EXPECT_EQ(elements["path.camera"], 3U * 5 * 2);
    EXPECT_EQ(elements["title"], titles + 3U * 2);
    EXPECT_NE(rig_picture(setup, posture_at_rest(setup.robot)).find("camera &#39;left&#39;"),
              std::string::npos);
}

TEST(RigPicture, shows_the_rest_posture_within_the_limits) {
    const HostSetup setup = setup_of("experiment.yaml");
    const auto posture = posture_at_rest(setup.robot);
    ASSERT_EQ(posture.size(), 7U);
    for (std::size_t i = 0; i < posture.size(); ++i)
        EXPECT_TRUE(setup.robot.limits()[i].hold(posture[i], 0.0));
    EXPECT_LT(posture[3], 0.0);  // Panda's fourth joint cannot be at 0
    EXPECT_EQ(posture[0], 0.0);
}

TEST(RigPicture, moves_a_sensor_with_its_link) {
    const HostSetup setup = setup_of("bench_one_board.yaml");
    auto posture = posture_at_rest(setup.robot);
    const std::string before = rig_picture(setup, posture);
    EXPECT_EQ(rig_picture(setup, posture), before);
    posture[0] = 1.0;
    EXPECT_NE(rig_picture(setup, posture), before);
}

}  // namespace
}  // namespace octoskin
