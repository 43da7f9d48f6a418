// Forwards lines of joint states from standard input.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "host/apps/daemon/joint_line.hpp"
#include "host/core/ingest/joint_burst.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/errors/error.hpp"

namespace octoskin::app {

/// The target of the samples.
class JointOutput {
  public:
    virtual ~JointOutput() = default;
    enum class Fate : std::uint8_t {
        sent,
        lost,     ///< it could not be sent now; it is not sent later
        thinned,  ///< it came sooner after the one before than the rig's rate
    };
    /// `parsed`: the line; empty without a rig, because the joints are then not known.
    [[nodiscard]] virtual Fate put(const std::string& line, const std::optional<JointLine>& parsed) = 0;
    /// Handles other requests of the target; called often.
    virtual void attend() = 0;
    /// -1, or a descriptor for which `attend` is called when it is readable.
    [[nodiscard]] virtual int descriptor() const = 0;
    /// Why nothing can be sent; empty while sending works.
    [[nodiscard]] virtual std::optional<Error> why() const = 0;
};

/// The joints of a line, and their limits. The daemon drops samples beyond them, and the sender of the lines
/// would not notice.
struct RigJoints {
    LineJoints joints;
    std::vector<std::vector<JointLimits>> limits;  ///< of each source

    /// Why the daemon would not accept a sample; empty: all are within the limits.
    [[nodiscard]] std::optional<Error> fault_of(const JointLine& line) const;
};

/// Log messages about the lines: once for each reason of a loss or refusal, and once when lines are sent
/// again.
class JointForwarder {
  public:
    /// `joints`: of the rig, if there is one to check lines against. `bursts`: one for each of its sources,
    /// whose lines without a time may come at once, and of which then only the newest is sent; empty: the
    /// other end detects that.
    JointForwarder(JointOutput& output, std::optional<RigJoints> joints, std::vector<JointBurst> bursts);

    /// Starts a block: its lines get the same time.
    void begin_block();
    /// A line of the block. With `bursts` it waits for `send_due`.
    void put(const std::string& line);
    /// Sends the waiting lines, except those that a newer one may still replace. Call it after each block,
    /// and soon again.
    void send_due();
    [[nodiscard]] bool is_waiting() const noexcept { return !waiting_.empty(); }
    /// Sends the waiting lines, and logs the counts. Throws CommandFailure if not a single line was sent.
    void finish();

  private:
    static constexpr std::size_t kLossesTold = 8;

    void send_until(WallTime now);
    [[nodiscard]] bool thin_oldest(WallTime now);
    [[nodiscard]] JointBurst::Turn turn_in_oldest(std::size_t source, WallTime now);
    [[nodiscard]] std::optional<WallTime> next_after_oldest(std::size_t source) const;
    void send(const std::string& line, const std::optional<JointLine>& parsed);
    void note_sent();
    void lose();
    void refuse(const char* reason, Error why);

    JointOutput& output_;
    std::optional<RigJoints> joints_;
    std::vector<JointBurst> bursts_;  ///< by source
    HostTime now_;                    ///< arrival of the block
    WallTime came_;                   ///< the same
    std::deque<JointLine> waiting_;   ///< for the end of a burst
    std::uint64_t sent_ = 0;
    std::uint64_t lost_ = 0;
    std::uint64_t refused_ = 0;
    std::uint64_t thinned_ = 0;                ///< lines with no sample that was due
    std::set<std::string> losses_reported_;    ///< each reason once since the last line that was sent
    std::set<std::string> refusals_reported_;  ///< likewise
    Error why_;                                ///< of the newest line that was not sent
};

}  // namespace octoskin::app
