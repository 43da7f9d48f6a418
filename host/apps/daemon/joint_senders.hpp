// Which programs send joint states to the socket, and whether it is more than one.
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

/// As the kernel tells it, which no program can write itself. A process of another container may have no
/// number here: all of those are one sender, but for an address that they have bound.
struct JointSender {
    pid_t pid = 0;  ///< 0: cannot be seen
    uid_t uid = 0;
    std::string address;  ///< that its socket is bound to; empty: to none
    friend auto operator<=>(const JointSender&, const JointSender&) = default;
};

/// For a person: "process 4711 (python3, user 1000)".
[[nodiscard]] std::string describe(const JointSender& sender, const std::string& program);
/// With the name that it has now, or none if it has ended.
[[nodiscard]] std::string describe(const JointSender& sender);

class JointSenders {
  public:
    struct Heard {
        JointSender sender;
        std::string program;  ///< its name when it was first heard; empty: not known
        std::uint64_t samples = 0;
        HostTime newest;
    };
    /// A sample of it came.
    void hear(const JointSender& sender, HostTime at);

    /// More than one has been heard within the last kHeardFor.
    [[nodiscard]] bool are_several(HostTime now) const;
    /// Those that were heard within the last kHeardFor, the first heard first.
    [[nodiscard]] std::vector<Heard> heard(HostTime now) const;
    /// Those that were, when more than one was heard last; empty: there never was but one.
    [[nodiscard]] const std::vector<Heard>& newest_several() const noexcept { return several_; }
    [[nodiscard]] std::optional<HostTime> several_at() const noexcept { return several_at_; }

    /// One that was silent for so long is heard no more: a driver that is started anew costs as much.
    static constexpr Nanoseconds kHeardFor{1'000'000'000};
    /// Of a flood of processes as many are kept; the one that was silent for longest gives way.
    static constexpr std::size_t kKept = 16;

  private:
    std::vector<Heard> senders_;
    std::vector<Heard> several_;
    std::optional<HostTime> several_at_;
};

}  // namespace octoskin
