#include "host/apps/octoskin/recorded_scene.hpp"

#include <functional>

#include "host/apps/octoskin/commands.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/recording.hpp"

namespace octoskin::app {
namespace {

namespace fs = std::filesystem;

using Checksum = std::function<std::optional<std::uint32_t>(const FilePlace&)>;

/// A kind of file that a recording is judged with.
struct Part {
    std::string kind;      ///< "world"; with dashes before it, the option that gives another one
    SourceFile recorded;   ///< as meta.yaml has it
    fs::path given;        ///< as the command line has it; empty: not at all
    Checksum checksum_of;  ///< as it was made when recording
};

std::string describe(const fs::path& file, const std::optional<std::uint32_t>& crc32) {
    return file.filename().string() + (crc32 ? " (CRC-32 " + crc_text(*crc32) + ")" : "");
}

/// Whether `file` is what was recorded: by its content, or by its name where meta.yaml has no more.
bool is_recorded(const Part& part, const FilePlace& file) {
    if (part.recorded.crc32) return part.checksum_of(file) == part.recorded.crc32;
    return file.filename() == part.recorded.file.filename().string();
}

FilePlace take_given(const Part& part, std::vector<std::string>& warnings) {
    if (!part.recorded.file.empty() && !is_recorded(part, part.given)) {
        warnings.push_back("recorded in " + describe(part.recorded.file, part.recorded.crc32) +
                           ", judging in " + describe(part.given, part.checksum_of(part.given)) + ", as --" +
                           part.kind + " says");
    }
    return part.given;
}

Result<FilePlace, AppError> find(const Part& part, const RecordingPaths& recording,
                                 std::vector<std::string>& warnings) {
    if (!part.given.empty()) return take_given(part, warnings);
    const std::string remedy = ": give --" + part.kind;
    if (part.recorded.file.empty()) {
        return unexpected(
            AppError{ExitCode::usage, recording.meta().shown().string() + " names no " + part.kind + remedy});
    }
    const fs::path name = part.recorded.file.filename();
    std::optional<FilePlace> other;
    // Never by the path that meta.yaml has: a recording of somebody else's would choose what is opened.
    for (const FilePlace& candidate :
         {FilePlace(recording.folder, name), FilePlace(shipped_file("hw/worlds/" + name.string()))}) {
        if (!candidate.is_there()) continue;
        if (const auto opened = candidate.open(); !opened)
            return unexpected(AppError{ExitCode::bad_data, opened.error().message()});
        if (is_recorded(part, candidate)) return candidate;
        if (!other) other = candidate;
    }
    if (!other) {
        return unexpected(AppError{ExitCode::no_input, recording.directory.string() + ": recorded in " +
                                                           part.recorded.file.string() +
                                                           ", and no file of that name is in it or shipped" +
                                                           remedy + " " + part.recorded.file.string() +
                                                           ", if that is yours"});
    }
    return unexpected(AppError{
        ExitCode::bad_data,
        recording.directory.string() + ": recorded in " + describe(part.recorded.file, part.recorded.crc32) +
            ", judging in " + other->shown().string() + " (CRC-32 " +
            crc_text(part.checksum_of(*other).value_or(0)) + "), which is another" + remedy});
}

std::optional<std::uint32_t> scenario_checksum(const FilePlace& file) {
    const auto scenario = sim::read_scenario(file);
    if (!scenario) return std::nullopt;
    return source_file(file, scenario->extended_files).crc32;
}

/// The world; empty: the scenario's own, which only the recording of a robot may mean, and with a warning.
Result<FilePlace, AppError> find_world(const RecordingMeta& meta, const GivenScene& given,
                                       const RecordingPaths& recording, const FilePlace& scenario,
                                       std::vector<std::string>& warnings) {
    if (meta.world.file.empty() && given.world.empty() && !meta.is_simulated()) {
        warnings.push_back(recording.meta().shown().string() + " names no world: judging in the one that " +
                           scenario.shown().string() + " names; --world gives another");
        return FilePlace();
    }
    return find({"world", meta.world, given.world, [](const FilePlace& file) { return crc32_of(file); }},
                recording, warnings);
}

}  // namespace

Result<RecordedScene, AppError> read_recorded_scene(const fs::path& directory, const GivenScene& given) {
    const RecordingPaths recording(directory);
    const auto meta = read_meta(recording);
    if (!meta) return unexpected(reading_error(ExitCode::bad_data, meta.error()));
    std::vector<std::string> warnings;
    const auto scenario =
        find({"scenario", meta->scenario, given.scenario, scenario_checksum}, recording, warnings);
    if (!scenario) return unexpected(scenario.error());
    const auto world = find_world(*meta, given, recording, *scenario, warnings);
    if (!world) return unexpected(world.error());
    auto scene = read_scene(*scenario, *world);
    if (!scene) return unexpected(scene.error());
    return RecordedScene{std::move(*scene), std::move(warnings)};
}

RecordingBeside recording_beside(const fs::path& map) {
    std::error_code error;
    const auto folder = fs::absolute(map, error).lexically_normal().parent_path();
    RecordingBeside found;
    for (const fs::path& candidate : {folder / "recording", folder.parent_path(), folder}) {
        const RecordingPaths recording(candidate);
        if (!recording.meta().is_there()) continue;
        const auto meta = read_meta(recording);
        if (meta) {
            found.directory = candidate;
            return found;
        }
        found.warnings.push_back(meta.error().message() +
                                 "; mend that file, or the map is not judged as this recording's");
    }
    return found;
}

}  // namespace octoskin::app
