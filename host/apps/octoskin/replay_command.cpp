// octoskin replay: plays a recording through the host's pipeline, into maps.
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <span>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/interruption.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/octoskin/imported_bag.hpp"
#include "host/apps/playback/film_playback.hpp"
#include "host/apps/playback/map_folder.hpp"
#include "host/apps/playback/onto_bus.hpp"
#include "host/apps/playback/ordered_playback.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/apps/playback/playback_options.hpp"
#include "host/apps/recording/given_bag.hpp"
#include "hw/rigfile/joined.hpp"

namespace octoskin::app {
namespace {

struct ReplayOptions {
    PlaybackOptions playback;
    BagOptions bag;
    std::filesystem::path out;
    std::optional<FilePlace> maps_of_bag = {};  ///< where they are without --out
    std::optional<std::string> speed;           ///< empty: max into maps, 1 onto a bus
    std::string onto;
    bool is_fused_only = false;
    bool is_stepped = false;
};

/// Shows the next input, and waits for the enter key. The end of standard input ends the replay.
void wait_for_enter(const std::string& what) {
    print_text(what);
    static_cast<void>(std::fflush(stdout));  // a failure is reported at the end
    std::string line;
    if (std::getline(std::cin, line)) {
        if (::isatty(STDIN_FILENO) == 0) print("\n");  // no key has ended the line
        return;
    }
    print("\n");
    throw CommandFailure(ExitCode::io_failed,
                         {.code = ErrorCode::no_data,
                          .what = "ended, and with it the replay, before the end of the recording",
                          .remedy = "--step reads a line for each step",
                          .file = "standard input"});
}

Pace pace_of(const ReplayOptions& options) {
    if (options.is_stepped) return Pace::by_step(wait_for_enter);
    if (!options.speed) return options.onto.empty() ? Pace{} : Pace::times(1.0);
    const std::string& text = *options.speed;
    if (text == "max") return {};
    double speed = 0.0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, speed);
    const bool is_speed = error == std::errc{} && end == last && speed >= 1e-3 && speed <= 1e6;
    if (!is_speed)
        throw CommandFailure(ExitCode::usage, {.code = ErrorCode::bad_argument,
                                               .what = "expected 'max', or a number from 0.001 to 1000000",
                                               .value = "'" + text + "'",
                                               .key = "--speed"});
    return Pace::times(speed);
}

/// When to log progress: every two seconds of the recording.
class ProgressSeconds {
  public:
    /// The second to log; empty: the last one was logged a moment ago.
    [[nodiscard]] std::optional<int> due(Nanoseconds into_recording) {
        const auto second = static_cast<int>(into_recording / std::chrono::seconds(1));
        if (second < reported_ + 2) return std::nullopt;
        reported_ = second;
        return second;
    }

