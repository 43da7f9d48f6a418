// Facts about a log that are needed before its replay: the interface of the rig, the resolution of its time
// stamps, and whether the map begins at a START.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "host/core/pipeline/mark_window.hpp"
#include "host/core/pipeline/start_scan.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/core/time/stamp_grain.hpp"
#include "host/io/candump/log_reader.hpp"

namespace octoskin {

class LogSurvey {
  public:
    /// `intake`: how frames will be decoded, as far as it is known.
    explicit LogSurvey(const HostRig& rig, const IntakeConfig& intake = {})
        : rig_(rig), intake_(intake), all_(rig, intake) {}

    /// Must be called in the order of the log.
    void take(const candump::LogEntry& entry);
    /// True if no further entry can change the results.
    [[nodiscard]] bool is_complete() const {
        return interface_ && chosen().scan.has_start() && chosen().stamps.has_enough();
    }

    /// The interface of the rig: the first one with a heartbeat of one of its nodes. A log may contain
    /// several interfaces, and the same bus twice. Empty if there is none: then every frame is examined and
    /// counted.
    [[nodiscard]] std::string interface() const { return interface_.value_or(""); }
    [[nodiscard]] MapBegin begin() const {
        return chosen().scan.has_start() ? MapBegin::start_mark : MapBegin::first_usable;
    }
    /// The resolution of the time stamps of that interface.
    [[nodiscard]] Nanoseconds stamp_grain() const { return chosen().stamps.grain(); }
    /// The intake for these time stamps: the present time may be wrong by their resolution.
    [[nodiscard]] IntakeConfig intake_for_stamps() const;
    /// Text for people, if the log has a START that the map will not use.
    [[nodiscard]] std::optional<std::string> warning() const;

  private:
    /// A damaged log may contain any number of interface names. Interfaces beyond this number are followed
    /// from their first heartbeat.
    static constexpr std::size_t kInterfacesMax = 16;

    struct Followed {
        Followed(const HostRig& rig, const IntakeConfig& intake) : scan(rig, intake) {}
        void on_frame(const wire::CanFrame& frame, WallTime stamp) {
            scan.on_frame(frame, stamp);
            if (!stamps.has_enough()) stamps.take(stamp);
        }
        StartScan scan;
        StampGrain stamps;
    };
    [[nodiscard]] bool is_heartbeat_of_rig(const wire::CanFrame& frame) const;
    [[nodiscard]] const Followed& chosen() const { return interface_ ? followed_.at(*interface_) : all_; }

    const HostRig& rig_;
    IntakeConfig intake_;
    Followed all_;  ///< all interfaces together, until one is chosen
    std::map<std::string, Followed> followed_;
    std::optional<std::string> interface_;
};

}  // namespace octoskin
