// octoskin replay: a recording through the host's pipeline, into maps.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <span>

#include "host/apps/octoskin/commands.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/mapping/mapping_file.hpp"

namespace octoskin::app {
namespace {

struct ReplayOptions {
    std::filesystem::path recording;
    std::filesystem::path rig;
    std::filesystem::path robot;
    std::filesystem::path out;
    std::string configuration = "robust";
    bool is_fused_only = false;
};

void report_progress(const ReplayProgress& progress, int& last_second) {
    if (!progress.begin || !progress.now) return;
    const auto second = static_cast<int>((*progress.now - *progress.begin).count() / 1'000'000'000);
    if (second < last_second + 2) return;
    last_second = second;
    spdlog::info("replaying: {} s, {} CAN frames, {} depth frames", second, progress.can_frames,
                 progress.depth_frames);
}

void save(const FusedMap& map, const std::filesystem::path& out, const std::string& name) {
    for (const char* extension : {".ot", ".bt", ".ply"}) {
        const auto file = out / (name + extension);
        if (const auto saved = save_map(map, file); !saved)
            throw CommandFailure({ExitCode::cannot_create, saved.error().message});
    }
    fmt::print("{}: {} known voxels\n", (out / (name + ".ot")).string(), map.known_voxels());
}

void replay_recording(const ReplayOptions& options) {
    const auto mapping = read_mapping(options.configuration);
    if (!mapping) throw CommandFailure({ExitCode::bad_config, mapping.error().message()});
    const bool wants_all = !options.is_fused_only;
    int last_second = 0;
    const auto playback =
        play_recording({.recording = RecordingPaths(options.recording),
                        .mapping = *mapping,
                        .maps = {.depth = wants_all, .proximity = wants_all, .fused = true},
                        .rig = options.rig,
                        .robot = options.robot},
                       [&](const ReplayProgress& progress) { report_progress(progress, last_second); });
    if (!playback) throw CommandFailure(playback.error());

    for (const AccountTable& table : playback->accounts) fmt::print("{}", to_text(table));
    fmt::print("{}", to_text(std::span<const NodeSummary>(playback->nodes)));
    for (const std::string& note : playback->notes) fmt::print("{}\n", note);
    for (const std::string& warning : playback->warnings) spdlog::warn("{}", warning);
    std::error_code error;
    std::filesystem::create_directories(options.out, error);
    if (error) throw CommandFailure({ExitCode::cannot_create, options.out.string() + ": " + error.message()});
    const MapSet& maps = playback->pipeline.maps();
    if (maps.depth() != nullptr) save(*maps.depth(), options.out, "depth");
    if (maps.proximity() != nullptr) save(*maps.proximity(), options.out, "proximity");
    save(*maps.fused(), options.out, "fused");

    if (const auto& failed = playback->outcome.can_error)
        throw CommandFailure({ExitCode::bad_data, failed->what});
    if (const auto& failed = playback->outcome.depth_error)
        throw CommandFailure({ExitCode::bad_data, failed->what});
    if (!playback->pipeline.is_balanced())
        throw CommandFailure({ExitCode::failed, "the account does not balance"});
    if (playback->is_map_incomplete) throw CommandFailure({ExitCode::failed, "the map is not complete"});
    if (maps.fused()->known_voxels() == 0) {
        throw CommandFailure({ExitCode::failed, "nothing came into the map; the account above says why"});
    }
}

}  // namespace

void add_replay_command(CLI::App& app) {
    auto options = std::make_shared<ReplayOptions>();
    CLI::App* command =
        app.add_subcommand("replay", "Play a recording through the pipeline; write maps and the account");
    command->add_option("recording", options->recording, "Directory of the recording")->required();
    command->add_option("--out", options->out, "Where the maps go (default: RECORDING/maps)");
    command
        ->add_option("--configuration", options->configuration,
                     "How measurements become voxels: paper, robust, or a YAML file")
        ->capture_default_str();
    command->add_option("--rig", options->rig, "Rig (YAML) in place of the recording's")
        ->check(CLI::ExistingFile);
    command->add_option("--robot", options->robot, "Robot (URDF) in place of the recording's")
        ->check(CLI::ExistingFile);
    command->add_flag("--fused-only", options->is_fused_only,
                      "Leave out the maps of the camera alone and the sensors alone");
    command->callback([options] {
        if (options->out.empty()) options->out = options->recording / "maps";
        replay_recording(*options);
    });
}

}  // namespace octoskin::app
