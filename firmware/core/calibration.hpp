// What a node is asked to calibrate and what it answers: at most one sensor at a time.
#pragma once

#include <cstdint>
#include <optional>

#include "common/wire/messages.hpp"
#include "firmware/drivers/vl53l1x/calibration.hpp"

namespace octoskin::node {

struct CalibrationOrder {
    wire::CalibrationQuantity quantity = wire::CalibrationQuantity::offset;
    std::uint16_t target_mm = 0;
};

struct CalibrationResult {
    wire::CalibrationOutcome outcome = wire::CalibrationOutcome::done;
    std::int16_t offset_quarter_mm = 0;
    std::uint16_t crosstalk_raw = 0;
};

/// Of a run whose `poll` just said `done` or `failed`.
[[nodiscard]] CalibrationResult result_of(const vl53l1x::CalibrationRun& run,
                                          vl53l1x::Progress progress) noexcept;

/// The node's half of the dialogue: which calibration is under way, and which answers are to be sent. The
/// answer to a command goes before the end of what it began; a newer answer takes the place of one not sent.
class CalibrationDialogue {
  public:
    [[nodiscard]] bool is_under_way() const noexcept { return under_way_.has_value(); }
    /// Of the calibration under way.
    [[nodiscard]] std::uint8_t sensor() const noexcept { return under_way_->sensor; }

    /// `command` calibrates one sensor, not all.
    void accept(const wire::Command& command) noexcept;
    void refuse(const wire::Command& command) noexcept;
    /// Of the one under way.
    void end(const CalibrationResult& result) noexcept;

    [[nodiscard]] std::optional<wire::Calibration> due() const noexcept { return answer_ ? answer_ : ended_; }
    /// What was due is on its way.
    void sent() noexcept { (answer_ ? answer_ : ended_).reset(); }

  private:
    std::optional<wire::Calibration> under_way_;
    std::optional<wire::Calibration> answer_;
    std::optional<wire::Calibration> ended_;
};

/// What a command to calibrate is about.
[[nodiscard]] CalibrationOrder order_of(const wire::Command& command) noexcept;

}  // namespace octoskin::node
