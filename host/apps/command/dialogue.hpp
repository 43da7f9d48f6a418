// The host's side of a command: what is sent to the node, how success and refusal are detected, and the time
// limits. Input: frames and times. Output: frames and an outcome.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "host/apps/command/node_view.hpp"
#include "host/apps/command/order.hpp"
#include "host/apps/node_session/node_session.hpp"

namespace octoskin::commanding {

/// Nodes do not acknowledge commands; they count the commands that they refuse. The dialogue requests
/// NODE_INFO, sends the command, and requests NODE_INFO again. If the node's count of refusals has grown, it
/// refused the command. Otherwise its heartbeats and SENSOR_HEALTH must show the effect.
/// A node receives commands if it sends all pages of NODE_INFO at once; unrequested, they arrive one after
/// another within a second.
/// Every wait is limited: 2 s for a heartbeat; 0.3 s for NODE_INFO, three attempts; 5 s for the effect.
/// Before a reset up to 5 s more, until the uptime is long enough to detect the restart.
/// Limit: a command of another host at the same instant may be taken for this one.
class Dialogue final : public NodeDialogue {
  public:
    /// Success: what was done, one line or more for the user. Errors: `failed` (refused, or no effect),
    /// `unavailable` (no heartbeat, no answer), `usage` (no such sensor), `bad_config` (another protocol, or
    /// a sensor's name with another configuration), `io_failed` (silent since the command).
    using Outcome = Result<std::string, AppError>;

    Dialogue(Order order, HostTime now);

    void on_frame(const wire::CanFrame& frame, HostTime now) override;
    void on_time(HostTime now) override;
    [[nodiscard]] std::optional<wire::CanFrame> take_frame() override;
    void on_sent(HostTime now) override;
    [[nodiscard]] HostTime deadline() const noexcept override { return deadline_; }
    [[nodiscard]] bool is_over() const noexcept override { return outcome_.has_value(); }
    [[nodiscard]] const std::optional<Outcome>& outcome() const noexcept { return outcome_; }

  private:
    enum class Step : std::uint8_t {
        awaiting_heartbeat,
        awaiting_uptime,  ///< until the uptime is long enough that a reset shows as a shorter one
        asking_before,
        commanding,
        awaiting_rest,  ///< until messages from before the command have arrived
        asking_after,
        awaiting_effect,
    };

    void take(const wire::Message& message);
    void advance(HostTime now);
    void on_first_heartbeat(HostTime now);
    void ask(Step step, HostTime now);
    void ask_again(HostTime now);
    void send(wire::CommandCode code);
    void command(HostTime now);
    void judge(HostTime now);
    void judge_reset(HostTime now);
    void on_no_effect();
    void succeed();
    void give_up(ExitCode exit, Error error);

    Order order_;
    Step step_ = Step::awaiting_heartbeat;
    HostTime deadline_;
    HostTime commanded_;
    int asks_ = 0;
    int uptime_waits_ = 0;
    std::uint8_t sends_ = 0;
    NodeView before_;
    NodeView view_;
    bool has_sent_black_box_ = false;
    std::optional<wire::CanFrame> to_send_;
    std::optional<Outcome> outcome_;
};

}  // namespace octoskin::commanding
