#include "host/lab/study/results_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "host/apps/playback/map_folder.hpp"
#include "host/apps/playback/map_origin.hpp"
#include "host/apps/recording/file_set.hpp"
#include "host/apps/recording/recording.hpp"
#include "host/apps/recording/recording_draft.hpp"
#include "host/apps/recording/source_file.hpp"
#include "host/apps/recording/text_file.hpp"
#include "hw/sim/world/world_copy.hpp"

namespace octoskin {
namespace {

constexpr const char* kNotesFile = ".octoskin-experiment";
constexpr const char* kNotesHead = "octoskin-experiment/1";
constexpr const char* kRecording = "recording";
constexpr const char* kMetrics = "metrics.json";
constexpr const char* kReport = "report.html";

/// Name of each file of an experiment, relative to the folder, and the CRC-32 of its bytes as text.
using Notes = std::map<std::string, std::string>;

constexpr std::size_t kNotesBytesMax = 16'384;

std::string in_recording(const FilePlace& file) {
    return std::string(kRecording) + "/" + file.filename();
}

/// The names, relative to the folder, of all files that an experiment may note.
std::vector<std::string> notable_names(const OpenFolder& folder) {
    std::vector<std::string> names{kMetrics, kReport, kMapOriginFile};
    for (const FilePlace& file : RecordingPaths(FilePlace(folder, kRecording)).files())
        names.push_back(in_recording(file));
    return names;
}

/// Empty: there are no notes, or they are not as an experiment writes them.
Notes read_notes(const OpenFolder& folder) {
    const auto opened = FilePlace(folder, kNotesFile).open();
    const auto text = opened ? opened->read(kNotesBytesMax) : unexpected(opened.error());
    if (!text || text->size() > kNotesBytesMax) return {};
    std::istringstream in(*text);
    std::string line;
    if (!std::getline(in, line) || line != kNotesHead) return {};
    const auto known = notable_names(folder);
    Notes notes;
    while (std::getline(in, line)) {
        const auto space = line.find(' ');
        const std::string name = space == std::string::npos ? "" : line.substr(space + 1);
        const bool is_mesh =
            name.starts_with("recording/") && is_scene_mesh(name.substr(sizeof "recording/" - 1));
        if (!is_mesh && std::find(known.begin(), known.end(), name) == known.end()) return {};
        if (!notes.emplace(name, line.substr(0, space)).second) return {};
    }
    return notes;
}

/// The names in a folder, sorted, without octoskin's own hidden files.
std::set<std::string> names_in(const NamedFolder& named) {
    std::set<std::string> visible;
    const auto folder = named.open();
    const auto names = folder ? folder->names() : unexpected(folder.error());
    if (!names) return visible;
    for (const std::string& name : *names) {
        if (!name.starts_with(".octoskin-")) visible.insert(name);
    }
    return visible;
}

/// A map that does not match the maps.yaml beside it, or a maps.yaml that cannot be read.
std::optional<std::string> foreign_map(const NamedFolder& folder) {
    const auto origin = read_map_origin(folder);
    const bool is_described = origin && *origin;
    for (const std::string& name : map_file_names()) {
        const FilePlace map(folder, name);
        if (!map.is_there()) continue;
        const bool is_ours = is_described && (*origin)->maps.contains(name) && !fault_of_map(map, **origin);
        if (!is_ours) return name;
    }
    if (FilePlace(folder, kMapOriginFile).is_there() && !is_described) return kMapOriginFile;
    return std::nullopt;
}

/// The first file that an experiment would replace but that is not an unchanged result of an earlier one.
std::optional<std::string> foreign_result(const OpenFolder& folder, const Notes& notes) {
    for (const std::string& name : notable_names(folder)) {
        const FilePlace place(folder, name);
        if (!place.is_there()) continue;
        const auto note = notes.find(name);
        const auto crc = crc32_of(place);
        if (note == notes.end() || !crc || note->second != crc_text(*crc)) return name;
    }
    // Replacing a recording removes its maps.
    if (auto map = foreign_map(NamedFolder(FilePlace(folder, std::string(kRecording) + "/maps"))))
        return std::string(kRecording) + "/maps/" + *map;
    return foreign_map(NamedFolder(folder));
}

/// Checks that each place is free or holds something that can be replaced. A link, a pipe, a device or a
/// folder in a file's place cannot be replaced.
Status<AppError> check_places(const OpenFolder& folder) {
    for (const char* const name : {kNotesFile, kMetrics, kReport}) {
        const FilePlace place(folder, name);
        if (const auto checked = check_text_place(place); !checked) return checked;
        if (place.kind() == EntryKind::link)
            return cannot_create(place.shown(), to_error(place.open().error()));
    }
    if (const auto checked = check_map_places(folder); !checked) return checked;
    return RecordingDraft::check({folder, kRecording}, true);
}

}  // namespace

Status<AppError> check_results_folder(const OpenFolder& folder) {
    const std::set<std::string> names = names_in(NamedFolder(folder));
    const Notes notes = read_notes(folder);
    const bool has_notes = FilePlace(folder, kNotesFile).is_there();
    std::optional<std::string> foreign;
    if (!notes.empty()) {
        foreign = foreign_result(folder, notes);
    } else if (has_notes) {
        foreign = kNotesFile;
    } else if (!names.empty()) {
        foreign = *names.begin();
    }
    if (foreign) {
        return cannot_create(
            folder.shown(),
            {.code = ErrorCode::already_exists,
             .what = "expected only unchanged results of an experiment, because nothing else is overwritten",
             .value = "'" + *foreign + "'",
             .remedy = "move it away, or give another directory"});
    }
    return check_places(folder);
}

Status<AppError> note_result(const OpenFolder& folder, const std::string& name) {
    Notes notes = read_notes(folder);
    std::vector<std::string> files{name};
    if (name == kRecording) {
        files.clear();
        for (const FilePlace& file : RecordingPaths(FilePlace(folder, kRecording)).files())
            files.push_back(in_recording(file));
    }
    for (const std::string& file : files) {
        const auto crc = crc32_of(FilePlace(folder, file));
        crc ? static_cast<void>(notes[file] = crc_text(*crc)) : static_cast<void>(notes.erase(file));
    }
    std::string text = std::string(kNotesHead) + "\n";
    for (const auto& [noted, crc] : notes) text += fmt::format("{} {}\n", crc, noted);
    return write_text({folder, kNotesFile}, text);
}

}  // namespace octoskin
