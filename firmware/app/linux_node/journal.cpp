#include "firmware/app/linux_node/journal.hpp"

#include <unistd.h>

#include <array>
#include <cstdio>

#include "common/wire/names.hpp"
#include "firmware/port/linux/line_writer.hpp"

namespace octoskin::linux_node {
namespace {

std::string hex(std::uint32_t number) {
    std::array<char, 9> digits{};
    (void)std::snprintf(digits.data(), digits.size(), "%08x", number);
    return digits.data();
}

std::string text_of(const vl53l1x::RegisterDifference& difference) {
    std::array<char, 64> text{};
    (void)std::snprintf(text.data(), text.size(), "register %02x written %02x, reads %02x",
                        unsigned{difference.index}, unsigned{difference.expected},
                        unsigned{difference.found});
    return text.data();
}

const char* words(node::CanState state) {
    switch (state) {
        case node::CanState::active:
            return "the controller takes part";
        case node::CanState::passive:
            return "error-passive: no node acknowledges, or the lines are disturbed";
        case node::CanState::bus_off:
            return "bus-off; waiting for the kernel to restart it (`restart-ms`)";
    }
    return "?";
}

}  // namespace

void say(const std::string& what) {
    // One write per line, so that the lines of several nodes do not mix.
    static linux_port::LineWriter writer(STDERR_FILENO);
    writer.add("octoskin-node: " + what + "\n");
}

void Journal::started(const NodeConfig& config, const std::string& can, std::uint32_t build_id) {
    say("node " + std::to_string(config.node_id) + ": " + std::to_string(config.sensor_count) +
        " sensors, node_hash " + hex(node_hash(config)) + ", CAN" + (config.uses_can_fd ? " FD" : "") +
        " on " + can + ", build " + hex(build_id));
}

void Journal::update(const node::Node& node, const linux_port::CanInterface& can,
                     const linux_port::XshutOutputs& xshut, const linux_port::DataReadyInputs& data_ready) {
    if (const wire::NodeState state = node.state(); state_ != state) {
        say(std::string("state ") + wire::name(state));
        state_ = state;
    }
    if (can.trouble() != trouble_) {
        trouble_ = can.trouble();
        say(trouble_.empty() ? "CAN: the interface is up" : trouble_ + "; waiting");
    }
    const node::CanState can_state = can.trouble().empty() ? can.state() : can_state_;
    if (can_state != can_state_) {
        can_state_ = can_state;
        say(std::string("CAN: ") + words(can_state));
    }
    if (const std::uint8_t ignored = node.ignored_data_ready(); ignored != ignored_data_ready_) {
        ignored_data_ready_ = ignored;
        say("noisy data-ready lines, ignored: buses " + hex(ignored) + " (one bit each)");
    }
    say_troubles(node);
    if (can.unconfirmed() != unconfirmed_) {
        unconfirmed_ = can.unconfirmed();
        say("CAN: " + std::to_string(unconfirmed_) + " frames never confirmed since start");
    }
    for (const auto& gone = data_ready.gone(); data_ready_gone_ < gone.size(); ++data_ready_gone_)
        say("data-ready line " + gone[data_ready_gone_] +
            ": gone with its GPIO chip; the sensors of its bus are polled over I2C");
    if (xshut.failures() != xshut_failures_) {
        xshut_failures_ = xshut.failures();
        say("XSHUT: the kernel refused to set a line, " + std::to_string(xshut_failures_) +
            " times since start");
    }
}

void Journal::say_troubles(const node::Node& node) {
    const auto sensors = node.sensors();
    for (std::size_t i = 0; i < sensors.size(); ++i) {
        const node::Sensor& sensor = *sensors[i];
        const auto trouble = sensor.trouble();
        if (trouble == troubles_[i]) continue;
        troubles_[i] = trouble;
        say("sensor " + std::to_string(i) + ": " + wire::name(sensor.state()) +
            (trouble ? std::string(", ") + wire::name(trouble->fault) : "") +
            (trouble && trouble->difference ? ", " + text_of(*trouble->difference) : ""));
    }
    for (const auto& reported : node.alike().subspan(common_reported_))
        say(text_of(reported.difference) + ", alike on several sensors: their readings are still sent");
    common_reported_ = node.alike().size();
}

}  // namespace octoskin::linux_node
