// Whether a recording has a START that the map will take: told before the replay, by the replay's own rules.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/pipeline/mark_gate.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// Given the frames that a Pipeline will be given, `has_start()` is true exactly if that Pipeline, begun with
/// MapBegin::start_mark, takes a START.
class StartScan {
  public:
    explicit StartScan(const HostRig& rig, const IntakeConfig& config = {}) : intake_(rig, config) {}

    /// Frames in the order of arrival. About 1 us.
    void on_frame(const wire::CanFrame& frame, WallTime stamp);

    [[nodiscard]] bool has_start() const noexcept { return has_start_; }

    /// STARTs that name a time too far from that at which they came.
    struct Ignored {
        std::uint64_t count = 0;
        Nanoseconds ahead{0};  ///< the last one's time after "now"; negative if before
    };
    [[nodiscard]] const Ignored& ignored() const noexcept { return ignored_; }
    /// STARTs that came while the host's clock was unknown, and no time after them.
    [[nodiscard]] std::size_t waiting() const noexcept { return marks_.waiting(); }

  private:
    void judge(const wire::Mark& mark, bool is_taken, std::optional<HostTime> now);

    CanIntake intake_;
    MarkGate marks_{MapBegin::start_mark};
    bool has_start_ = false;
    Ignored ignored_;
};

}  // namespace octoskin
