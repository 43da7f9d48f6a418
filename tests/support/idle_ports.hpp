// Ports of a node for tests that do not use them.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/core/ports.hpp"

namespace octoskin::test {

class NoLines final : public node::XshutLines {
    void set(std::uint8_t, bool) override {}
};

/// Accepts every frame.
class NoCan final : public node::CanTransmitter {
    bool send(const wire::CanFrame&) override { return true; }
    [[nodiscard]] node::CanState state() const override { return node::CanState::active; }
    void discard() override {}
    std::optional<wire::CanFrame> take_given_up() override { return std::nullopt; }
    void restart() override {}
};

}  // namespace octoskin::test
