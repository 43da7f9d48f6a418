// A robot description: read, or refused with its file and a reason; a robot that is read has a pose at every
// position, and capsules of finite size.
#include <cassert>
#include <vector>

#include "host/io/urdf/urdf_robot.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/rigfile/urdf_document.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/input_file.hpp"

namespace octoskin {
namespace {

void check_poses(const RobotModel& robot) {
    std::vector<Eigen::Isometry3d> T_base_link(robot.link_count());
    for (const double position : {0.0, 0.5, -3.0}) {
        robot.forward(std::vector<double>(robot.joint_count(), position), T_base_link);
        for (const auto& T : T_base_link) assert(T.matrix().allFinite());
    }
}

void check_robot(const std::filesystem::path& file) {
    const auto document = rig::UrdfDocument::read(file);
    const auto capsules = rig::read_capsules(file, {});
    if (!document) {
        assert(!document.error().what.empty() && document.error().file == file);
        assert(!capsules);
        return;
    }
    for (const std::string& base : document->link_names()) {
        const auto robot = read_robot_model(file, base, document->moving_joints(base));
        if (robot) {
            check_poses(*robot);
        } else {
            assert(!robot.error().what.empty() && robot.error().file == file);
        }
        if (document->link_names().size() > 8) break;  // one is enough of a large robot
    }
    if (!capsules) return;
    for (const rig::Capsule& capsule : *capsules) {
        assert(capsule.p_link_a.allFinite() && capsule.p_link_b.allFinite() && capsule.radius_m > 0.0);
    }
}

}  // namespace
}  // namespace octoskin

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    static const fuzz::InputDirectory directory;
    check_robot(directory.write("input.urdf", fuzz::text_of({data, size})));
    return 0;
}
