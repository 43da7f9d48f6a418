// The host's side of a calibration: the command to the node, its answer, and the time limits. Input: frames
// and times. Output: frames and an outcome.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"
#include "host/apps/node_session/node_session.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin::calibrating {

struct Question {
    wire::NodeId node_id = 0;
    std::string node_name;
    std::uint32_t node_hash = 0;  ///< of the configuration that the rig compiles to
    std::uint8_t sensor = 0;      ///< index on the node
    std::string sensor_name;
    wire::CalibrationQuantity quantity = wire::CalibrationQuantity::offset;
    std::uint16_t target_mm = 0;
    std::uint16_t inter_measurement_ms = 0;
    std::uint8_t sequence = 0;  ///< differs from that of the last command
};

/// Waits for a heartbeat of the node, sends the command, then waits for the answer and for the result.
/// The node must have the rig's configuration: otherwise the index may mean another sensor. A heartbeat in a
/// state without calibration (safe mode, another board under the same id, ...) ends the dialogue at once.
/// Every wait is limited: 2 s for a heartbeat; 1 s for the answer, three attempts; 10 s and 130 periods for
/// the result.
class Dialogue final : public NodeDialogue {
  public:
    using Outcome = Result<wire::Calibration, AppError>;

    Dialogue(Question question, HostTime now);

    void on_frame(const wire::CanFrame& frame, HostTime now) override;
    void on_time(HostTime now) override;
    [[nodiscard]] std::optional<wire::CanFrame> take_frame() override;
    /// The node is measuring for this calibration.
    [[nodiscard]] bool is_under_way() const noexcept { return step_ == Step::awaiting_end; }
    [[nodiscard]] HostTime deadline() const noexcept override { return deadline_; }
    [[nodiscard]] bool is_over() const noexcept override { return outcome_.has_value(); }
    /// Set when the dialogue has ended: a message with `done`, or the error.
    [[nodiscard]] const std::optional<Outcome>& outcome() const noexcept { return outcome_; }

  private:
    enum class Step : std::uint8_t { awaiting_heartbeat, awaiting_answer, awaiting_end };

    void on_heartbeat(const wire::Heartbeat& heartbeat, HostTime now);
    void ask(HostTime now);
    void on_calibration(const wire::Calibration& said, HostTime now);
    void give_up(ExitCode exit, Error error);
    [[nodiscard]] std::string whom() const;

    Question question_;
    Step step_ = Step::awaiting_heartbeat;
    HostTime deadline_;
    int asks_ = 0;
    std::optional<wire::CanFrame> to_send_;
    std::optional<Outcome> outcome_;
};

}  // namespace octoskin::calibrating
