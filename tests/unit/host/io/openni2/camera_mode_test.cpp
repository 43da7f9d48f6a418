#include "host/io/openni2/camera_mode.hpp"

#include <gtest/gtest.h>

namespace octoskin::openni2 {
namespace {

TEST(CameraMode, goes_through_text) {
    EXPECT_EQ(to_text({640, 480, 30.0}), "640x480@30");
    EXPECT_EQ(to_text({320, 240, 29.97}), "320x240@29.97");
    EXPECT_EQ(parse_camera_mode("640x480@30"), (CameraMode{640, 480, 30.0}));
    EXPECT_EQ(parse_camera_mode("320x240@29.97"), (CameraMode{320, 240, 29.97}));
}

TEST(CameraMode, is_nothing_else) {
    for (const char* text : {"", "640", "640x480", "640x480@", "x480@30", "640x@30", "-1x480@30",
                             "640x480@30 ", "640x480@nan", "640x480@inf", "640X480@30", "99999999999x1@1"})
        EXPECT_FALSE(parse_camera_mode(text)) << text;
}

}  // namespace
}  // namespace octoskin::openni2
