// Recordings of a rig with several cameras: each camera has its own files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing_support::code_is;
using testing_support::key_is;

/// In a list of cameras, as wide as this, seen from another place than the other.
std::string camera_text(const std::string& name, int width_px, double y_m) {
    return fmt::format(
        "- {{name: {}, width_px: {}, height_px: 106, fx_px: 91.25, fy_px: 91.25, cx_px: 64, cy_px: 53, "
        "rate_hz: 10, pose: {{xyz_m: [2.7, {}, 1.8], looking_at_m: [0.4, 0, 0.45]}}}}\n",
        name, width_px, y_m);
}

class CamerasOfRecording : public ProgramTest {
  protected:
    /// The short recording with the images of its camera as those of `left`, and 50 ms later of `right`.
    void make_recording() const {
        record_short("rec");
        fs::create_directory(path("rec/depth"));
        const std::string epoch = content(path("rec/depth.epoch.yaml"));
        const std::string key = "first_frame_us: ";
        const std::size_t at = epoch.find(key) + key.size();
        const long long first_us = std::stoll(epoch.substr(at));
        std::string later = epoch;
        later.replace(at, later.find('\n', at) - at, std::to_string(first_us + 50'000));
        for (const std::string camera : {"left", "right"})
            fs::copy(path("rec/depth.oni"), path("rec/depth/" + camera + ".oni"));
        write(path("rec/depth/left.epoch.yaml"), epoch);
        write(path("rec/depth/right.epoch.yaml"), later);
        fs::remove(path("rec/depth.oni"));
        fs::remove(path("rec/depth.epoch.yaml"));
        write_rig("rig.yaml", camera_text("left", 128, 0.0) + camera_text("right", 128, 0.2));
    }
    void write_rig(const std::string& name, const std::string& cameras) const {
        write(path(name),
              "extends: " + source("tests/data/short/rig.yaml") + "\ncamera: ~\ncameras:\n" + cameras);
    }
    [[nodiscard]] std::string replay(const std::string& rig, const std::string& out) const {
        return "replay " + path("rec") + " --rig " + path(rig) + " --out " + path(out);
    }
};

TEST_F(CamerasOfRecording, are_mapped_each_from_its_own_file_in_whatever_order_the_rig_has_them) {
    make_recording();
    write_rig("swapped.yaml", camera_text("right", 128, 0.2) + camera_text("left", 128, 0.0));
    const Said said = octoskin(replay("rig.yaml", "maps"));
    ASSERT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output, HasSubstr("depth frames of left"));
    EXPECT_THAT(said.output, HasSubstr("depth pixels of right"));
    EXPECT_THAT(said.output, Not(HasSubstr("the recording has")));
    const Said swapped = octoskin(replay("swapped.yaml", "swapped"));
    ASSERT_EQ(swapped.exit_code, 0) << swapped.output;
    EXPECT_TRUE(content(path("maps/fused.ot")) == content(path("swapped/fused.ot")));
    const Said explained =
        octoskin("explain 0.4 0 0.45 --recording " + path("rec") + " --rig " + path("rig.yaml"));
    EXPECT_EQ(explained.exit_code, 0) << explained.output;
}

TEST_F(CamerasOfRecording, without_a_file_or_without_a_place_in_the_rig_are_named) {
    make_recording();
    write_rig("other.yaml", camera_text("left", 128, 0.0) + camera_text("front", 128, 0.2));
    const Said said = octoskin(replay("other.yaml", "maps"));
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output,
                HasSubstr("the rig has a camera 'front', but the recording has no depth/front.oni"));
    EXPECT_THAT(said.output,
                HasSubstr("the recording has a depth/right.oni, but the rig has no camera 'right'"));
    const Said without = octoskin("replay " + path("rec") + " --out " + path("one"));
    EXPECT_EQ(without.exit_code, 0) << without.output;
    EXPECT_THAT(without.output, HasSubstr("no depth.oni: only the ranges are mapped"));
}

TEST_F(CamerasOfRecording, with_a_file_that_cannot_be_read_or_of_another_size_are_named) {
    make_recording();
    write_rig("wide.yaml", camera_text("left", 256, 0.0) + camera_text("right", 128, 0.2));
    const Said wide = octoskin(replay("wide.yaml", "maps"));
    EXPECT_THAT(wide.output,
                HasSubstr("camera 'left': 10 depth images are 128 x 106, the camera's are 256 x 106"));
    const std::string oni = content(path("rec/depth/right.oni"));
    write(path("rec/depth/right.oni"), "foreign");
    const Failure foreign = failure_of(replay("rig.yaml", "maps"));
    EXPECT_THAT(foreign,
                fails_with(65, code_is(ErrorCode::foreign_format), path_is(path("rec/depth/right.oni"))));
    EXPECT_THAT(foreign.output, HasSubstr("depth frames of left"));
    write(path("rec/depth/right.oni"), oni);
    fs::remove(path("rec/depth/right.epoch.yaml"));
    EXPECT_THAT(failure_of(replay("rig.yaml", "maps")),
                fails_with(66, code_is(ErrorCode::not_found), path_is(path("rec/depth/right.epoch.yaml"))));
}

TEST_F(CamerasOfRecording, are_not_read_through_a_link) {
    make_recording();
    fs::rename(path("rec/depth/right.oni"), path("elsewhere.oni"));
    fs::create_symlink(path("elsewhere.oni"), path("rec/depth/right.oni"));
    const std::string command = replay("rig.yaml", "maps");
    EXPECT_THAT(failure_of(command),
                fails_with(66, code_is(ErrorCode::link), path_is(path("rec/depth/right.oni"))));
    fs::rename(path("rec/depth"), path("outside"));
    fs::create_directory_symlink(path("outside"), path("rec/depth"));
    EXPECT_THAT(failure_of(command), fails_with(66, code_is(ErrorCode::link), path_is(path("rec/depth"))));
    fs::remove(path("rec/depth"));
    write(path("rec/depth"), "no folder");
    EXPECT_THAT(failure_of(command),
                fails_with(66, code_is(ErrorCode::wrong_kind_of_file), path_is(path("rec/depth"))));
}

TEST_F(CamerasOfRecording, of_a_film_the_one_is_named_that_it_is_of) {
    make_recording();
    const std::string command = "replay " + path("rec/depth/left.oni") + " --rig " + path("rig.yaml");
    EXPECT_THAT(failure_of(command), fails_with(64, code_is(ErrorCode::bad_argument), key_is("--camera")));
    const Said said = octoskin(command + " --camera left --out " + path("film"));
    EXPECT_EQ(said.exit_code, 0) << said.output;
}

TEST_F(CamerasOfRecording, are_listed_by_the_rig_and_by_the_mapping) {
    write_rig("rig.yaml", camera_text("left", 128, 0.0) + camera_text("right", 128, 0.2));
    const Said rig = octoskin("rig " + path("rig.yaml"));
    EXPECT_EQ(rig.exit_code, 0) << rig.output;
    EXPECT_THAT(rig.output, HasSubstr("camera 'left' 128 x 106 at 10 Hz"));
    EXPECT_THAT(rig.output, HasSubstr("camera 'right' 128 x 106 at 10 Hz"));
    const Said mapping = octoskin("mapping denoised --rig " + path("rig.yaml"));
    EXPECT_EQ(mapping.exit_code, 0) << mapping.output;
    EXPECT_THAT(mapping.output, HasSubstr("# camera 'right'\n# The thinnest object"));
}

}  // namespace
}  // namespace octoskin
