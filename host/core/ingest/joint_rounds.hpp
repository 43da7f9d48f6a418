// Decides whether a frame of a joint sample can come from the sample's own sender.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

/// A sequence number repeats after a round of eight samples. A frame that contradicts one of its number may
/// be a late frame of the round before. It is not, if every frame of that round arrived in time.
class JointRounds {
  public:
    explicit JointRounds(Nanoseconds period) : period_(period) {}

    /// Takes frames in order of arrival. True if the frame contradicts one of its own sample shortly after
    /// that sample began, and cannot be of the round before: two senders use one number.
    [[nodiscard]] bool is_of_no_round(const wire::JointState& frame, HostTime now);

  private:
    struct Round {
        HostTime begun;
        HostTime newest;
        bool is_in_one_go = true;  ///< no frame of another number arrived among its own
        std::array<std::optional<wire::JointState>, 4> parts;
    };
    struct Rounds {
        std::optional<Round> before;
        std::optional<Round> current;
    };
    void begin_round_if_due(Rounds& rounds, HostTime now) const;
    [[nodiscard]] bool was_whole_in_its_time(const std::optional<Round>& round, HostTime now) const;

    Nanoseconds period_;
    std::optional<std::uint8_t> newest_number_;
    std::array<Rounds, wire::kJointSequenceCount> rounds_;
};

}  // namespace octoskin
