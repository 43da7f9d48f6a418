// octoskin record: the daemon records its inputs and the updates of its map.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/end_signals.hpp"
#include "host/apps/command_line/error_json.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/daemon/record_requests.hpp"
#include "host/apps/octoskin/bridge_program.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/query/query_answer.hpp"
#include "host/apps/recording/recording.hpp"

namespace octoskin::app {
namespace {

using Json = nlohmann::ordered_json;

struct RecordOptions {
    std::filesystem::path out;
    std::filesystem::path socket = default_control_socket();
    double seconds = 0.0;
    bool stops = false;
    bool makes_mcap = false;
};

/// The "recording" in a daemon's answer; a refusal is a CommandFailure.
Json recording_of(const RecordOptions& options, const std::string& answer) {
    const Json json = Json::parse(answer, nullptr, false);
    if (!json.is_object() || !json.contains("ok")) throw CommandFailure(foreign_answer(options.socket));
    if (const auto refused = refusal_of(json)) throw CommandFailure(*refused);
    if (!json.at("ok").get<bool>()) throw CommandFailure(foreign_answer(options.socket));
    const Json recording = json.value("recording", Json());
    if (recording.is_object()) return recording;
    throw CommandFailure(ExitCode::unavailable, in_file({ErrorCode::no_data,
                                                         "the daemon knows of no recording: it was restarted "
                                                         "meanwhile, or never started one"},
                                                        options.socket));
}

Json ask(const RecordOptions& options, const std::string& line) {
    const auto answer = ask_daemon(options.socket, line);
    if (!answer) throw CommandFailure(answer.error());
    return recording_of(options, *answer);
}

bool is_going_on(const Json& recording) {
    return recording.at("state") == "recording" || recording.at("state") == "finishing";
}

/// Waits up to the 5 s in which a daemon ends.
bool comes(const FilePlace& file) {
    constexpr int kTries = 50;
    for (int i = 0; i < kTries && !file.is_file(); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return file.is_file();
}

/// Reports where the recording of an ended daemon is, and whether it is complete. meta.yaml is written last.
[[noreturn]] void report_left(const std::filesystem::path& folder) {
    if (!comes(RecordingPaths(folder).meta())) {
        throw CommandFailure(ExitCode::unavailable, in_file({ErrorCode::no_answer,
                                                             "the daemon ended, and did not complete the "
                                                             "recording, which is there without meta.yaml"},
                                                            folder));
    }
    throw CommandFailure(ExitCode::failed, in_file({ErrorCode::no_answer,
                                                    "complete, but the daemon ended, and with it the "
                                                    "recording, before its time"},
                                                   folder));
}

bool is_same(const Json& recording, const Json& other) {
    return recording.is_object() && recording.value("number", 0U) == other.value("number", 0U) &&
           recording.value("folder", "") == other.value("folder", "");
}

/// The state of the followed recording: another one may have started since it ended.
Json own_of(const RecordOptions& options, const std::string& answer, const Json& followed) {
    const Json all = Json::parse(answer, nullptr, false);
    const Json before = all.is_object() ? all.value("before", Json()) : Json();
    if (is_same(before, followed)) return before;
    Json now = recording_of(options, answer);
    if (is_same(now, followed)) return now;
    const auto folder = followed.at("folder").get<std::string>();
    throw CommandFailure(ExitCode::unavailable,
                         {.code = ErrorCode::no_data,
                          .what = "the daemon was restarted or asked for other recordings, and no longer "
                                  "knows this one",
                          .file = folder,
                          .others = "It is complete if it has a meta.yaml"});
}

/// The answer; empty if the daemon ended. A daemon that exists and does not answer is a CommandFailure.
std::optional<std::string> ask_patiently(const RecordOptions& options, const Json& followed) {
    constexpr int kTries = 4;
    constexpr std::chrono::milliseconds kPatience{2'500};
    AppError error;
    for (int i = 0; i < kTries; ++i) {
        auto answer = ask_daemon(options.socket, "record status", kPatience);
        const auto refused =  // too many clients at the moment
            answer ? refusal_of(Json::parse(*answer, nullptr, false)) : std::optional<AppError>();
        if (answer && !refused) return std::move(answer).value();
        error = refused ? *refused : answer.error();
        if (!refused && error.exit == ExitCode::unavailable) return std::nullopt;
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
    const auto folder = followed.at("folder").get<std::string>();
    throw CommandFailure(
        error.exit,
        {.code = error.error.code,
         .what = "the daemon no longer answers, and may continue to record here (" + error.message() + ")",
         .remedy = "`octoskin record --stop " + folder + "` ends the recording once the daemon answers",
         .file = folder});
}

std::filesystem::path folder_of(const RecordOptions& options) {
    const auto folder = plain(std::filesystem::absolute(options.out));
    if (auto fault = fault_of_folder(folder)) throw CommandFailure(ExitCode::usage, std::move(*fault));
    return folder;
}

/// Ends the recording in the named folder, and no other.
std::string stop_line(const RecordOptions& options) {
    return options.out.empty() ? "record stop" : "record stop " + folder_of(options).string();
}

/// Waits until the files are complete; empty if the daemon ended before it reported that.
std::optional<Json> follow(const RecordOptions& options, Json recording) {
    const EndSignals signals;
    while (is_going_on(recording)) {
        if (signals.came(std::chrono::milliseconds(200)))
            (void)ask_daemon(options.socket, stop_line(options));  // its result is requested below
        const auto answer = ask_patiently(options, recording);
        if (!answer) return std::nullopt;
        recording = own_of(options, *answer, recording);
    }
    return recording;
}

void tell(const Json& recording) {
    const auto folder = recording.at("folder").get<std::string>();
    if (recording.at("state") == "failed")
        throw CommandFailure(ExitCode::cannot_create, error_of(recording.at("error")));
    print("{}: {:.1f} s, {} CAN frames, {} depth frames, {} commits\n", folder,
          recording.at("seconds").get<double>(), recording.at("can_frames").get<std::uint64_t>(),
          recording.at("depth_frames").get<std::uint64_t>(), recording.at("commits").get<std::uint64_t>());
    if (const auto lost = recording.at("lost_can").get<std::uint64_t>(); lost > 0)
        spdlog::warn("{} CAN frames are not in can.log: the disk was too slow", lost);
    if (!recording.at("is_complete").get<bool>())
        throw CommandFailure(ExitCode::failed,
                             {.code = ErrorCode::no_resources,
                              .what = "the disk was too slow, or the memory too little, for " +
                                      recording.at("lost_depth").dump() + " depth frames and " +
                                      recording.at("lost_commits").dump() + " commits",
                              .file = folder,
                              .others = "A replay does not give the daemon's map"});
    if (const auto early = recording.at("ended_early").get<std::string>(); !early.empty())
        throw CommandFailure(
            ExitCode::failed,
            in_file({ErrorCode::cancelled, "complete, but it ended before its time: " + early}, folder));
}

Json stop(const RecordOptions& options) {
    const Json before = ask(options, "record status");
    if (is_going_on(before)) return ask(options, stop_line(options));
    throw CommandFailure(ExitCode::unavailable, in_file({ErrorCode::no_data,
                                                         "nothing is being recorded: this last recording has "
                                                         "ended"},
                                                        before.at("folder").get<std::string>()));
}

Json start(const RecordOptions& options) {
    const std::string folder = folder_of(options).string();
    const auto answer =
        ask_daemon(options.socket, fmt::format("record start {} {}", options.seconds, folder));
    if (answer) return recording_of(options, *answer);
    AppError error = answer.error();
    if (error.exit == ExitCode::io_failed) {  // it may have accepted the request without answering
        error.error.others = "Whether the daemon records to " + folder +
                             " is not known: `octoskin record --stop " + folder + "` ends that recording";
    }
    throw CommandFailure(error);
}

/// "FOLDER.mcap".
std::filesystem::path mcap_of(const std::filesystem::path& folder) {
    std::filesystem::path file = folder;
    return file += ".mcap";
}

/// Before the recording, which cannot be repeated.
void check_mcap(const RecordOptions& options) {
    check_bridge();
    const std::filesystem::path file = options.out.empty() ? options.out : mcap_of(folder_of(options));
    std::error_code error;
    if (file.empty() || !std::filesystem::exists(std::filesystem::symlink_status(file, error))) return;
    throw CommandFailure(ExitCode::cannot_create, {.code = ErrorCode::already_exists,
                                                   .what = "exists already",
                                                   .remedy = "move it away, or record to another directory",
                                                   .file = file});
}

/// Of a complete recording. The program prints its own error.
void make_mcap(const std::filesystem::path& folder, const CLI::App& command) {
    (void)flush_standard_output();
    const int code =
        run_bridge(with_form_of_errors(command, {"export", "--", folder.string(), mcap_of(folder).string()}));
    if (code != 0) throw CLI::RuntimeError(code);
}

void record(const RecordOptions& options, const CLI::App& command) {
    if (options.makes_mcap) check_mcap(options);
    try {
        const Json begun = options.stops ? stop(options) : start(options);
        const auto ended = follow(options, begun);
        if (!ended) report_left(begun.at("folder").get<std::string>());
        tell(*ended);
        if (options.makes_mcap) make_mcap(ended->at("folder").get<std::string>(), command);
    } catch (const Json::exception&) {
        throw CommandFailure(foreign_answer(options.socket));
    }
}

}  // namespace

void add_record_command(CLI::App& app) {
    auto options = std::make_shared<RecordOptions>();
    CLI::App* command =
        app.add_subcommand("record", "Have the running daemon record, until --seconds are over or Ctrl-C");
    command->add_option("out", options->out,
                        "Directory, new or empty, and writable for the daemon's user. With "
                        "--stop: end only the recording there");
    command->add_option("--seconds", options->seconds, "Duration; 0: until Ctrl-C or --stop")
        ->check(from_to(0.0, 1e6))
        ->capture_default_str();
    command->add_flag("--stop", options->stops, "End the running recording");
    command->add_flag(
        "--mcap", options->makes_mcap,
        "Then export it to DIRECTORY.mcap, as `octoskin export` does (package octoskin-bridge)");
    command->add_option("--socket", options->socket, "Control socket of the daemon")->capture_default_str();
    command->footer(
        "Exit codes: 0 the recording is complete; 1 it is incomplete, or the daemon ended it early; 64 "
        "command line;\n65 the answer is not of a daemon of this version; 69 no daemon, or nothing is being "
        "recorded; 73 the\ndirectory cannot be recorded to, or another recording is running; 74 the daemon "
        "does not answer.");
    command->callback([options, command] {
        if (options->out.empty() && !options->stops)
            throw CommandFailure(
                ExitCode::usage,
                {ErrorCode::bad_argument, "record needs a directory", {}, "give a directory, or --stop"});
        record(*options, *command);
    });
}

}  // namespace octoskin::app
