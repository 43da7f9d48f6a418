#include "host/apps/daemon/record_requests.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>

#include "host/apps/command_line/error_json.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/folder_lock.hpp"
#include "host/core/text/printable.hpp"

namespace octoskin {
namespace {

constexpr std::string_view kStart = "record start ";
constexpr std::string_view kStop = "record stop ";
constexpr double kSecondsMax = 1e6;
/// How long a reading may wait for the disk to accept or refuse a folder.
constexpr Nanoseconds kFolderPatience{100'000'000};

/// In its own folders the daemon, which makes recordings as its own user, creates files of these names.
bool is_daemons_own(const std::string& name) {
    constexpr std::array<std::string_view, 3> kNames{FolderLock::kFile, "control", "joints"};
    return name.starts_with('.') || name.starts_with("fused.") || name.ends_with(".lock") ||
           std::ranges::find(kNames, name) != kNames.end();
}

/// Why no other recording can start.
Error busy(const Recorder& recorder) {
    Error error{.code = ErrorCode::in_use, .file = recorder.folder()};
    error.what = recorder.is_stopped() ? "the end of this recording is still being written"
                                       : "a recording goes there already";
    error.remedy = recorder.is_stopped() ? "`octoskin status` shows when it has ended"
                                         : "`octoskin record --stop` ends that";
    return error;
}

Unexpected<AppError> no_recording() {
    return fail(ExitCode::unavailable, {ErrorCode::no_data, "nothing is being recorded"});
}

}  // namespace

std::optional<Error> fault_of_folder(const std::filesystem::path& folder) {
    const std::string name = folder.string();
    const std::string shown = printable(name);
    constexpr std::size_t kLongest = 4095;
    if (name.size() > kLongest)
        return Error{.code = ErrorCode::bad_name,
                     .what = fmt::format("a path has at most {} bytes", kLongest),
                     .value = fmt::format("{} bytes", name.size()),
                     .remedy = "give a shorter one"};
    const std::string quoted = "'" + shown + "'";
    if (!folder.is_absolute()) return Error{ErrorCode::bad_value, "expected an absolute path", quoted};
    if (is_daemons_own(plain(folder).filename().string()))
        return Error{ErrorCode::bad_name, "expected a name that octoskin does not use itself", quoted,
                     "give another one"};
    if (shown == name) return std::nullopt;
    // The name goes into logs, into the status, and to users who replay the recording.
    return Error{ErrorCode::bad_name, "expected a name in UTF-8 without control characters", quoted,
                 "give another one"};
}

std::filesystem::path plain(const std::filesystem::path& folder) {
    std::filesystem::path normal = folder.lexically_normal();
    return normal.has_filename() ? normal : normal.parent_path();
}

Result<RecordStart, AppError> read_record_start(std::string_view arguments) {
    double seconds = 0.0;
    const char* const last = arguments.data() + arguments.size();
    const auto [end, error] = std::from_chars(arguments.data(), last, seconds);
    const bool is_time = error == std::errc{} && seconds >= 0.0 && seconds <= kSecondsMax;
    if (!is_time || end == last || *end != ' ')
        return fail(ExitCode::usage, {ErrorCode::bad_argument, "expected: record start SECONDS FOLDER"});
    const std::filesystem::path named(end + 1, last);
    if (auto fault = fault_of_folder(named)) return fail(ExitCode::usage, std::move(*fault));
    const auto limit = seconds > 0.0 ? std::optional(Nanoseconds{std::llround(seconds * 1e9)}) : std::nullopt;
    return RecordStart{limit, plain(named)};
}

std::string RecordRequests::answer(const std::string& line, const RecordedSettings& settings,
                                   Pipeline& pipeline, HostTime now) {
    Status<AppError> outcome = Done{};
    if (line.starts_with(kStart)) {
        outcome = start(line.substr(kStart.size()), settings, pipeline, now);
    } else if (line == "record stop") {
        if (!recorder_) outcome = no_recording();
        stop(now);
    } else if (line.starts_with(kStop)) {
        outcome = stop(line.substr(kStop.size()), now);
    } else if (line != "record status") {
        outcome =
            fail(ExitCode::usage,
                 {.code = ErrorCode::bad_argument,
                  .what = "unknown request",
                  .remedy = "there are: record start SECONDS FOLDER, record stop [FOLDER], record status"});
    }
    nlohmann::ordered_json answer{{"ok", outcome.has_value()}};
    if (!outcome) {
        answer["exit"] = static_cast<int>(outcome.error().exit);
        answer["error"] = octoskin::to_json(outcome.error().error);
    }
    answer["recording"] = to_json(now);
    answer["before"] = before_;
    return answer.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

Status<AppError> RecordRequests::start(const std::string& arguments, const RecordedSettings& settings,
                                       Pipeline& pipeline, HostTime now) {
    const auto asked = read_record_start(arguments);
    if (!asked) return unexpected(asked.error());
    if (recorder_ && !recorder_->has_ended()) {
        return fail(ExitCode::cannot_create, busy(*recorder_));
    }
    if (recorder_) recorder_->stop(now);  // releases the pipeline first
    Error refused{ErrorCode::no_resources};
    try {
        return begin(
            std::make_unique<Recorder>(asked->folder, asked->limit, settings, pipeline, now, copier_), now);
    } catch (const std::bad_alloc&) {
        refused.what = fmt::format("no memory for a copy of the map ({} MiB), which a recording starts with",
                                   pipeline.map().memory_bytes() >> 20U);
    } catch (const std::system_error& error_thrown) {
        refused.what = fmt::format("no thread left for a recording ({})", error_thrown.code().message());
    }
    refusal_ = refused.message();
    return fail(ExitCode::unavailable, std::move(refused));
}

Status<AppError> RecordRequests::begin(std::unique_ptr<Recorder> recorder, HostTime now) {
    if (auto why = recorder->refusal(kFolderPatience)) {
        spdlog::warn("not recorded: {}", why->message());
        return fail(ExitCode::cannot_create, std::move(*why));
    }
    if (recorder_) before_ = to_json(now);
    recorder_ = std::move(recorder);
    ++begun_;
    refusal_.clear();
    spdlog::info("recording to {}", recorder_->folder().string());
    return Done{};
}

Status<AppError> RecordRequests::stop(const std::string& folder, HostTime now) {
    if (auto fault = fault_of_folder(folder)) return fail(ExitCode::usage, std::move(*fault));
    if (!recorder_) return no_recording();
    const std::filesystem::path named = plain(folder);
    if (recorder_->folder() != named) {
        return fail(ExitCode::unavailable,
                    {.code = ErrorCode::no_data,
                     .what = fmt::format("is not being recorded; the recording {} {}",
                                         recorder_->has_ended() ? "that ended last is" : "goes to",
                                         recorder_->folder().string()),
                     .file = named});
    }
    stop(now);
    return Done{};
}

nlohmann::ordered_json RecordRequests::to_json(HostTime now) const {
    if (!recorder_) return nullptr;
    nlohmann::ordered_json json = recorder_->to_json(now);
    json["number"] = begun_;
    return json;
}

void RecordRequests::finish(Nanoseconds patience) {
    if (!recorder_) return;
    if (!recorder_->wait(patience)) spdlog::error("the recording is incomplete: the disk took too long");
    recorder_->attend(monotonic_now());
}

}  // namespace octoskin
