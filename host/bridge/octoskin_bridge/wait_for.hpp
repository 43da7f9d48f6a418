// Waits for one message of a topic.
#pragma once

#include <poll.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "host/apps/command_line/command_failure.hpp"
#include "host/bridge/bridge/inlet.hpp"
#include "host/bridge/cdr/cdr_reader.hpp"
#include "host/bridge/dds/participant.hpp"

namespace octoskin::bridge {

/// Calls `use` with each message of the topic until it returns a value, or for `patience`. Throws
/// app::CommandFailure if the network cannot be used.
template <cdr::Message M, class Use>
[[nodiscard]] auto wait_for(const std::string& topic, std::chrono::seconds patience, Use use)
    -> decltype(use(std::declval<const M&>())) {
    const auto network = dds::network_of(dds::process_environment, false);
    if (!network) throw app::CommandFailure(ExitCode::usage, network.error());
    const auto participant = dds::Participant::open(*network);
    if (!participant) throw app::CommandFailure(ExitCode::unavailable, participant.error());
    Inlet inlet(**participant, topic, M::kType, dds::Durability::transient_local, 64, std::size_t{17} << 20U);
    const auto end = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < end) {
        pollfd ready{(*participant)->descriptor(), POLLIN, 0};
        (void)::poll(&ready, 1, 100);
        (void)(*participant)->clear();
        inlet.attend((*participant)->other_writers());
        for (const dds::Sample& sample : inlet.take(64)) {
            const auto message = cdr::read<M>(sample.bytes);
            if (!message) continue;
            if (auto found = use(*message)) return found;
        }
    }
    return {};
}

}  // namespace octoskin::bridge
