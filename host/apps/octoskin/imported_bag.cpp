#include "host/apps/octoskin/imported_bag.hpp"

#include <stdlib.h>

#include <cerrno>
#include <system_error>

#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/octoskin/bridge_program.hpp"
#include "host/apps/recording/text_file.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::app {
namespace {

OpenFolder temporary_parent() {
    auto folder = FilePlace(std::filesystem::temp_directory_path()).make_folder();
    if (!folder) throw CommandFailure(ExitCode::cannot_create, to_error(folder.error()));
    return std::move(folder->folder);
}

/// For this user only.
OpenFolder new_folder(const OpenFolder& parent) {
    std::string name = (parent.path_for_libraries() / "octoskin-import-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
        const std::error_code error(errno, std::generic_category());
        throw CommandFailure(ExitCode::cannot_create,
                             {.code = ErrorCode::system_error,
                              .what = "nothing can be written there (" + error.message() + ")",
                              .remedy = "name another folder with TMPDIR, or " + remedy_of(error),
                              .file = parent.shown()});
    }
    auto folder = parent.open_folder(std::filesystem::path(name).filename());
    if (!folder) throw CommandFailure(ExitCode::cannot_create, to_error(folder.error()));
    return std::move(folder).value();
}

std::vector<std::string> words_of(const std::filesystem::path& bag, const std::filesystem::path& folder,
                                  const std::filesystem::path& rig, const GivenRobot& robot,
                                  const BagOptions& options) {
    std::vector<std::string> words = {"import", "--rig", rig.string()};
    if (!robot.urdf.empty()) words.insert(words.end(), {"--robot", robot.urdf.string()});
    for (const PackagePath& package : robot.packages)
        words.insert(words.end(), {"--package-path", package.name + "=" + package.folder.string()});
    if (!options.joint_states.empty()) words.insert(words.end(), {"--joint-states", options.joint_states});
    for (const std::string& topic : options.can) words.insert(words.end(), {"--can", topic});
    if (options.uses_log_time) words.emplace_back("--log-time");
    words.insert(words.end(), {"--", bag.string(), folder.string()});
    return words;
}

}  // namespace

void add_bag_options(CLI::App& command, BagOptions& options) {
    command.add_option("--joint-states", options.joint_states,
                       "Of an MCAP file: topic of sensor_msgs/JointState (default: /joint_states)");
    command
        .add_option("--can", options.can,
                    "Of an MCAP file: topic of CAN frames. May be given several times (default: "
                    "/from_can_bus and /from_can_bus_fd)")
        ->allow_extra_args(false);
    command.add_flag("--log-time", options.uses_log_time,
                     "Of an MCAP file: times are those at which messages were logged, in place of the stamps "
                     "in their headers");
}

TemporaryFolder::TemporaryFolder()
    : parent_(temporary_parent()),
      folder_(new_folder(parent_)),
      unfinished_(parent_, folder_.shown().filename().string()) {}

TemporaryFolder::~TemporaryFolder() {
    (void)parent_.remove_all(folder_.shown().filename());
}

ImportedBag::ImportedBag(const CLI::App& command, const std::filesystem::path& bag,
                         const std::filesystem::path& rig, const GivenRobot& robot,
                         const BagOptions& options) {
    (void)flush_standard_output();  // the other program's lines follow
    const int code =
        run_bridge(with_form_of_errors(command, words_of(bag, recording(), rig, robot, options)));
    if (code != 0) throw CLI::RuntimeError(code);
}

}  // namespace octoskin::app
