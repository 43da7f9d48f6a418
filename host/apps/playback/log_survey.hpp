// What has to be known of a log before it is replayed: the interface that the rig is on, how coarse its
// stamps are, and whether the map begins at a START.
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
    /// `intake`: how a frame will be taken in, as far as it is known.
    explicit LogSurvey(const HostRig& rig, const IntakeConfig& intake = {})
        : rig_(rig), intake_(intake), all_(rig, intake) {}

    /// Entries in the order of the log.
    void take(const candump::LogEntry& entry);
    /// Nothing that may follow would change the answers.
    [[nodiscard]] bool is_complete() const {
        return interface_ && chosen().scan.has_start() && chosen().stamps.has_enough();
    }

    /// The interface that the rig is on: the first that carries a heartbeat of one of its nodes. A log may
    /// hold several, and the same bus twice. Empty if none does: then every frame is looked at, and counted
    /// for what it is.
    [[nodiscard]] std::string interface() const { return interface_.value_or(""); }
    [[nodiscard]] MapBegin begin() const {
        return chosen().scan.has_start() ? MapBegin::start_mark : MapBegin::first_usable;
    }
    /// Of that interface.
    [[nodiscard]] Nanoseconds stamp_grain() const { return chosen().stamps.grain(); }
    /// How frames with such stamps are taken in: "now" may be off by their grain, as far as that can be.
    [[nodiscard]] IntakeConfig intake_for_stamps() const;
    /// For a person, if the log has a START and the map will not take it.
    [[nodiscard]] std::optional<std::string> warning() const;

  private:
    /// A damaged log may name any number of interfaces; those beyond are followed from their first heartbeat.
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
    Followed all_;  ///< every interface; until one is chosen
    std::map<std::string, Followed> followed_;
    std::optional<std::string> interface_;
};

}  // namespace octoskin
