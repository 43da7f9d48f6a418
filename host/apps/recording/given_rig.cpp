#include "host/apps/recording/given_rig.hpp"

#include <utility>

#include "host/apps/recording/permission.hpp"

namespace octoskin {

Result<rig::Rig, AppError> read_given_rig(const FilePlace& file, const std::filesystem::path& robot,
                                          ExitCode otherwise) {
    auto rig = rig::read_rig(file, robot);
    if (!rig) return unexpected(reading_error(otherwise, rig.error()));
    return std::move(rig).value();
}

Result<std::string, AppError> robot_text(const rig::Rig& rig) {
    constexpr std::size_t kRobotBytesMax = std::size_t{16} << 20U;  // size limit of the file
    auto robot = rig.urdf.read(kRobotBytesMax);
    if (robot) return std::move(*robot);
    return unexpected(
        reading_error(rig.urdf, {ExitCode::bad_config, to_error(robot.error(), "cannot be read: ")}));
}

}  // namespace octoskin
