// Requests of clients to the recorder, and the running recorder, if there is one.
//
//     record start SECONDS FOLDER     SECONDS 0: until `record stop`; FOLDER: an absolute path
//     record stop [FOLDER]            with FOLDER: only if the recording goes to it
//     record status
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/apps/daemon/recorder.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/pipeline/pipeline.hpp"

namespace octoskin {

/// Why nothing is recorded to a folder of this name; empty if it is allowed. Control characters would end a
/// request, or a line of a log, in the middle; the name of a daemon's file would take its place.
[[nodiscard]] std::optional<Error> fault_of_folder(const std::filesystem::path& folder);
/// The form in requests and answers: without "." or "..", and without a slash at the end.
[[nodiscard]] std::filesystem::path plain(const std::filesystem::path& folder);

/// The arguments of `record start`.
struct RecordStart {
    std::optional<Nanoseconds> limit;  ///< empty: until it is ended
    std::filesystem::path folder;      ///< absolute, in the form of `plain`
};
/// Reads "SECONDS FOLDER". Errors: `usage`.
[[nodiscard]] Result<RecordStart, AppError> read_record_start(std::string_view arguments);

class RecordRequests {
  public:
    explicit RecordRequests(Recorder::Copier copier = &FusedMap::copy) : copier_(std::move(copier)) {}

    [[nodiscard]] static bool is_one(const std::string& line) { return line.starts_with("record "); }
    /// A line of JSON: "ok"; if false, "exit", the exit code, and "error" (error_json.hpp); "recording", the
    /// running or the last one, with its "number" since the daemon started; and "before", the one before
    /// that.
    [[nodiscard]] std::string answer(const std::string& line, const RecordedSettings& settings,
                                     Pipeline& pipeline, HostTime now);

    void on_can(const wire::CanFrame& frame, WallTime stamp) {
        if (recorder_) recorder_->on_can(frame, stamp);
    }
    void attend(HostTime now) {
        if (recorder_) recorder_->attend(now);
    }
    /// Call this before the pipeline is replaced, and at the end. `early`: the reason, if no one requested
    /// the end.
    void stop(HostTime now, std::string early = {}) {
        if (recorder_) recorder_->stop(now, std::move(early));
    }
    /// The same with a `last_map` from before a change of the map.
    void stop(HostTime now, std::string early, std::optional<FusedMap> last_map) {
        if (recorder_) recorder_->stop(now, std::move(early), std::move(last_map));
    }
    /// Recorder::last_map; also empty without a recording.
    [[nodiscard]] std::optional<FusedMap> last_map() const {
        return recorder_ ? recorder_->last_map() : std::nullopt;
    }
    /// Waits until a stopped recording is complete, and logs the result.
    void finish(Nanoseconds patience);
    /// The running one or, until there is another, the last one; null if there was none.
    [[nodiscard]] const Recorder* recorder() const noexcept { return recorder_.get(); }

    /// Why the newest recording could not start for lack of memory or of a thread; empty: it could.
    [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }

  private:
    [[nodiscard]] Status<AppError> start(const std::string& arguments, const RecordedSettings& settings,
                                         Pipeline& pipeline, HostTime now);
    /// Changes nothing if its folder is refused.
    [[nodiscard]] Status<AppError> begin(std::unique_ptr<Recorder> recorder, HostTime now);
    /// A recording is ended only by the folder that it goes to.
    [[nodiscard]] Status<AppError> stop(const std::string& folder, HostTime now);
    [[nodiscard]] nlohmann::ordered_json to_json(HostTime now) const;

    Recorder::Copier copier_;
    std::uint64_t begun_ = 0;  ///< recordings
    nlohmann::ordered_json before_;
    std::unique_ptr<Recorder> recorder_;
    std::string refusal_;
};

}  // namespace octoskin
