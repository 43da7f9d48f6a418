// Calibration by command: the order to a node and its answer. At most one sensor at a time.
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

/// For a run whose `poll` just returned `done` or `failed`.
[[nodiscard]] CalibrationResult result_of(const vl53l1x::CalibrationRun& run,
                                          vl53l1x::Progress progress) noexcept;

/// The node's side of a calibration: which one is under way, and which answers are due. Answers are sent in
/// the order of their commands, each once; a host that misses one repeats its command. The final outcome
/// cannot be requested again, so it is sent three times: at once, and after each of the next two heartbeats.
class CalibrationDialogue {
  public:
    static constexpr std::uint8_t kEndsSent = 3;

    [[nodiscard]] bool is_under_way() const noexcept { return under_way_.has_value(); }
    /// The sensor of the calibration under way.
    [[nodiscard]] std::uint8_t sensor() const noexcept { return under_way_->sensor; }

    /// `command` calibrates one sensor, not all.
    void accept(const wire::Command& command) noexcept;
    void refuse(const wire::Command& command) noexcept;
    /// If `command` is the one whose calibration is under way, answers once more; else returns false.
    [[nodiscard]] bool answers_again(const wire::Command& command) noexcept;
    /// Ends the calibration under way.
    void end(const CalibrationResult& result) noexcept;

    [[nodiscard]] std::optional<wire::Calibration> due() const noexcept;
    /// `due()` was handed to the bus.
    void sent() noexcept;
    void on_heartbeat_sent() noexcept { is_end_due_ = ends_left_ > 0; }

  private:
    void answer(const wire::Calibration& answer) noexcept;

    std::optional<wire::Calibration> under_way_;
    /// Oldest first. While it is full, further commands get no answer.
    std::array<wire::Calibration, 4> answers_{};
    std::uint8_t answer_count_ = 0;
    wire::Calibration ended_;
    std::uint8_t ends_left_ = 0;
    bool is_end_due_ = false;
};

/// The order in a calibration command.
[[nodiscard]] CalibrationOrder order_of(const wire::Command& command) noexcept;

}  // namespace octoskin::node
