// Several cameras in a rig.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "hw/rigfile/fed_device.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::HasSubstr;

const std::filesystem::path kSharedRigs = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "tests/data/rigs";

/// The required keys besides the name.
constexpr const char* kRest =
    "width_px: 32, height_px: 24, fx_px: 30, fy_px: 30, cx_px: 16, cy_px: 12, rate_hz: 10, "
    "pose: {xyz_m: [1, 0, 1], looking_at_m: [0, 0, 0]}";

std::string item(const std::string& keys) {
    return "\n  - {" + keys + (keys.empty() ? "" : ", ") + kRest + "}";
}

class Cameras : public testing::Test {
  protected:
    Result<Rig, Error> read(const std::string& cameras, const std::string& camera = "~") {
        const std::filesystem::path file = folder_ / "rig.yaml";
        std::ofstream(file) << "extends: " << (kSharedRigs / "one-sensor.yaml").string()
                            << "\ncamera: " << camera << "\ncameras:" << cameras << "\n";
        return read_rig(file);
    }
    Error refused(const std::string& cameras, const std::string& camera = "~") {
        const auto rig = read(cameras, camera);
        EXPECT_FALSE(rig);
        return rig ? Error{} : rig.error();
    }

    testing_support::ScratchFolder folder_;
};

TEST_F(Cameras, are_read_and_written_with_all_that_they_have) {
    std::ofstream(folder_ / "left.oni") << "any";
    const auto rig = read(item("name: left, device: left.oni") +
                          item("name: right.2, device: 'usb:/1', link: arm, depth_min_m: 0.2, "
                               "noise: {noise_m: 0.002, bias_per_m: 0.001}"));
    ASSERT_TRUE(rig) << rig.error().message();
    ASSERT_EQ(rig->cameras.size(), 2U);
    EXPECT_EQ(rig->cameras[0].name, "left");
    EXPECT_EQ(rig->cameras[0].device, (folder_ / "left.oni").string());
    EXPECT_FALSE(rig->cameras[0].noise);
    EXPECT_EQ(rig->cameras[1].device, "usb:/1");
    EXPECT_EQ(rig->cameras[1].noise.value().noise_m, 0.002);
    EXPECT_EQ(rig->cameras[1].noise.value().bias_per_m, 0.001);
    ASSERT_EQ(rig->external_cameras().size(), 1U);
    EXPECT_EQ(rig->external_cameras()[0].name, "left");
    const std::string text = canonical_text(*rig, rig->urdf.shown().string());
    std::ofstream(folder_ / "again.yaml") << text;
    const auto again = read_rig(folder_ / "again.yaml");
    ASSERT_TRUE(again) << again.error().message();
    EXPECT_EQ(canonical_text(*again, rig->urdf.shown().string()), text);
    EXPECT_EQ(rig_hash(*again), rig_hash(*rig));
}

TEST_F(Cameras, have_a_hash_that_depends_on_what_they_see_and_not_on_their_devices) {
    const auto with = [this](const std::string& first, const std::string& second) {
        return read(item(first) + item(second)).value();
    };
    const Rig rig = with("name: a, device: x", "name: b");
    const Rig other_device = with("name: a, device: y", "name: b");
    const Rig other_order = with("name: b", "name: a, device: x");
    const Rig other_noise = with("name: a, noise: {noise_m: 0.01}", "name: b");
    const Rig other_name = with("name: a", "name: c");
    EXPECT_EQ(rig_hash(rig), rig_hash(other_device));
    EXPECT_NE(rig_hash(rig), rig_hash(other_noise));
    EXPECT_NE(rig_hash(rig), rig_hash(other_order));
    EXPECT_NE(rig_hash(rig), rig_hash(other_name));
    EXPECT_EQ(placement_crc32(rig, ""), placement_crc32(other_device, ""));
    EXPECT_EQ(placement_crc32(rig, ""), placement_crc32(other_order, ""));
    EXPECT_EQ(placement_crc32(rig, ""), placement_crc32(other_noise, ""));
}

