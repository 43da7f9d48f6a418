// What clients ask of the recorder, and the recorder that is at work, if one is.
//
//     record start SECONDS FOLDER     0: until `record stop`; FOLDER: an absolute path
//     record stop
//     record status
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "common/time.hpp"
#include "host/apps/daemon/recorder.hpp"
#include "host/core/pipeline/pipeline.hpp"

namespace octoskin {

class RecordRequests {
  public:
    explicit RecordRequests(Recorder::Copier copier = &FusedMap::copy) : copier_(std::move(copier)) {}

    [[nodiscard]] static bool is_one(const std::string& line) { return line.starts_with("record "); }
    /// A line of JSON: "ok", and "recording" or "error".
    [[nodiscard]] std::string answer(const std::string& line, const RecordedSettings& settings,
                                     Pipeline& pipeline, HostTime now);

    void on_can(const wire::CanFrame& frame, WallTime stamp) {
        if (recorder_) recorder_->on_can(frame, stamp);
    }
    void attend(HostTime now) {
        if (recorder_) recorder_->attend(now);
    }
    /// To be called before the pipeline is replaced, and at the end.
    void stop(HostTime now) {
        if (recorder_) recorder_->stop(now);
    }
    /// Until a recording that was stopped is whole; says in the log what came of it.
    void finish(Nanoseconds patience);
    /// The one at work or, until there is another, the last; null if there was none.
    [[nodiscard]] const Recorder* recorder() const noexcept { return recorder_.get(); }

    /// Why the newest recording could not begin for want of memory or of a thread; empty: it could.
    [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }

  private:
    /// What speaks against it; empty: nothing.
    [[nodiscard]] std::string start(const std::string& arguments, const RecordedSettings& settings,
                                    Pipeline& pipeline, HostTime now);
    Recorder::Copier copier_;
    std::unique_ptr<Recorder> recorder_;
    std::string refusal_;
};

}  // namespace octoskin
