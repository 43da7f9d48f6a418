// What clients ask of the recorder, and the recorder that is at work, if one is.
//
//     record start SECONDS FOLDER     0: until `record stop`; FOLDER: an absolute path
//     record stop [FOLDER]            with FOLDER: only if that is where it is recorded to
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

/// Why nothing is recorded to a folder of this name; empty if it may be. One with control characters would
/// end a request, or a line of a log, in its midst; one called as a file of the daemon would take its place.
[[nodiscard]] std::string fault_of_folder(const std::filesystem::path& folder);
/// As it is named in requests and answers: without "." or "..", and without a slash at its end.
[[nodiscard]] std::filesystem::path plain(const std::filesystem::path& folder);

/// What `record start` asks for.
struct RecordStart {
    std::optional<Nanoseconds> limit;  ///< empty: until it is ended
    std::filesystem::path folder;      ///< absolute, as `plain` has it
};
/// Reads "SECONDS FOLDER". Errors: `usage`.
[[nodiscard]] Result<RecordStart, AppError> read_record_start(std::string_view arguments);

class RecordRequests {
  public:
    explicit RecordRequests(Recorder::Copier copier = &FusedMap::copy) : copier_(std::move(copier)) {}

    [[nodiscard]] static bool is_one(const std::string& line) { return line.starts_with("record "); }
    /// A line of JSON: "ok"; "error" and "code", the exit code for it, if it is not; "recording", the one at
    /// work or the last, with its "number" since this daemon began; and "before", the one before that.
    [[nodiscard]] std::string answer(const std::string& line, const RecordedSettings& settings,
                                     Pipeline& pipeline, HostTime now);

    void on_can(const wire::CanFrame& frame, WallTime stamp) {
        if (recorder_) recorder_->on_can(frame, stamp);
    }
    void attend(HostTime now) {
        if (recorder_) recorder_->attend(now);
    }
    /// To be called before the pipeline is replaced, and at the end. `early`: why, where nobody asked for it.
    void stop(HostTime now, std::string early = {}) {
        if (recorder_) recorder_->stop(now, std::move(early));
    }
    /// The same with a `last_map` of before something changed the map.
    void stop(HostTime now, std::string early, std::optional<FusedMap> last_map) {
        if (recorder_) recorder_->stop(now, std::move(early), std::move(last_map));
    }
    /// Recorder::last_map; empty, too, where nothing is recorded.
    [[nodiscard]] std::optional<FusedMap> last_map() const {
        return recorder_ ? recorder_->last_map() : std::nullopt;
    }
    /// Until a recording that was stopped is whole; says in the log what came of it.
    void finish(Nanoseconds patience);
    /// The one at work or, until there is another, the last; null if there was none.
    [[nodiscard]] const Recorder* recorder() const noexcept { return recorder_.get(); }

    /// Why the newest recording could not begin for want of memory or of a thread; empty: it could.
    [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }

  private:
    [[nodiscard]] Status<AppError> start(const std::string& arguments, const RecordedSettings& settings,
                                         Pipeline& pipeline, HostTime now);
    /// Unless its folder is refused: then nothing has changed.
    [[nodiscard]] Status<AppError> begin(std::unique_ptr<Recorder> recorder, HostTime now);
    /// Nobody ends a recording but where it is said to be.
    [[nodiscard]] Status<AppError> stop(const std::string& folder, HostTime now);
    [[nodiscard]] nlohmann::ordered_json to_json(HostTime now) const;

    Recorder::Copier copier_;
    std::uint64_t begun_ = 0;  ///< recordings
    nlohmann::ordered_json before_;
    std::unique_ptr<Recorder> recorder_;
    std::string refusal_;
};

}  // namespace octoskin
