// The host's half of a command: what is sent to which node, how its answer is told from its silence, and when
// to give up. Frames and times in, frames and an outcome out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "host/apps/commanding/node_view.hpp"
#include "host/apps/commanding/order.hpp"
#include "host/apps/conversation/conversation.hpp"

namespace octoskin::commanding {

/// Nodes acknowledge no command, but count those they refuse. So a node is asked for NODE_INFO, told what to
/// do, and asked once more: if it counted a refusal, it refused; else its heartbeats and SENSOR_HEALTH must
/// show the effect. That a node hears at all is seen by its giving all pages of NODE_INFO at once: unasked
/// they come one after the other, within a second.
///
/// Every wait ends: 2 s for a heartbeat, 0.3 s for NODE_INFO, asked three times, 5 s for the effect;
/// before a reset up to 5 s more for a run that is long enough to tell. Another
/// host's command at the same instant may be mistaken for this one.
class Dialogue final : public NodeDialogue {
  public:
    /// What was done, a line for a person and perhaps more; or why not: `failed` (refused, or no effect),
    /// `unavailable` (no heartbeat, no answer), `usage` (no such sensor), `bad_config` (another protocol, or
    /// a sensor's name and another configuration), `io_failed` (silent since the command).
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
        awaiting_uptime,  ///< a run so young that its end by a reset would not show
        asking_before,
        commanding,
        awaiting_rest,  ///< until what it had to say before the command is said
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
    void give_up(ExitCode code, const std::string& why);

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
