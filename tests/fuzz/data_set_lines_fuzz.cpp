// Lines of a data set: taken, or refused with a reason; a pose that is taken is a rigid motion.
#include <cassert>

#include "host/io/tum/data_set_lines.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

void check_rigid(const std::optional<Eigen::Isometry3d>& T) {
    if (!T) return;
    assert(T->matrix().allFinite());
    assert((T->linear() * T->linear().transpose()).isIdentity(1e-9));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    const std::string_view line = fuzz::text_of({data, size});
    if (const auto image = tum::parse_image_line(line)) {
        assert(image->captured.ns >= 0 && !image->file.empty());
    } else {
        assert(!image.error().empty());
    }
    if (const auto pose = tum::parse_pose_line(line)) {
        assert(pose->at.ns >= 0);
        check_rigid(pose->T_map_camera);
    } else {
        assert(!pose.error().empty());
    }
    if (const auto pose = tum::parse_pose_matrix(line)) {
        check_rigid(*pose);
    } else {
        assert(!pose.error().empty());
    }
    return 0;
}
