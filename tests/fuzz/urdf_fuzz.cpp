// A robot description: read, or refused with its file and a reason; a robot that is read has a pose at every
// position, and capsules of finite size.
#include <algorithm>
#include <cassert>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/robot/body_shapes.hpp"
#include "host/io/urdf/urdf_robot.hpp"
#include "hw/rigfile/fitted_urdf.hpp"
#include "hw/rigfile/link_shapes.hpp"
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

/// Its meshes and boxes replaced by a capsule: what is written is read again, with that capsule on each link
/// that had one.
void check_fitted(const std::filesystem::path& file, std::string_view text) {
    const auto shapes = rig::read_link_shapes(file, "");
    if (!shapes) {
        assert(!shapes.error().what.empty() && shapes.error().file == file);
        return;
    }
    std::map<std::string, rig::FittedBody> bodies;
    for (const rig::ShapedLink& link : shapes->links) {
        rig::FittedBody& body = bodies[link.name];
        body.is_of_visual = source_of(link) == BodySource::visual;
        if (std::ranges::any_of(body_shapes(link), is_fitted))
            body.capsules = {{link.name, {0, 0, -0.1}, {0, 0, 0.1}, 0.05}};
    }
    const auto fitted = rig::urdf_with_bodies(file, std::string(text), bodies);
    assert(fitted);
    const FilePlace again = FilePlace::held(*fitted, file);
    const auto read = rig::read_link_shapes(again, "");
    if (!read) return;  // longer than the limit of a URDF
    assert(read->links.size() == shapes->links.size());
    for (const rig::ShapedLink& link : read->links) assert(std::ranges::none_of(link.collisions, is_fitted));
}

}  // namespace
}  // namespace octoskin

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    static const fuzz::InputDirectory directory;
    const auto text = fuzz::text_of({data, size});
    const auto file = directory.write("input.urdf", text);
    check_robot(file);
    check_fitted(file, text);
    return 0;
}
