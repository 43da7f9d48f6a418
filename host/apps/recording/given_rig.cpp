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

}  // namespace octoskin
