// Lines of joint states on their way from standard input to wherever they go.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "host/apps/daemon/joint_socket.hpp"
#include "host/core/ingest/joint_burst.hpp"
#include "host/core/kinematics/robot_model.hpp"

namespace octoskin::app {

/// Where a line's sample goes.
class JointOutput {
  public:
    virtual ~JointOutput() = default;
    /// `sample`: the line's; empty where no rig tells of how many joints it must be. False if it could not be
    /// sent now; it will not be sent later.
    [[nodiscard]] virtual bool put(const std::string& line, const std::optional<JointSample>& sample) = 0;
    /// Whatever else the way there asks for; called often.
    virtual void attend() = 0;
    /// -1, or what is worth a call of `attend` when it is readable.
    [[nodiscard]] virtual int descriptor() const = 0;
    /// Why nothing can be sent, for a person; empty while it can.
    [[nodiscard]] virtual std::string why() const = 0;
};

/// What a line must keep to. The daemon drops what is beyond it, and the sender of the lines does not see
/// that.
struct RigJoints {
    std::vector<std::string> names;
    std::vector<JointLimits> limits;

    /// Of a sample that the daemon would not take, why; empty: it is within the limits.
    [[nodiscard]] std::string fault_of(std::span<const double> position) const;
};

/// What is said of the lines: once for each reason why they are lost or refused, once when they go through
/// again.
class JointForwarder {
  public:
    /// `joints`: of the rig, if there is one to check lines against. `burst`: of lines without a time that
    /// were held up in one block the newest alone goes out; empty: that is for the other end to find. It
    /// needs `joints`.
    JointForwarder(JointOutput& output, std::optional<RigJoints> joints, std::optional<JointBurst> burst);

    /// Of the lines that came now, which are dated alike.
    void begin_block();
    /// A line of the block. With a `burst` it waits for `send_due`.
    void put(const std::string& line);
    /// What waits, but for what may have a newer one behind it yet. For after each block, and soon again.
    void send_due();
    [[nodiscard]] bool is_waiting() const noexcept { return !waiting_.empty(); }
    /// Sends what waits, and says what became of the lines. Throws CommandFailure if not a single one went
    /// through.
    void finish();

  private:
    static constexpr std::size_t kLossesTold = 8;

    void send_until(WallTime now);
    void send(const std::string& line, const std::optional<JointSample>& sample);
    void lose(std::uint64_t count);
    void refuse(const char* reason, std::string why);

    JointOutput& output_;
    std::optional<RigJoints> joints_;
    std::optional<JointBurst> burst_;
    HostTime now_;                     ///< when the block came
    WallTime came_;                    ///< the same
    std::deque<JointSample> waiting_;  ///< for the end of a burst
    std::uint64_t left_out_ = 0;       ///< of the burst: they fare as its newest does
    std::uint64_t sent_ = 0;
    std::uint64_t lost_ = 0;
    std::uint64_t refused_ = 0;
    std::set<std::string> losses_told_;    ///< each reason once since the last line that went through
    std::set<std::string> refusals_told_;  ///< likewise
    std::string why_;                      ///< of the newest line that did not go through
};

}  // namespace octoskin::app
