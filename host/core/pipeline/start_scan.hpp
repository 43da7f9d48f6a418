// Checks, before a replay, whether a recording has a START that the map will take, by the replay's own rules.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/pipeline/mark_gate.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// For the frames of a Pipeline, `has_start()` is true exactly if that Pipeline, begun with
/// MapBegin::start_mark, takes a START.
class StartScan {
  public:
    explicit StartScan(const HostRig& rig, const IntakeConfig& config = {}) : intake_(rig, config) {}

    /// Takes frames in order of arrival. About 1 us.
    void on_frame(const wire::CanFrame& frame, WallTime stamp);

    [[nodiscard]] bool has_start() const noexcept { return has_start_; }

    /// STARTs whose time is too far from their arrival.
    struct Ignored {
        std::uint64_t count = 0;
        Nanoseconds ahead{0};  ///< last one's time minus the host time
    };
    [[nodiscard]] const Ignored& ignored() const noexcept { return ignored_; }
    /// STARTs that arrived while the host time was unknown, and that no host time followed.
    [[nodiscard]] std::size_t waiting() const noexcept { return marks_.waiting(); }

  private:
    void judge(const wire::Mark& mark, bool is_taken, std::optional<HostTime> now);

    CanIntake intake_;
    MarkGate marks_{MapBegin::start_mark};
    bool has_start_ = false;
    Ignored ignored_;
};

}  // namespace octoskin
