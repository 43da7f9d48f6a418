// Joint states from a program of this machine: one datagram of text a sample, to a Unix socket.
//
//     [TIME] Q1 Q2 ... QN        radians (metres for a prismatic joint), in the rig's order. TIME: seconds of
//                                CLOCK_MONOTONIC at which it was sampled, if there is one number more than
//                                joints; without it the time of arrival
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/apps/daemon/datagram_feed.hpp"
#include "host/apps/daemon/joint_senders.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

struct JointSample {
    HostTime sampled;
    std::vector<double> position;
    WallTime came;               ///< arrival at the socket
    bool has_own_time = false;   ///< else `sampled` is its arrival
    bool is_of_several = false;  ///< other senders are active beside its own
};

enum class JointTextFault : std::uint8_t {
    not_a_number,  ///< a word that is no finite number, or none where a comma divides two
    wrong_count,   ///< neither as many numbers as joints, nor one more
    time_off,      ///< over 1 s from when it was read, or without a time and read over 1 s after its arrival
    too_large,     ///< a position beyond +-8.38 rad, the range on the wire
    too_long,      ///< over kJointTextMax bytes
};
[[nodiscard]] constexpr std::array<const char*, 5> names_of(JointTextFault) {
    return {"not_a_number", "wrong_count", "time_off", "too_large", "too_long"};
}
inline constexpr std::size_t kJointTextMax = 1024;

/// Parses one line or datagram, read at `now`, received at `came`; empty: not known. Any bytes are safe.
[[nodiscard]] Result<JointSample, JointTextFault> parse_joints(std::string_view text, std::size_t joint_count,
                                                               HostTime now, std::optional<HostTime> came);

/// The required form of a line, for the sender of another one.
inline constexpr std::string_view kJointTextWanted =
    "[TIME] Q1 ... QN, radians (metres for a prismatic joint) in the rig's order; TIME is CLOCK_MONOTONIC in "
    "seconds, within 1 s of now";

/// Why `text` was refused at `now`, for a person: "wrong_count: 3 numbers, the rig has 7 joints",
/// "too_large: joint 2 of 7 is 90, beyond +-8.388607: degrees, or millimetres?".
[[nodiscard]] std::string describe(JointTextFault fault, std::string_view text, std::size_t joint_count,
                                   HostTime now);

/// Datagrams are read and get their times in their own thread, and wait for `receive`: at most
/// DatagramFeed::kWaitingMax.
class JointSocket {
  public:
    /// Creates the socket file, replacing that of a dead process; refuses one on which a process listens.
    [[nodiscard]] static Result<JointSocket, AppError> open(const std::filesystem::path& file,
                                                            std::size_t joint_count);
    JointSocket(JointSocket&& other) noexcept = default;
    JointSocket& operator=(JointSocket&& other) noexcept;
    ~JointSocket();

    /// Readable when a datagram waits.
    [[nodiscard]] int descriptor() const noexcept { return feed_->descriptor(); }
    /// From now on a sample has this many joints.
    void expect(std::size_t joint_count) noexcept { joint_count_ = joint_count; }
    /// Takes one datagram, if one has arrived; false if not. A datagram that is no sample is counted, and
    /// `sample` is then empty.
    [[nodiscard]] bool receive(std::optional<JointSample>& sample);

    [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
    [[nodiscard]] const JointSenders& senders() const noexcept { return senders_; }
    /// Samples received in the newest whole second, of all senders together.
    [[nodiscard]] double rate_hz(HostTime now) const;
    [[nodiscard]] const std::array<std::uint64_t, 5>& faults() const noexcept { return faults_; }
    /// The sender of the newest datagram that was no sample; empty: there was none.
    [[nodiscard]] const std::optional<JointSender>& newest_refused() const noexcept { return refused_; }
    /// Datagrams displaced by newer ones, because none was received for too long.
    [[nodiscard]] std::uint64_t displaced() const { return feed_->displaced(); }
    /// Datagrams beyond the share of one program, or of more programs than eight.
    [[nodiscard]] std::uint64_t surplus() const { return feed_->surplus(); }

  private:
    JointSocket(std::filesystem::path file, std::unique_ptr<DatagramFeed> feed, std::size_t joint_count)
        : file_(std::move(file)), feed_(std::move(feed)), joint_count_(joint_count) {}

    std::filesystem::path file_;
    std::unique_ptr<DatagramFeed> feed_;
    std::size_t joint_count_ = 0;
    void count_rate(HostTime at);

    JointSenders senders_;
    std::uint64_t samples_ = 0;
    HostTime second_begun_;             ///< of the second being counted
    std::uint64_t second_samples_ = 0;  ///< in that second, so far
    double rate_hz_ = 0.0;              ///< of the second before
    std::array<std::uint64_t, 5> faults_{};
    std::optional<JointSender> refused_;
};

}  // namespace octoskin
