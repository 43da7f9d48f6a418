#include "host/apps/study/results_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include "host/apps/playback/map_origin.hpp"
#include "host/apps/recording/recording.hpp"
#include "host/apps/recording/source_file.hpp"
#include "host/apps/recording/text_file.hpp"

namespace octoskin {
namespace {

constexpr const char* kNotesFile = ".octoskin-experiment";
constexpr const char* kRecording = "recording";
constexpr const char* kMetrics = "metrics.json";
constexpr const char* kReport = "report.html";

/// Of what an experiment left, by name: the CRC-32 of its bytes.
using Notes = std::map<std::string, std::string>;

constexpr std::size_t kNotesBytesMax = 4096;
constexpr std::size_t kFiguresBytesMax = std::size_t{16} << 20U;

/// Empty: nothing there that can be read, or too much.
std::string text_of(const FilePlace& file, std::size_t bytes_max) {
    const auto opened = file.open();
    auto text = opened ? opened->read(bytes_max) : unexpected(opened.error());
    return text && text->size() <= bytes_max ? std::move(*text) : std::string();
}

Notes read_notes(const OpenFolder& folder) {
    std::istringstream in(text_of({folder, kNotesFile}, kNotesBytesMax));
    Notes notes;
    std::string crc;
    std::string name;
    while (in >> crc >> name) notes[name] = crc;
    return notes;
}

/// Empty if it cannot be read, or is not what its name says.
std::string crc_of(const OpenFolder& folder, const std::string& name) {
    const FilePlace place(folder, name);
    const auto crc = name == kRecording ? crc32_of_recording(RecordingPaths(place)) : crc32_of(place);
    return crc ? crc_text(*crc) : "";
}

/// What octoskin itself hides in a folder does not count. In order of names.
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

/// Experiments used to leave no notes; their figures say who made them.
bool is_of_one_without_notes(const OpenFolder& folder) {
    const std::string text = text_of({folder, kMetrics}, kFiguresBytesMax);
    return text.find("\"unknown_space\"") != std::string::npos &&
           text.find("\"program\": \"octoskin") != std::string::npos;
}

/// A map, or the file that speaks of maps, that was not left there by whoever wrote that file.
std::optional<std::string> foreign_map(const NamedFolder& folder) {
    const auto origin = read_map_origin(folder);
    const bool is_told = origin && *origin;
    for (const std::string& name : map_file_names()) {
        const FilePlace map(folder, name);
        if (!map.is_there()) continue;
        const bool is_ours = is_told && (*origin)->maps.contains(name) && !fault_of_map(map, **origin);
        if (!is_ours) return name;
    }
    if (FilePlace(folder, kMapOriginFile).is_there() && !is_told) return kMapOriginFile;
    return std::nullopt;
}

/// The first thing that an experiment would replace and none has left there.
std::optional<std::string> foreign_result(const OpenFolder& folder, const Notes& notes) {
    for (const char* const name : {kRecording, kMetrics, kReport}) {
        const FilePlace place(folder, name);
        if (!place.is_there()) continue;
        // A recording that was never finished: nothing to lose.
        if (name == std::string(kRecording) && place.kind() == EntryKind::folder &&
            names_in(NamedFolder(place)).empty())
            continue;
        const auto note = notes.find(name);
        const bool is_ours = notes.empty() || (note != notes.end() && note->second == crc_of(folder, name));
        if (!is_ours) return name;
    }
    // Replacing a recording removes the maps that were made of it.
    if (auto map = foreign_map(NamedFolder(FilePlace(folder, std::string(kRecording) + "/maps"))))
        return std::string(kRecording) + "/maps/" + *map;
    return foreign_map(NamedFolder(folder));
}

}  // namespace

Status<AppError> check_results_folder(const OpenFolder& folder) {
    const std::set<std::string> names = names_in(NamedFolder(folder));
    if (names.empty()) return Done{};
    const Notes notes = read_notes(folder);
    const bool is_ours = !notes.empty() || is_of_one_without_notes(folder);
    const auto foreign = is_ours ? foreign_result(folder, notes) : *names.begin();
    if (!foreign) return Done{};
    return cannot_create(folder.shown(),
                         fmt::format("has a {} that no experiment left there as it is: nothing is "
                                     "overwritten; move it away, or give another directory",
                                     *foreign));
}

Status<AppError> note_result(const OpenFolder& folder, const std::string& name) {
    Notes notes = read_notes(folder);
    if (notes.empty()) {  // what check_results_folder() let pass without notes
        for (const char* const result : {kRecording, kMetrics, kReport})
            if (FilePlace(folder, result).is_there()) notes[result] = crc_of(folder, result);
    }
    notes[name] = crc_of(folder, name);
    std::string text;
    for (const auto& [noted, crc] : notes) text += fmt::format("{} {}\n", crc, noted);
    return write_text({folder, kNotesFile}, text);
}

}  // namespace octoskin