TEST_F(Cameras, may_be_fed_by_a_program_under_the_name_of_a_topic) {
    for (const char* topic : {"/depth", "/camera/depth/image_rect_raw", "/a/_b2/C"}) {
        const std::string device = std::string("ros:") + topic;
        const auto rig = read(item("name: a, device: '" + device + "'"));
        ASSERT_TRUE(rig) << rig.error().message();
        EXPECT_EQ(rig->cameras[0].device, device);
        EXPECT_TRUE(is_fed_device(rig->cameras[0].device));
    }
    for (const char* topic : {"", "/", "depth", "//depth", "/depth/", "/a//b", "/a b", "/a-b", "/2d", "/a/2d",
                              "/d.oni", "/~a", "/ä", "ros:/a"}) {
        const Error error = refused(item(std::string("name: a, device: 'ros:") + topic + "'"));
        EXPECT_EQ(error.code, ErrorCode::bad_value) << topic;
        EXPECT_EQ(error.key, "cameras[0].device");
        EXPECT_EQ(error.line, 4) << topic;
        EXPECT_EQ(error.value, std::string("'ros:") + topic + "'");
    }
    EXPECT_FALSE(is_fed_device("1d27/0601@1/5"));
    EXPECT_FALSE(is_fed_device("/ros:/a"));
}

TEST_F(Cameras, need_ros_before_a_topic_and_not_before_a_file) {
    EXPECT_EQ(refused(item("name: a, device: /dev/octoskin_none")).code, ErrorCode::bad_value);
    EXPECT_TRUE(read(item("name: a, device: /dev/null")));
}

TEST_F(Cameras, are_refused_with_a_bad_name_or_a_shared_device_or_in_both_forms) {
    for (const char* name : {"''", "-a", ".a", "a/b", "..", "'a b'", "123456789012345678901234567890123"})
        EXPECT_EQ(refused(item(std::string("name: ") + name)).code, ErrorCode::bad_name) << name;
    EXPECT_EQ(refused(item("")).code, ErrorCode::missing_key);
    const Error twice = refused(item("name: a") + item("name: a"));
    EXPECT_EQ(twice.code, ErrorCode::duplicate);
    EXPECT_EQ(twice.key, "cameras[1].name");
    const Error shared = refused(item("name: a, device: x") + item("name: b, device: x"));
    EXPECT_EQ(shared.code, ErrorCode::duplicate);
    EXPECT_EQ(shared.key, "cameras[1].device");
    EXPECT_THAT(shared.remedy, HasSubstr("'a'"));
    EXPECT_EQ(refused(item("name: a"), std::string("{") + kRest + "}").code, ErrorCode::conflict);
    EXPECT_EQ(refused(" ~", std::string("{name: a, ") + kRest + "}").code, ErrorCode::conflict);
    EXPECT_EQ(refused(item("name: a, device: none.oni")).code, ErrorCode::not_found);
    const Error one_topic = refused(item("name: a, device: 'ros:/x'") + item("name: b, device: 'ros:/x'"));
    EXPECT_EQ(one_topic.code, ErrorCode::duplicate);
    EXPECT_EQ(one_topic.key, "cameras[1].device");
    const std::string large =
        "pose: {xyz_m: [1, 0, 1], rpy_deg: [0, 0, 0]}, width_px: 4096, height_px: 4096, "
        "fx_px: 4096, fy_px: 4096, cx_px: 2048, cy_px: 2048, rate_hz: 1}";
    EXPECT_TRUE(read("\n  - {name: a, " + large));
    EXPECT_EQ(refused("\n  - {name: a, " + large + item("name: b")).code, ErrorCode::limit_exceeded);
    EXPECT_EQ(refused(" []").code, ErrorCode::limit_exceeded);
    EXPECT_EQ(refused(" {}").code, ErrorCode::wrong_type);
    std::string many;
    for (std::size_t i = 0; i <= kCamerasMax; ++i) many += item("name: c" + std::to_string(i));
    EXPECT_EQ(refused(many).code, ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace octoskin::rig
