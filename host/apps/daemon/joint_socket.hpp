// Joint states from a program of this machine: one datagram of text a sample, to a Unix socket.
//
//     [TIME] Q1 Q2 ... QN        radians (metres for a prismatic joint), in the rig's order; TIME: seconds of
//                                CLOCK_MONOTONIC at which it was sampled, with one more number than joints;
//                                without it the time of arrival
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
    WallTime came;               ///< through a socket
    bool has_own_time = false;   ///< else `sampled` is when it came
    bool is_of_several = false;  ///< another sender is heard beside its own
};

enum class JointTextFault : std::uint8_t {
    not_a_number,  ///< a word that is no finite number, or none where a comma divides two
    wrong_count,   ///< neither as many numbers as joints, nor one more
    time_off,      ///< more than 1 s from when it was read, or not told, and it waited for as long to be read
    too_large,     ///< a position beyond the +-8.38 rad of the wire
    too_long,      ///< over kJointTextMax bytes
};
[[nodiscard]] constexpr std::array<const char*, 5> names_of(JointTextFault) {
    return {"not_a_number", "wrong_count", "time_off", "too_large", "too_long"};
}
inline constexpr std::size_t kJointTextMax = 1024;

/// One line or datagram, read at `now`, which came at `came`; empty: nobody knows when. Any bytes are safe.
[[nodiscard]] Result<JointSample, JointTextFault> parse_joints(std::string_view text, std::size_t joint_count,
                                                               HostTime now, std::optional<HostTime> came);

/// What a line must be, for whoever sent another.
inline constexpr std::string_view kJointTextWanted =
    "[TIME] Q1 ... QN, radians (metres for a prismatic joint) in the rig's order; TIME is CLOCK_MONOTONIC in "
    "seconds, within 1 s of now";

/// Why `text` was refused at `now`, for a person: "wrong_count: 3 numbers, the rig has 7 joints",
/// "too_large: joint 2 of 7 is 90, beyond +-8.388607: degrees, or millimetres?".
[[nodiscard]] std::string describe(JointTextFault fault, std::string_view text, std::size_t joint_count,
                                   HostTime now);

/// What comes is read and dated by a thread of its own, and waits for `receive`: DatagramFeed::kWaitingMax at
/// most.
class JointSocket {
  public:
    /// Makes the socket file, over one that a dead process left; refuses one that somebody listens on.
    [[nodiscard]] static Result<JointSocket, AppError> open(const std::filesystem::path& file,
                                                            std::size_t joint_count);
    JointSocket(JointSocket&& other) noexcept = default;
    JointSocket& operator=(JointSocket&& other) noexcept;
    ~JointSocket();

    /// Readable when a datagram waits.
    [[nodiscard]] int descriptor() const noexcept { return feed_->descriptor(); }
    /// From now on a sample has so many joints.
    void expect(std::size_t joint_count) noexcept { joint_count_ = joint_count; }
    /// Takes one datagram, if one is here. False if none was. What is no sample is counted, and `sample` then
    /// empty.
    [[nodiscard]] bool receive(std::optional<JointSample>& sample);

    [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
    [[nodiscard]] const JointSenders& senders() const noexcept { return senders_; }
    /// Samples that came in the newest whole second; those of several senders together.
    [[nodiscard]] double rate_hz(HostTime now) const;
    [[nodiscard]] const std::array<std::uint64_t, 5>& faults() const noexcept { return faults_; }
    /// Whose datagram was newest of those that were no sample; empty: there was none.
    [[nodiscard]] const std::optional<JointSender>& newest_refused() const noexcept { return refused_; }
    /// Datagrams that gave way to newer ones, as nobody received for too long.
    [[nodiscard]] std::uint64_t displaced() const { return feed_->displaced(); }
    /// Datagrams beyond what one program may send, or of more programs than eight.
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
    HostTime second_begun_;             ///< of the one that is counted
    std::uint64_t second_samples_ = 0;  ///< in it, so far
    double rate_hz_ = 0.0;              ///< of the one before
    std::array<std::uint64_t, 5> faults_{};
    std::optional<JointSender> refused_;
};

}  // namespace octoskin
