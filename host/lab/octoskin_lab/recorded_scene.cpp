#include "host/lab/octoskin_lab/recorded_scene.hpp"

#include <functional>
#include <utility>

#include "host/apps/command_line/shipped_file.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/recording.hpp"
#include "host/lab/simulation/scene_files.hpp"

namespace octoskin::app {
namespace {

namespace fs = std::filesystem;

/// CRC-32 of a file's content, or why the file cannot be used.
using Checksum = std::function<Result<std::uint32_t, Error>(const FilePlace&)>;

/// A kind of file that the evaluation of a recording needs.
struct Part {
    std::string kind;      ///< "world"; with dashes before it, the option that gives another one
    SourceFile recorded;   ///< as named in meta.yaml
    fs::path given;        ///< on the command line; empty: not given
    FilePlace copy;        ///< written into the recording by simulate; empty: none that is complete
    Checksum checksum_of;  ///< computed as when recording
};

std::string describe(const fs::path& file, const std::optional<std::uint32_t>& crc32) {
    return file.filename().string() + (crc32 ? " (CRC-32 " + crc_text(*crc32) + ")" : "");
}

/// Whether `file` is the recorded one: by its checksum, or by its name if meta.yaml has no checksum.
bool is_recorded(const Part& part, const FilePlace& file) {
    if (!part.recorded.crc32) return file.filename() == part.recorded.file.filename().string();
    const auto crc32 = part.checksum_of(file);
    return crc32 && *crc32 == *part.recorded.crc32;
}

FilePlace take_given(const Part& part, std::vector<std::string>& warnings) {
    if (!part.recorded.file.empty() && !is_recorded(part, part.given)) {
        const auto crc32 = part.checksum_of(part.given);
        warnings.push_back("recorded in " + describe(part.recorded.file, part.recorded.crc32) +
                           ", judging in " +
                           describe(part.given, crc32 ? std::optional(*crc32) : std::nullopt) + ", as --" +
                           part.kind + " specifies");
    }
    return part.given;
}

/// Why `file`, which has the recorded name, is not the recorded file.
AppError other_file(const Part& part, const RecordingPaths& recording, const FilePlace& file) {
    const auto crc32 = part.checksum_of(file);
    Error error{.code = ErrorCode::mismatch,
                .what = "expected the " + part.kind + " that it was recorded in, " +
                        describe(part.recorded.file, part.recorded.crc32),
                .value = file.shown().string(),
                .remedy = "give --" + part.kind,
                .file = recording.directory};
    error.value += crc32 ? " (CRC-32 " + crc_text(*crc32) + ")"
                         : ", which cannot be used (" + crc32.error().message() + ")";
    return {ExitCode::bad_data, std::move(error)};
}

Result<FilePlace, AppError> find(const Part& part, const RecordingPaths& recording,
                                 std::vector<std::string>& warnings) {
    if (!part.given.empty()) return take_given(part, warnings);
    const std::string remedy = "give --" + part.kind;
    if (part.recorded.file.empty()) {
        return fail(ExitCode::usage, {.code = ErrorCode::missing_key,
                                      .what = "does not name the " + part.kind,
                                      .remedy = remedy,
                                      .file = recording.meta().shown(),
                                      .key = part.kind});
    }
    const fs::path name = part.recorded.file.filename();
    // The path in meta.yaml is never opened: a recording from an untrusted source could name any file.
    const FilePlace shipped(shipped_file("hw/worlds/" + name.string()));
    if (shipped.is_there() && part.recorded.crc32 && is_recorded(part, shipped)) return shipped;
    if (!part.copy.empty()) return part.copy;
    std::optional<FilePlace> other;
    for (const FilePlace& candidate : {FilePlace(recording.folder, name), shipped}) {
        if (!candidate.is_there()) continue;
        if (const auto opened = candidate.open(); !opened)
            return fail(ExitCode::bad_data, to_error(opened.error()));
        if (is_recorded(part, candidate)) return candidate;
        if (!other) other = candidate;
    }
    if (other) return unexpected(other_file(part, recording, *other));
    const std::string recorded = part.recorded.file.string();
    return fail(ExitCode::no_input,
                {.code = ErrorCode::not_found,
                 .what = "recorded in " + recorded + ", and no file of that name is in it or shipped",
                 .remedy = remedy + " " + recorded + ", if that is yours",
                 .file = recording.directory,
                 .key = part.kind});
}

Error unreadable(const FilePlace& file) {
    return in_file({ErrorCode::system_error, "cannot be read"}, file.shown());
}

Result<std::uint32_t, Error> scenario_checksum(const FilePlace& file) {
    // Its world is found separately.
    const auto scenario = sim::read_scenario(file, sim::WorldOf::others);
    if (!scenario) return unexpected(scenario.error());
    const auto crc32 = source_file(file, scenario->extended_files).crc32;
    if (!crc32) return unexpected(unreadable(file));
    return *crc32;
}

Result<std::uint32_t, Error> world_checksum(const FilePlace& file) {
    const auto crc32 = crc32_of(file);
    if (crc32) return *crc32;
    const auto opened = file.open();
    return unexpected(opened ? unreadable(file) : to_error(opened.error()));
}

/// The world file. Empty: the scenario's own; only the recording of a real robot may leave it out, with a
/// warning.
Result<FilePlace, AppError> find_world(const RecordingMeta& meta, const GivenScene& given, FilePlace copy,
                                       const RecordingPaths& recording, const FilePlace& scenario,
                                       std::vector<std::string>& warnings) {
    if (meta.world.file.empty() && given.world.empty() && !meta.is_simulated()) {
        warnings.push_back(recording.meta().shown().string() + " names no world: judging in the one that " +
                           scenario.shown().string() + " names; --world gives another");
        return FilePlace();
    }
    return find({"world", meta.world, given.world, std::move(copy), world_checksum}, recording, warnings);
}

/// Whether the recording contains its scene. Error (bad_data): the scene is not as simulate wrote it.
Result<bool, AppError> has_scene(const RecordingMeta& meta, const RecordingPaths& recording) {
    if (!meta.scene_crc32) return false;
    const auto found = crc32_of_scene(recording);
    if (found && *found == *meta.scene_crc32) return true;
    return fail(ExitCode::bad_data,
                {.code = found ? ErrorCode::mismatch : ErrorCode::not_found,
                 .what = "expected the scene (scenario.yaml, world.sdf and what they name) that "
                         "`octoskin-lab simulate` put there, CRC-32 " +
                         crc_text(*meta.scene_crc32) + " in meta.yaml",
                 .value = found ? "CRC-32 " + crc_text(*found) : "files that are missing or cannot be read",
                 .remedy = "put it there again, or give --scenario and --world",
                 .file = recording.directory});
}

}  // namespace

Result<RecordedScene, AppError> read_recorded_scene(const FilePlace& directory, const GivenScene& given) {
    const RecordingPaths recording(directory);
    const auto meta = read_meta(recording);
    if (!meta) return unexpected(reading_error(ExitCode::bad_data, meta.error()));
    std::vector<std::string> warnings;
    const auto scene_there = has_scene(*meta, recording);
    const bool is_whole = scene_there && *scene_there;
    const auto scenario = find({"scenario", meta->scenario, given.scenario,
                                is_whole ? recording.scenario() : FilePlace(), scenario_checksum},
                               recording, warnings);
    if (!scenario) return unexpected(scene_there ? scenario.error() : scene_there.error());
    const auto world =
        find_world(*meta, given, is_whole ? recording.world() : FilePlace(), recording, *scenario, warnings);
    if (!world) return unexpected(scene_there ? world.error() : scene_there.error());
    auto scene = read_scene(*scenario, *world);
    if (!scene) return unexpected(scene.error());
    const auto& of_world = scene->world.warnings();
    warnings.insert(warnings.end(), of_world.begin(), of_world.end());
    return RecordedScene{std::move(*scene), std::move(warnings)};
}

}  // namespace octoskin::app
