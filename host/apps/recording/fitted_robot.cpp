#include "host/apps/recording/fitted_robot.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/text_file.hpp"
#include "host/io/robot/fit_key.hpp"
#include "host/io/robot/robot_fit.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

fs::path directory_in(const char* variable) {
    const char* const text = std::getenv(variable);
    const fs::path folder = text == nullptr ? "" : text;
    return folder.is_absolute() ? folder : fs::path();
}

Unexpected<AppError> refused(Error error) {
    return unexpected(reading_error(ExitCode::bad_config, std::move(error)));
}

/// Makes its folder. The remedy of each error is to write the file elsewhere.
Result<fs::path, AppError> write_fit(const rig::Rig& rig, const fs::path& folder, const std::string& name,
                                     const std::string& urdf) {
    const std::string remedy =
        fmt::format("run `octoskin robot {} --out FITTED.urdf`, and use FITTED.urdf in the rig",
                    rig.urdf.shown().string());
    if (folder.empty())
        return fail(ExitCode::cannot_create, {.code = ErrorCode::not_found,
                                              .what = "there is no home to keep the fitted robot in",
                                              .remedy = remedy,
                                              .file = rig.urdf.shown()});
    std::error_code ignored;
    fs::create_directories(folder, ignored);
    const auto written = write_text(folder / name, urdf);
    if (!written)
        return unexpected(AppError{written.error().exit, with_remedy(written.error().error, remedy)});
    return folder / name;
}

}  // namespace

fs::path fitted_robot_folder() {
    if (const fs::path cache = directory_in("XDG_CACHE_HOME"); !cache.empty())
        return cache / "octoskin/robots";
    if (const fs::path home = directory_in("HOME"); !home.empty()) return home / ".cache/octoskin/robots";
    return {};
}

Result<bool, AppError> use_fitted_robot(rig::Rig& rig, RobotFitting fitting) {
    if (rig.urdf.folder() != nullptr) return false;
    const auto shapes = rig::read_link_shapes(rig.urdf, rig.base_link);
    if (!shapes) return refused(shapes.error());
    if (!needs_fit(*shapes)) return false;
    const MeshSearch search = mesh_search({});
    const auto key = fit_key(rig.urdf, *shapes, search);
    if (!key) return refused(key.error());
    const fs::path folder = fitted_robot_folder();
    const std::string name = fmt::format("{}.{}.urdf", rig.urdf.name().stem().string().substr(0, 100), *key);
    if (!folder.empty() && FilePlace(folder / name).is_file()) {
        rig.urdf = FilePlace(folder / name);
        return true;
    }
    if (fitting == RobotFitting::kept_only) {
        return refused(
            {.code = ErrorCode::no_data,
             .what = "its links have meshes, and no capsules fitted to them are kept",
             .remedy = fmt::format("run `octoskin rig RIG --robot {}` once as this user, or `octoskin robot "
                                   "{} --out FITTED.urdf` and use FITTED.urdf",
                                   rig.urdf.shown().string(), rig.urdf.shown().string()),
             .file = rig.urdf.shown()});
    }
    const auto robot = fit_robot(rig.urdf, rig.base_link, search);
    if (!robot) return refused(robot.error());
    auto file = write_fit(rig, folder, name, robot->urdf);
    if (!file) return unexpected(file.error());
    rig.urdf = FilePlace(*std::move(file));
    return true;
}

}  // namespace octoskin
