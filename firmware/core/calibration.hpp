// What a node is asked to calibrate and what it answers: at most one sensor at a time.
#pragma once

#include <array>
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

/// The node's half of the dialogue: which calibration is under way, and which answers are to be sent. Answers
/// go in the order of their commands, each once: who misses one asks again. The end, for which nobody could
/// ask, goes three times: at once, and after each of the next two heartbeats.
class CalibrationDialogue {
  public:
    static constexpr std::uint8_t kEndsSent = 3;

    [[nodiscard]] bool is_under_way() const noexcept { return under_way_.has_value(); }
    /// Of the calibration under way.
    [[nodiscard]] std::uint8_t sensor() const noexcept { return under_way_->sensor; }

    /// `command` calibrates one sensor, not all.
    void accept(const wire::Command& command) noexcept;
    void refuse(const wire::Command& command) noexcept;
    /// Answers once more if it is the very command whose calibration is under way; else returns false.
    [[nodiscard]] bool answers_again(const wire::Command& command) noexcept;
    /// Of the one under way.
    void end(const CalibrationResult& result) noexcept;

    [[nodiscard]] std::optional<wire::Calibration> due() const noexcept;
    /// What was due is on its way.
    void sent() noexcept;
    void on_heartbeat_sent() noexcept { is_end_due_ = ends_left_ > 0; }

  private:
    void answer(const wire::Calibration& answer) noexcept;

    std::optional<wire::Calibration> under_way_;
    /// Oldest first. Whoever asks more than this before the bus takes an answer gets none to the rest.
    std::array<wire::Calibration, 4> answers_{};
    std::uint8_t answer_count_ = 0;
    wire::Calibration ended_;
    std::uint8_t ends_left_ = 0;
    bool is_end_due_ = false;
};

/// What a command to calibrate is about.
[[nodiscard]] CalibrationOrder order_of(const wire::Command& command) noexcept;

}  // namespace octoskin::node