  private:
    int reported_ = 0;
};

/// `unit`: name of the inputs that the replay counts.
void report_progress(const ReplayProgress& progress, const char* unit, ProgressSeconds& seconds) {
    if (!progress.begin || !progress.now) return;
    if (const auto second = seconds.due(*progress.now - *progress.begin)) {
        spdlog::info("replaying: {} s, {} {}, {} depth frames", *second, progress.can_frames, unit,
                     progress.depth_frames);
    }
}

/// Logs a line for each five seconds that it takes.
BytesReport checksum_report() {
    static constexpr auto kQuiet = std::chrono::seconds(5);
    return [last = std::chrono::steady_clock::now()](std::uint64_t bytes) mutable {
        const auto now = std::chrono::steady_clock::now();
        if (now - last < kQuiet) return;
        last = now;
        spdlog::info("checksum of the recording: {} MB so far", bytes / 1'000'000);
    };
}

/// The maps of an earlier replay stay unchanged if this one failed.
void refuse_failed(const Playback& playback) {
    if (auto failure = failure_of(playback, "the counters above show why")) {
        std::string& others = failure->error.others;
        others += (others.empty() ? "" : ". ") + std::string("No map is written");
        throw CommandFailure(std::move(*failure));
    }
}

/// `maps` in a recording; for a film named itself, a folder of its name beside it.
FilePlace maps_place(const ReplayOptions& options, const RecordingPaths& recording) {
    if (!options.out.empty()) return FilePlace(options.out);
    if (options.maps_of_bag) return *options.maps_of_bag;
    const std::filesystem::path& named = options.playback.recording;
    if (lone_film(recording) && !std::filesystem::is_directory(named))
        return FilePlace(std::filesystem::path(named).replace_extension(".maps"));
    return recording.file(kMapsOfRecording);
}

void save(const Playback& playback, MapFolder& folder, const std::filesystem::path& out) {
    const auto maps = named_maps(playback);
    const auto saved = folder.save(maps, playback.origin);
    if (!saved) throw CommandFailure(saved.error());
    for (const auto& [name, map] : maps) {
        print("{}: {} known voxels\n", (out / (name + ".ot")).string(), map->known_voxels());
    }
    if (!saved->removed.empty())
        print("removed from {}, of the replay before: {}\n", out.string(), rig::joined(saved->removed));
    if (!saved->foreign.empty()) {
        spdlog::warn("{}: {} are there too, and are not of this replay", out.string(),
                     rig::joined(saved->foreign));
    }
}

void replay_onto_bus(const ReplayOptions& options) {
    socketcan::CanSocket socket = open_can(options.onto);
    ProgressSeconds seconds;
    const auto report = [&](const OntoBus& so_far, Nanoseconds into_log) {
        if (const auto second = seconds.due(into_log))
            spdlog::info("sending: {} s, {} frames", *second, so_far.sent);
    };
    const auto played =
        play_onto(RecordingPaths(options.playback.recording).can_log(), socket, pace_of(options), report);
    if (!played) throw CommandFailure(played.error());
    print("{}: {} frames of '{}' sent, {} of them had to wait for room\n", options.onto, played->sent,
          played->interface, played->waited);
    const auto left_out = played->other_interface + played->error_frames + played->lines_refused;
    if (left_out > 0) {
        spdlog::warn("not sent: {} frames of other interfaces, {} error frames, {} lines that are no frames",
                     played->other_interface, played->error_frames, played->lines_refused);
    }
}

/// For queries of the map: unknown space surrounds the arm's last posture.
void report_last_posture(const Playback& playback) {
    const auto newest = playback.pipeline.builder().robot().newest();
    if (!newest) return;
    std::string joints;
    for (const double position : newest->position)
        joints += fmt::format("{}{:.6f}", joints.empty() ? "" : ",", position);
    print("the arm's last known posture, for `octoskin query`: --stands={}\n", joints);
}

/// `made_of`: the file from which a temporary recording was made; empty: the recording is the user's own.
void replay_recording(const ReplayOptions& options, const std::filesystem::path& made_of = {}) {
    const bool wants_all = !options.is_fused_only;
    PlaybackRequest request = playback_request(options.playback);
    request.maps = wants_all ? every_feed() : std::vector{MapFeed::both};
    request.pace = pace_of(options);
    request.on_checksum = checksum_report();
    if (const auto checked = check_playable(request); !checked) throw CommandFailure(checked.error());
    // Before the work: the second of two writers would otherwise fail only at the end.
    const FilePlace maps = maps_place(options, request.recording);
    auto folder = MapFolder::open(maps);
    if (!folder) throw CommandFailure(folder.error());
    ProgressSeconds seconds;
    const char* const unit = is_played_in_order(request) ? "commits" : "CAN frames";
    auto playback = play_recording(
        request, [&](const ReplayProgress& progress) { report_progress(progress, unit, seconds); });
    if (!playback) throw CommandFailure(playback.error());
    if (!made_of.empty()) playback->origin.recording = std::filesystem::absolute(made_of).lexically_normal();

    for (const CounterTable& table : playback->inputs) print_text(to_text(table));
    if (!playback->nodes.empty()) print_text(to_text(std::span<const NodeSummary>(playback->nodes)));
    for (const std::string& note : playback->notes) print("{}\n", note);
    static_cast<void>(flush_standard_output());  // a failure is reported at the end
    for (const std::string& warning : playback->warnings) spdlog::warn("{}", warning);
    refuse_failed(*playback);
    save(*playback, *folder, maps.shown());
    report_last_posture(*playback);
    if (auto lost = loss_of(*playback)) throw CommandFailure(std::move(*lost));
    if (playback->is_unlike_daemons) {
        throw CommandFailure(ExitCode::failed,
                             in_file({ErrorCode::mismatch,
                                      "replayed, but not into the daemon's own map; see the warning above"},
                                     options.playback.recording));
    }
}

/// An MCAP file has neither rig nor robot.
void check_bag_options(const ReplayOptions& options, const FilePlace& bag) {
    const bool has_rig = !options.playback.rig.empty();
    if (has_rig && options.onto.empty()) return;
    throw CommandFailure(
        ExitCode::usage,
        {.code = ErrorCode::bad_argument,
         .what = has_rig ? "cannot be sent onto a bus" : "needs the rig of its robot",
         .remedy =
             has_rig ? "make a recording of it with `octoskin bridge import`, and replay that" : "give --rig",
         .file = bag.shown(),
         .key = has_rig ? "--onto" : "--rig"});
}

/// Through a temporary recording; the maps are beside the file.
void replay_bag(const FilePlace& bag, ReplayOptions options, const CLI::App& command) {
    check_bag_options(options, bag);
    options.maps_of_bag = maps_beside(bag);
    const ImportedBag imported(command, options.playback.recording, options.playback.rig,
                               options.playback.robot, options.bag);
    options.playback.recording = imported.recording();
    replay_recording(options, bag.shown());
}

void replay_any(const ReplayOptions& options, const CLI::App& command) {
    if (const auto bag = value_or_fail(find_bag(options.playback.recording)))
        return replay_bag(*bag, options, command);
    if (options.bag.is_any_given())
        throw CommandFailure(ExitCode::usage,
                             {.code = ErrorCode::conflict,
                              .what = "--joint-states, --can and --log-time are for an MCAP file",
                              .remedy = "leave them out",
                              .file = options.playback.recording});
    options.onto.empty() ? replay_recording(options) : replay_onto_bus(options);
}

}  // namespace

