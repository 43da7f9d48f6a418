// The programs that send joint states to the socket, and whether there are several.
#pragma once

#include <sys/types.h>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"

namespace octoskin {

/// By the kernel's data, which no program can forge. Processes of another container may have no number here:
/// all of those count as one sender, unless they have bound an address.
struct JointSender {
    pid_t pid = 0;  ///< 0: not visible
    uid_t uid = 0;
    std::string address;  ///< the address its socket is bound to; empty: none
    friend auto operator<=>(const JointSender&, const JointSender&) = default;
};

/// For a person: "process 4711 (python3, user 1000)".
[[nodiscard]] std::string describe(const JointSender& sender, const std::string& program);
/// With its present name, or none if it has ended.
[[nodiscard]] std::string describe(const JointSender& sender);

class JointSenders {
  public:
    struct Heard {
        JointSender sender;
        std::string program;  ///< its name at its first sample; empty: not known
        std::uint64_t samples = 0;
        HostTime newest;
    };
    /// Notes a sample of it.
    void hear(const JointSender& sender, HostTime at);

    /// More than one has sent within the last kHeardFor.
    [[nodiscard]] bool are_several(HostTime now) const;
    /// Those that have sent within the last kHeardFor, in the order of their first sample.
    [[nodiscard]] std::vector<Heard> heard(HostTime now) const;
    /// Those that did when there were several last; empty: there was never more than one.
    [[nodiscard]] const std::vector<Heard>& newest_several() const noexcept { return several_; }
    [[nodiscard]] std::optional<HostTime> several_at() const noexcept { return several_at_; }

    /// A sender counts for this long after its last sample; a restarted driver loses the same time.
    static constexpr Nanoseconds kHeardFor{1'000'000'000};
    /// In a flood of processes this many are kept; the one that was silent for longest is dropped.
    static constexpr std::size_t kKept = 16;

  private:
    std::vector<Heard> senders_;
    std::vector<Heard> several_;
    std::optional<HostTime> several_at_;
};

}  // namespace octoskin
