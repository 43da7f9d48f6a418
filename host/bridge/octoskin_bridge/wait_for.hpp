// Waits for messages of topics.
#pragma once

#include <poll.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "host/apps/command_line/command_failure.hpp"
#include "host/bridge/bridge/inlet.hpp"
#include "host/bridge/cdr/cdr_reader.hpp"
#include "host/bridge/dds/participant.hpp"

namespace octoskin::bridge {

using Deadline = std::chrono::steady_clock::time_point;
inline constexpr std::size_t kWaitedBytesMax = std::size_t{17} << 20U;

/// Throws app::CommandFailure if the network cannot be used.
[[nodiscard]] inline std::unique_ptr<dds::Participant> take_part() {
    const auto network = dds::network_of(dds::process_environment, false);
    if (!network) throw app::CommandFailure(ExitCode::usage, network.error());
    auto participant = dds::Participant::open(*network);
    if (!participant) throw app::CommandFailure(ExitCode::unavailable, participant.error());
    return std::move(participant).value();
}

/// Calls `look` whenever something may have come, until it returns a value, or until `end`.
template <class Look>
[[nodiscard]] auto wait_until(const dds::Participant& participant, Deadline end, Look look)
    -> decltype(look()) {
    while (std::chrono::steady_clock::now() < end) {
        pollfd ready{participant.descriptor(), POLLIN, 0};
        (void)::poll(&ready, 1, 100);
        (void)participant.clear();
        if (auto found = look()) return found;
    }
    return {};
}

/// Calls `use` with each message that waits until it returns a value.
template <cdr::Message M, class Use>
[[nodiscard]] auto look_at(const dds::Participant& participant, Inlet& inlet, Use use)
    -> decltype(use(std::declval<const M&>())) {
    constexpr std::size_t kMessages = 64;
    inlet.attend(participant.other_writers());
    for (const dds::Sample& sample : inlet.take(kMessages)) {
        const auto message = cdr::read<M>(sample.bytes);
        if (!message) continue;
        if (auto found = use(*message)) return found;
    }
    return {};
}

/// Calls `use` with each message of the topic until it returns a value, or until `end`.
template <cdr::Message M, class Use>
[[nodiscard]] auto wait_for(const dds::Participant& participant, const std::string& topic, Deadline end,
                            Use use) -> decltype(use(std::declval<const M&>())) {
    constexpr std::int32_t kKept = 64;
    Inlet inlet(participant, topic, M::kType, dds::Durability::transient_local, kKept, kWaitedBytesMax);
    return wait_until(participant, end, [&] { return look_at<M>(participant, inlet, use); });
}

}  // namespace octoskin::bridge
