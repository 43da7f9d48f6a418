#include "host/apps/robot/fitted_robot.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <optional>
#include <string>
#include <utility>

#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/version/version.hpp"
#include "host/io/robot/fit_store.hpp"
#include "host/io/robot/robot_fit.hpp"
#include "hw/rigfile/shell_word.hpp"

namespace octoskin {
namespace {

Unexpected<AppError> refused(Error error) {
    return unexpected(reading_error(ExitCode::bad_config, std::move(error)));
}

/// The kept fit; nullopt, with a warning, also for one that is not used.
std::optional<std::string> kept_fit(const FitStore& store, const std::string& key) {
    auto kept = store.find(key);
    if (kept) return *std::move(kept);
    spdlog::warn("an earlier fit is not used: {}", kept.error().message());
    return std::nullopt;
}

Unexpected<AppError> without_fit(const rig::Rig& rig, const FitStore& store) {
    const std::string urdf = rig.urdf.shown().string();
    return refused(
        {.code = ErrorCode::no_data,
         .what = "its links have meshes, and this user has no capsules fitted to them",
         .remedy = fmt::format("run `octoskin robot {} --base {} --out FITTED.urdf`, with the same "
                               "--package-path, and use FITTED.urdf in the rig",
                               rig::shell_word(urdf), rig::shell_word(rig.base_link)),
         .file = urdf,
         .others = store.folder().empty() ? std::string()
                                          : fmt::format("Fits are kept in {}", store.folder().string())});
}

Result<std::string, AppError> new_fit(const RobotText& robot, const MeshSearch& search,
                                      const FitStore& store) {
    spdlog::info("fitting capsules to the meshes of {}", robot.file.shown().string());
    const auto fit =
        fit_robot(robot, search, [](const std::string& link) { spdlog::info("fitting link {}", link); });
    if (!fit) return refused(fit.error());
    if (const auto kept = store.keep(fit->made_of.key(program_version()), fit->urdf); !kept)
        spdlog::warn("the fit is not kept for the next time: {}", kept.error().message());
    return fit->urdf;
}

}  // namespace

Result<std::optional<RobotText>, AppError> robot_to_fit(const rig::Rig& rig) {
    if (rig.urdf.folder() != nullptr) return std::optional<RobotText>();
    auto robot = read_robot_text(rig.urdf, rig.base_link);
    if (!robot) return refused(robot.error());
    if (!needs_fit(robot->shapes)) return std::optional<RobotText>();
    return std::optional(*std::move(robot));
}

Result<rig::Rig, AppError> with_fitted_body(rig::Rig rig, const std::vector<PackagePath>& packages,
                                            BodyFitting fitting) {
    const auto robot = robot_to_fit(rig);
    if (!robot) return unexpected(robot.error());
    if (!*robot) return rig;
    const MeshSearch search = mesh_search(packages);
    const auto ingredients = find_ingredients(**robot, search);
    if (!ingredients) return refused(ingredients.error());
    const FitStore store = FitStore::of_this_user();
    std::optional<std::string> urdf = kept_fit(store, ingredients->key(program_version()));
    if (!urdf && fitting == BodyFitting::kept_only) return without_fit(rig, store);
    if (!urdf) {
        auto fitted = new_fit(**robot, search, store);
        if (!fitted) return unexpected(fitted.error());
        urdf = *std::move(fitted);
    }
    rig.urdf = FilePlace::held(*std::move(urdf), rig.urdf);
    return rig;
}

Result<rig::Rig, AppError> read_rig_with_body(const FilePlace& file, const GivenRobot& robot,
                                              BodyFitting fitting, ExitCode otherwise) {
    auto rig = read_given_rig(file, robot.urdf, otherwise);
    if (!rig) return rig;
    return with_fitted_body(*std::move(rig), robot.packages, fitting);
}

}  // namespace octoskin
