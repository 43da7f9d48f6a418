#include "firmware/core/stream_gate.hpp"

namespace octoskin::node {

namespace {

constexpr unsigned kRingStart = 128;
constexpr unsigned kRingLength = 128;

}  // namespace

std::optional<std::uint8_t> stream_steps(std::uint8_t previous, std::uint8_t current) noexcept {
    unsigned steps = 0;
    if (current >= previous) {
        steps = static_cast<unsigned>(current) - previous;
    } else if (current >= kRingStart) {
        // Both are on the ring then, as previous > current.
        steps = kRingLength - (static_cast<unsigned>(previous) - current);
    }
    if (steps == 0 || steps > kStreamStepsMax) return std::nullopt;
    return static_cast<std::uint8_t>(steps);
}

bool passes(StreamGate gate, std::uint8_t previous, std::uint8_t current) noexcept {
    switch (gate) {
        case StreamGate::off:
            return true;
        case StreamGate::differs:
            return current != previous;
        case StreamGate::advanced:
            return stream_steps(previous, current).has_value();
    }
    return false;
}

}  // namespace octoskin::node