void add_replay_command(CLI::App& app) {
    auto options = std::make_shared<ReplayOptions>();
    CLI::App* command = app.add_subcommand(
        "replay", "Play a recording through the pipeline; write maps and the input counters");
    command
        ->add_option(
            "recording", options->playback.recording,
            "Directory of the recording or data set; or an .oni file; or with --rig an MCAP file of ROS 2 "
            "(package octoskin-bridge)")
        ->required();
    auto* const out = command->add_option(
        "--out", options->out, "Folder for the maps (default: RECORDING/maps; of X.oni and X.mcap, X.maps)");
    add_playback_options(*command, options->playback);
    add_bag_options(*command, options->bag);
    auto* const fused_only =
        command->add_flag("--fused-only", options->is_fused_only,
                          "Leave out the maps of the camera alone and of the sensors alone");
    auto* const speed =
        command->add_option("--speed", options->speed,
                            "max; or how many times real time: 1, 10, 0.5 (default: max, with --onto 1)");
    command
        ->add_option("--onto", options->onto,
                     "Send the frames of can.log onto this CAN interface (fd:N: an open socket) instead of "
                     "making maps")
        ->excludes(command->get_option("--camera"))
        ->excludes(command->get_option("--pose"))
        ->excludes(out)
        ->excludes(fused_only);
    command
        ->add_flag("--step", options->is_stepped,
                   "Show each frame of the log (of a recording in the daemon's order, each reading and depth "
                   "frame; of a data set, each image) and wait for the enter key")
        ->excludes(speed);
    command->callback([options, command] {
        const Interruption interruption;
        replay_any(*options, *command);
    });
}

}  // namespace octoskin::app
