// Joint states from programs of this machine: one datagram of text a sample (joint_line.hpp), to a Unix
// socket.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/apps/daemon/datagram_feed.hpp"
#include "host/apps/daemon/joint_line.hpp"
#include "host/apps/daemon/joint_senders.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// Datagrams are read and get their times in their own thread, and wait for `receive`: at most
/// DatagramFeed::kWaitingMax.
class JointSocket {
  public:
    /// Creates the socket file, replacing that of a dead process; refuses one on which a process listens.
    [[nodiscard]] static Result<JointSocket, AppError> open(const std::filesystem::path& file,
                                                            LineJoints joints);
    JointSocket(JointSocket&& other) noexcept = default;
    JointSocket& operator=(JointSocket&& other) noexcept;
    ~JointSocket();

    /// Readable when a datagram waits.
    [[nodiscard]] int descriptor() const noexcept { return feed_->descriptor(); }
    /// From now on a line has these joints. A source of the same joints keeps its senders.
    void expect(LineJoints joints);
    /// Takes the next sample of a datagram, and the next datagram if there is none; false if none has
    /// arrived. A datagram that is no sample is counted, and `sample` is then empty.
    [[nodiscard]] bool receive(std::optional<JointSample>& sample);

    [[nodiscard]] const LineJoints& joints() const noexcept { return joints_; }
    /// Samples of all sources together.
    [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
    /// Of one source: its index in LineJoints::sources.
    [[nodiscard]] std::uint64_t samples(std::size_t source) const { return records_.at(source).samples; }
    [[nodiscard]] const JointSenders& senders(std::size_t source) const {
        return records_.at(source).senders;
    }
    /// Samples of a source received in the newest whole second, of all senders together.
    [[nodiscard]] double rate_hz(std::size_t source, HostTime now) const;
    [[nodiscard]] const std::array<std::uint64_t, 5>& faults() const noexcept { return faults_; }
    /// The sender of the newest datagram that was no sample; empty: there was none.
    [[nodiscard]] const std::optional<JointSender>& newest_refused() const noexcept { return refused_; }
    /// Datagrams displaced by newer ones, because none was received for too long.
    [[nodiscard]] std::uint64_t displaced() const { return feed_->displaced(); }
    /// Datagrams beyond the share of one program, or of more programs than eight.
    [[nodiscard]] std::uint64_t surplus() const { return feed_->surplus(); }

  private:
    /// Of one source.
    struct Record {
        JointSenders senders;
        std::uint64_t samples = 0;
        HostTime second_begun;             ///< of the second being counted
        std::uint64_t second_samples = 0;  ///< in that second, so far
        double rate_hz = 0.0;              ///< of the second before
        void count(HostTime at);
    };
    JointSocket(SocketFile file, std::unique_ptr<DatagramFeed> feed, LineJoints joints)
        : file_(std::move(file)),
          feed_(std::move(feed)),
          joints_(std::move(joints)),
          records_(joints_.sources.size()) {}
    void take(const Datagram& datagram);

    SocketFile file_;
    std::unique_ptr<DatagramFeed> feed_;
    LineJoints joints_;
    std::vector<Record> records_;              ///< by source
    std::deque<JointSample> samples_of_line_;  ///< of the newest datagram, not taken yet
    std::uint64_t samples_ = 0;
    std::array<std::uint64_t, 5> faults_{};
    std::optional<JointSender> refused_;
};

}  // namespace octoskin
