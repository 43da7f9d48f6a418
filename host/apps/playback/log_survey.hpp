// What has to be known of a log before it is replayed, found in one pass: the interface that the rig is on,
// and whether the map begins at a START.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "host/core/pipeline/mark_window.hpp"
#include "host/core/pipeline/start_scan.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/io/candump/log_reader.hpp"

namespace octoskin {

class LogSurvey {
  public:
    explicit LogSurvey(const HostRig& rig) : rig_(rig), all_(rig) {}

    /// Entries in the order of the log.
    void take(const candump::LogEntry& entry);
    /// Nothing that may follow would change the answers.
    [[nodiscard]] bool is_complete() const { return interface_ && chosen().has_start(); }

    /// The interface that the rig is on: the first that carries a heartbeat of one of its nodes. A log may
    /// hold several, and the same bus twice. Empty if none does: then every frame is looked at, and counted
    /// for what it is.
    [[nodiscard]] std::string interface() const { return interface_.value_or(""); }
    [[nodiscard]] MapBegin begin() const {
        return chosen().has_start() ? MapBegin::start_mark : MapBegin::first_usable;
    }
    /// For a person, if the log has a START and the map will not take it.
    [[nodiscard]] std::optional<std::string> warning() const;

  private:
    /// A damaged log may name any number of interfaces; those beyond are followed from their first heartbeat.
    static constexpr std::size_t kInterfacesMax = 16;

    [[nodiscard]] bool is_heartbeat_of_rig(const wire::CanFrame& frame) const;
    [[nodiscard]] const StartScan& chosen() const { return interface_ ? scans_.at(*interface_) : all_; }

    const HostRig& rig_;
    StartScan all_;  ///< of every interface; until one is chosen
    std::map<std::string, StartScan> scans_;
    std::optional<std::string> interface_;
};

}  // namespace octoskin
