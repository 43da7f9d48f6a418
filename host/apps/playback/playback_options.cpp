#include "host/apps/playback/playback_options.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/playback/data_set_playback.hpp"
#include "host/apps/playback/film_playback.hpp"
#include "host/apps/profile/named_mapping.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/io/tum/data_set_camera.hpp"
#include "hw/rigfile/joined.hpp"

namespace octoskin::app {
namespace {

/// The maximum memory of a mapping, bytes: 8 for each voxel of an image's box, and the map itself.
std::uint64_t memory_of(const MappingConfig& mapping) {
    return 8 * std::uint64_t{mapping.depth_box_voxels_max} +
           (std::uint64_t{mapping.map.memory_max_mib} << 20U);
}

/// A recording's own mapping is part of a file that may come from others. If it may take more than the
/// default mapping, it must leave half of this machine's memory free.
Status<AppError> check_memory(const MappingConfig& mapping, const FilePlace& file) {
    const std::uint64_t asked = memory_of(mapping);
    const std::uint64_t machine = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                                  static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    if (asked <= std::max(machine / 2, memory_of(MappingConfig{}))) return Done{};
    return fail(ExitCode::bad_config,
                {.code = ErrorCode::no_resources,
                 .what = fmt::format("expected no more than this machine has, {} MiB", machine >> 20U),
                 .value = fmt::format("{} and {}, which allow {} MiB", mapping.map.memory_max_mib,
                                      mapping.depth_box_voxels_max, asked >> 20U),
                 .remedy = "check the file and, if it is yours, name it with --configuration",
                 .file = file.shown(),
                 .key = "map.memory_max_mib and depth_box_voxels_max"});
}

/// The mapping named by --configuration; else the recording's own mapping.yaml, written by the daemon; else
/// the default.
Result<NamedMapping, AppError> configuration_of(const std::string& asked_for,
                                                const RecordingPaths& recording) {
    if (!asked_for.empty()) return named_mapping(asked_for);
    const FilePlace own = recording.mapping();
    if (!own.is_there()) return named_mapping(kDefaultMapping);
    auto named = mapping_of_file(own);
    if (!named) return named;
    if (auto fits = check_memory(named->mapping, own); !fits) return unexpected(fits.error());
    return named;
}

/// Roll, pitch and yaw about the map's fixed x, y and z, as in a rig's rpy_deg.
std::optional<Eigen::Isometry3d> pose_of(const std::string& text) {
    if (text.empty()) return std::nullopt;
    std::array<double, 6> numbers{};
    std::string_view rest = text;
    for (double& number : numbers) {
        const std::string_view word = rest.substr(0, rest.find(','));
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        const bool is_number =
            error == std::errc{} && end == word.data() + word.size() && std::abs(number) <= 1'000.0;
        const bool is_last = &number == &numbers.back();
        if (!is_number || is_last != (word.size() == rest.size())) {
            throw CommandFailure(ExitCode::usage,
                                 {.code = ErrorCode::bad_argument,
                                  .what = "expected X,Y,Z,ROLL,PITCH,YAW, six numbers from -1000 to 1000, "
                                          "metres and degrees",
                                  .value = "'" + text + "'",
                                  .key = "--pose"});
        }
        rest.remove_prefix(std::min(word.size() + 1, rest.size()));
    }
    const auto turn = [&numbers](std::size_t i, const Eigen::Vector3d& axis) {
        return Eigen::AngleAxisd(numbers.at(i) * std::numbers::pi / 180.0, axis);
    };
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    T_map_camera.translation() = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
    T_map_camera.linear() = (turn(5, Eigen::Vector3d::UnitZ()) * turn(4, Eigen::Vector3d::UnitY()) *
                             turn(3, Eigen::Vector3d::UnitX()))
                                .toRotationMatrix();
    return T_map_camera;
}

}  // namespace

void add_recording_options(CLI::App& command, PlaybackOptions& options) {
    command.add_option(
        "--configuration", options.configuration,
        configuration_help(
            "How measurements become voxels (default: as recorded by the daemon, else denoised)"));
    command.add_option("--rig", options.rig, "Rig (YAML) in place of the recording's")
        ->check(existing_file());
    add_robot_options(command, options.robot, "Robot (URDF) in place of the recording's");
    command.add_flag("--by-capture-time", options.is_by_capture_time,
                     "Play in the order of capture times, even if the recording has the daemon's order");
}

void add_playback_options(CLI::App& command, PlaybackOptions& options) {
    add_recording_options(command, options);
    command.add_option(
        "--camera", options.camera,
        "Of a data set or a lone .oni file: with a --rig of several cameras the name of one, else " +
            rig::joined(tum::kDataSetCameras) + " (default: by the data set's layout, " +
            std::string(tum::kDataSetCameras.front()) + ")");
    command.add_option("--pose", options.pose,
                       "Where the camera of an .oni file without a can.log was, in the map's frame: "
                       "X,Y,Z,ROLL,PITCH,YAW of its optical frame, metres and degrees (default: the rig's)");
}

PlaybackRequest playback_request(const PlaybackOptions& options) {
    const RecordingPaths recording(options.recording);
    if (!options.camera.empty() && !is_data_set(recording) && !lone_film(recording))
        throw CommandFailure(
            ExitCode::usage,
            {.code = ErrorCode::conflict,
             .what = "expected a data set or an .oni file: the cameras of a recording are in its rig",
             .value = "'" + options.camera + "'",
             .remedy = "leave --camera out",
             .file = options.recording,
             .key = "--camera"});
    auto configuration = configuration_of(options.configuration, recording);
    if (!configuration) throw CommandFailure(configuration.error());
    return {.recording = recording,
            .mapping = configuration->mapping,
            .configuration = configuration->name,
            .is_mapping_given = !options.configuration.empty(),
            .maps = every_feed(),
            .rig = options.rig,
            .robot = options.robot,
            .camera = options.camera,
            .T_map_camera = pose_of(options.pose),
            .is_by_capture_time = options.is_by_capture_time,
            .pace = {},
            .listener = nullptr,
            .warn_first = [](const std::string& warning) { spdlog::warn("{}", warning); }};
}

}  // namespace octoskin::app
