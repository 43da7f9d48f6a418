// One line of text with joint positions: a datagram to the daemon, or a line to `octoskin joints`.
//
//     [TIME] Q1 Q2 ... QN                 radians (metres for a prismatic joint), in the rig's order
//     [TIME] NAME=Q NAME=Q ...            the same by name, in any order, of one or more sources; other names
//     are
//                                         left out
//
// TIME: seconds of CLOCK_MONOTONIC at which they were sampled, if there is one number more than joints, or a
// number before the names; without it the time of arrival.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// The joints of a line, by source, in the order of a line of numbers.
struct LineJoints {
    struct Source {
        std::size_t index = 0;           ///< in HostRig::joint_sources
        std::vector<std::string> names;  ///< 1..7
        double rate_hz = 100.0;
        /// For each joint, whether it is continuous: any number of turns is the same position.
        std::vector<bool> turns = {};
    };
    std::vector<Source> sources;

    [[nodiscard]] std::size_t count() const;
    /// The sources of the rig that come from this machine. `limits`: of all joints of the rig.
    [[nodiscard]] static LineJoints local(const HostRig& rig, std::span<const JointLimits> limits);
};

/// What a line has of one source.
struct JointSample {
    HostTime sampled;
    std::vector<double> position;  ///< in the source's order
    WallTime came;                 ///< arrival at the socket
    bool has_own_time = false;     ///< else `sampled` is its arrival
    bool is_of_several = false;    ///< other senders of this source are active beside its own
    std::size_t source = 0;        ///< index in LineJoints::sources
};

/// What a line has of each source; at least one.
struct JointLine {
    std::vector<JointSample> samples;
    WallTime came;
    bool has_own_time = false;
};

enum class JointTextFault : std::uint8_t {
    not_a_number,  ///< a word that is no finite number, or none where a comma divides two
    wrong_count,   ///< neither as many numbers as joints, nor one more; by name: a part of a source, or none
    time_off,      ///< over 1 s from when it was read, or without a time and read over 1 s after its arrival
    too_large,     ///< a position beyond +-8.38 rad, the range on the wire, of a joint that has limits
    too_long,      ///< over kJointTextMax bytes
};
[[nodiscard]] constexpr std::array<const char*, 5> names_of(JointTextFault) {
    return {"not_a_number", "wrong_count", "time_off", "too_large", "too_long"};
}
inline constexpr std::size_t kJointTextMax = 4096;

/// Parses one line or datagram, read at `now`, received at `came`; empty: not known. Any bytes are safe.
[[nodiscard]] Result<JointLine, JointTextFault> parse_joints(std::string_view text, const LineJoints& joints,
                                                             HostTime now, std::optional<HostTime> came);

/// The required form of a line, for the sender of another one.
inline constexpr std::string_view kJointTextWanted =
    "[TIME] Q1 ... QN or [TIME] NAME=Q ..., radians (metres for a prismatic joint), numbers in the rig's "
    "order; TIME is CLOCK_MONOTONIC in seconds, within 1 s of now";

/// Why `text` was refused at `now`, for a person: "wrong_count: 3 numbers, the rig has 7 joints",
/// "too_large: joint 2 of 7 is 90, beyond +-8.388607: degrees, or millimetres?".
[[nodiscard]] std::string describe(JointTextFault fault, std::string_view text, const LineJoints& joints,
                                   HostTime now);

}  // namespace octoskin
