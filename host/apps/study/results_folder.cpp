#include "host/apps/study/results_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include "host/apps/playback/map_origin.hpp"
#include "host/apps/recording/recording.hpp"
#include "host/apps/recording/source_file.hpp"
#include "host/apps/recording/text_file.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNotesFile = ".octoskin-experiment";
constexpr const char* kRecording = "recording";
constexpr const char* kMetrics = "metrics.json";
constexpr const char* kReport = "report.html";

/// Of what an experiment left, by name: the CRC-32 of its bytes.
using Notes = std::map<std::string, std::string>;

Notes read_notes(const fs::path& folder) {
    std::ifstream in(folder / kNotesFile, std::ios::binary);
    Notes notes;
    std::string crc;
    std::string name;
    while (in >> crc >> name) notes[name] = crc;
    return notes;
}

/// Empty if it cannot be read, or is not what its name says.
std::string crc_of(const fs::path& folder, const std::string& name) {
    const auto crc =
        name == kRecording ? crc32_of_recording(RecordingPaths(folder / name)) : crc32_of(folder / name);
    return crc ? crc_text(*crc) : "";
}

bool is_there(const fs::path& path) {
    std::error_code error;
    return fs::exists(fs::symlink_status(path, error));
}

/// What octoskin itself hides in a folder does not count. In order of names.
std::set<std::string> names_in(const fs::path& folder) {
    std::set<std::string> names;
    std::error_code error;
    const fs::directory_iterator entries(folder, error);
    if (error) return names;
    for (const auto& entry : entries) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with(".octoskin-")) names.insert(name);
    }
    return names;
}

/// Experiments used to leave no notes; their figures say who made them.
bool is_of_one_without_notes(const fs::path& folder) {
    std::ifstream in(folder / kMetrics, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    return text.find("\"unknown_space\"") != std::string::npos &&
           text.find("\"program\": \"octoskin") != std::string::npos;
}

/// A map, or the file that speaks of maps, that was not left there by whoever wrote that file.
std::optional<std::string> foreign_map(const fs::path& folder) {
    const auto origin = read_map_origin(folder);
    const bool is_told = origin && *origin;
    for (const std::string& name : map_file_names()) {
        if (!is_there(folder / name)) continue;
        const bool is_ours =
            is_told && (*origin)->maps.contains(name) && !fault_of_map(folder / name, **origin);
        if (!is_ours) return name;
    }
    if (is_there(folder / kMapOriginFile) && !is_told) return kMapOriginFile;
    return std::nullopt;
}

/// The first thing that an experiment would replace and none has left there.
std::optional<std::string> foreign_result(const fs::path& folder, const Notes& notes) {
    for (const char* const name : {kRecording, kMetrics, kReport}) {
        if (!is_there(folder / name)) continue;
        // A recording that was never finished: nothing to lose.
        if (name == std::string(kRecording) && fs::is_directory(folder / name) &&
            names_in(folder / name).empty())
            continue;
        const auto note = notes.find(name);
        const bool is_ours = notes.empty() || (note != notes.end() && note->second == crc_of(folder, name));
        if (!is_ours) return name;
    }
    // Replacing a recording removes the maps that were made of it.
    if (auto map = foreign_map(folder / kRecording / "maps"))
        return std::string(kRecording) + "/maps/" + *map;
    return foreign_map(folder);
}

}  // namespace

Status<AppError> check_results_folder(const fs::path& folder) {
    const std::set<std::string> names = names_in(folder);
    if (names.empty()) return Done{};
    const Notes notes = read_notes(folder);
    const bool is_ours = !notes.empty() || is_of_one_without_notes(folder);
    const auto foreign = is_ours ? foreign_result(folder, notes) : *names.begin();
    if (!foreign) return Done{};
    return cannot_create(folder, fmt::format("has a {} that no experiment left there as it is: nothing is "
                                             "overwritten; move it away, or give another directory",
                                             *foreign));
}

Status<AppError> note_result(const fs::path& folder, const std::string& name) {
    Notes notes = read_notes(folder);
    if (notes.empty()) {  // what check_results_folder() let pass without notes
        for (const char* const result : {kRecording, kMetrics, kReport})
            if (is_there(folder / result)) notes[result] = crc_of(folder, result);
    }
    notes[name] = crc_of(folder, name);
    std::string text;
    for (const auto& [noted, crc] : notes) text += fmt::format("{} {}\n", crc, noted);
    return write_text(folder / kNotesFile, text);
}

}  // namespace octoskin
