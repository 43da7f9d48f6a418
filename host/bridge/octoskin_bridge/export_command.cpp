// octoskin export: a recording as an MCAP file.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/interruption.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/playback/playback_options.hpp"
#include "host/apps/version/version.hpp"
#include "host/bridge/mcap/mcap_topics.hpp"
#include "host/bridge/mcap/output_file.hpp"
#include "host/bridge/mcap/recording_export.hpp"
#include "host/bridge/mcap/topic_choice.hpp"
#include "host/bridge/octoskin_bridge/commands.hpp"
#include "hw/rigfile/joined.hpp"

namespace octoskin::bridge {
namespace {

using app::CommandFailure;
using app::value_or_fail;

struct ExportCommandOptions {
    app::PlaybackOptions playback;
    std::filesystem::path out;
    std::vector<std::string> topics;
    std::vector<std::string> also;
    double map_period_s = 0.5;
    bool may_replace = false;
};

TopicChoice choice_of(const ExportCommandOptions& options) {
    TopicChoice choice{
        .only = options.topics, .also = options.also, .left_out = optional_topics(MapTopics{})};
    choice.takes_all = std::ranges::find(choice.only, "all") != choice.only.end();
    return choice;
}

/// A misspelt topic would be missing from the file without a message.
void check_topics(const ExportCommandOptions& options, const McapTopics& topics) {
    std::vector<std::string> known;
    for (const auto& [topic, count] : topics.counts()) known.push_back(topic);
    for (const auto* names : {&options.topics, &options.also})
        for (const std::string& name : *names) {
            const auto is_of_it = [&name](const std::string& topic) { return is_within(topic, name); };
            if (name == "all" || std::ranges::any_of(known, is_of_it)) continue;
            throw CommandFailure(ExitCode::usage,
                                 {.code = ErrorCode::unknown_name,
                                  .what = "is no topic of this recording: " + rig::joined(known),
                                  .value = name,
                                  .key = names == &options.topics ? "--topics" : "--also"});
        }
}

ReplayReport report_seconds() {
    return [reported = std::int64_t{0}](const ReplayProgress& progress) mutable {
        constexpr std::int64_t kEvery_s = 10;
        if (!progress.begin || !progress.now) return;
        const std::int64_t second = (*progress.now - *progress.begin) / std::chrono::seconds(1);
        if (second < reported + kEvery_s) return;
        reported = second;
        spdlog::info("exporting: {} s of the recording", second);
    };
}

void print_topics(const McapTopics& topics) {
    for (const auto& [topic, count] : topics.counts())
        if (count.messages > 0) app::print("{:<40} {:>9} {}\n", topic, count.messages, count.type);
}

/// A part of a recording is no export of it.
void refuse_failed(const Playback& playback) {
    if (const auto& failed = playback.outcome.can_error) throw CommandFailure(ExitCode::bad_data, *failed);
    if (const auto& failed = playback.outcome.depth_errors; !failed.empty())
        throw CommandFailure(unread_depth(failed.front()));
}

void export_recording(const ExportCommandOptions& options) {
    const app::Interruption interruption;
    RecordedEvents recorded = value_or_fail(RecordedEvents::open(app::playback_request(options.playback)));
    if (!recorded.has_wall_time())
        spdlog::warn(
            "can.log has no SYNC with its FOLLOW_UP: times in the file count from the start of a clock");
    OutputFile file = value_or_fail(OutputFile::begin(options.out, options.may_replace));
    mcap::McapWriter writer([&file](std::string_view bytes) { return file.write(bytes); }, program_version());
    const TopicChoice choice = choice_of(options);
    McapTopics topics(writer, [&choice](const std::string& topic) { return choice.takes(topic); });
    const auto period = Nanoseconds{static_cast<std::int64_t>(options.map_period_s * 1e9)};
    const RecordingPaths paths(options.playback.recording);
    auto exported = RecordingExport::open(topics, recorded, paths, {.map_period = period});
    if (!exported) throw CommandFailure(ExitCode::bad_data, exported.error());
    check_topics(options, topics);
    const auto playback = recorded.play(**exported, exported->get(), report_seconds());
    if (!playback) throw CommandFailure(playback.error());
    refuse_failed(*playback);
    (*exported)->finish();
    (void)writer.finish();  // a failed write is reported by commit
    if (const auto committed = file.commit(); !committed) throw CommandFailure(committed.error());
    for (const std::string& warning : playback->warnings) spdlog::warn("{}", warning);
    print_topics(topics);
    app::print("{}: {:.1f} s, {} messages, {:.1f} MB\n", options.out.string(),
               std::chrono::duration<double>((*exported)->duration()).count(), writer.messages(),
               static_cast<double>(writer.bytes()) / 1e6);
}

}  // namespace

void add_export_command(CLI::App& app) {
    auto options = std::make_shared<ExportCommandOptions>();
    CLI::App* command = app.add_subcommand(
        "export",
        "Write a recording as an MCAP file for Foxglove, Lichtblick, PlotJuggler, Rerun and ros2 bag");
    command->add_option("recording", options->playback.recording, "Directory of the recording")
        ->required()
        ->check(app::existing_path());
    command->add_option("out", options->out, "New file, as out.mcap")->required();
    command
        ->add_option("--topics", options->topics,
                     "Only this topic and those below it, as /octoskin/range; all: every topic. May be given "
                     "several times")
        ->allow_extra_args(false);
    command
        ->add_option("--also", options->also,
                     "Also this topic, beside the default. May be given several times. Not in the default: " +
                         rig::joined(optional_topics(MapTopics{})))
        ->allow_extra_args(false);
    command
        ->add_option("--map-period", options->map_period_s,
                     "A map at most once in this time (seconds of the recording)")
        ->check(app::from_to(0.1, 3600.0))
        ->capture_default_str();
    command->add_flag("--force", options->may_replace, "Replace the file if it exists");
    app::add_recording_options(*command, options->playback);
    command->callback([options] { export_recording(*options); });
}

}  // namespace octoskin::bridge
