#include "hw/dbc/dbc_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string_view>
#include <system_error>

#include "hw/dbc/signals.hpp"

namespace octoskin::dbc {
namespace {

using wire::FrameSpec;
using wire::FrameType;
using wire::Party;
using wire::Unit;

constexpr const char* kHostName = "Host";

/// A message with one identifier on the bus.
struct BusMessage {
    std::string name;
    std::uint32_t can_id = 0;
    const FrameSpec* spec = nullptr;
    std::string sender;
};

struct Scale {
    double factor = 1.0;
    const char* unit = "";
};

Scale scale_of(Unit unit) {
    switch (unit) {
        case Unit::none:
            return {};
        case Unit::millimetre:
            return {1.0, "mm"};
        case Unit::quarter_millimetre:
            return {0.25, "mm"};
        case Unit::microsecond:
            return {1.0, "us"};
        case Unit::step_of_64_us:
            return {64.0, "us"};
        case Unit::second:
            return {1.0, "s"};
        case Unit::mcps_by_128:
            return {0.0078125, "Mcps"};
        case Unit::microradian:
            return {1e-6, "rad"};
        case Unit::permille:
            return {0.1, "%"};
        case Unit::kcps_by_512:
            return {0.001953125, "kcps"};
    }
    return {};
}

std::vector<BusMessage> messages_of(const FrameSpec& spec, const std::vector<Node>& nodes) {
    std::vector<BusMessage> messages;
    const auto add = [&spec, &messages](const std::string& suffix, wire::NodeId id,
                                        const std::string& sender) {
        messages.push_back({spec.name + suffix, can_id(spec.type, id), &spec, sender});
    };
    if (spec.party == Party::from_host) {
        add("", wire::kHostId, kHostName);
        return messages;
    }
    for (const Node& node : nodes) {
        const std::string suffix = fmt::format("_{}", node.node_id);
        if (spec.party == Party::to_node) {
            add(suffix, node.node_id, kHostName);
        } else if (is_sent_by(node.kind, spec.type)) {
            add(suffix, node.node_id, node.name);
        }
    }
    if (spec.party == Party::to_node) {
        add("_all", wire::kBroadcastId, kHostName);
    }
    return messages;
}

std::vector<BusMessage> all_messages(const std::vector<Node>& nodes) {
    std::vector<BusMessage> messages;
    for (const FrameSpec& spec : wire::kFrameSpecs) {
        for (BusMessage& message : messages_of(spec, nodes)) {
            messages.push_back(std::move(message));
        }
    }
    return messages;
}

std::string multiplexing_of(const Signal& signal) {
    if (signal.is_selector) {
        return " M";
    }
    return signal.only_if ? fmt::format(" m{}", signal.only_if->min) : "";
}

/// The start bit of a signal in DBC: its lowest bit or, for one with the high byte first, its highest.
unsigned dbc_start(const Signal& signal) {
    return signal.is_high_byte_first ? signal.start + 7 : signal.start;
}

/// 15 digits are exact for every factor and limit here, without binary rounding digits.
std::string limits_text(const Signal& signal, double factor) {
    if (!signal.is_signed) {
        return fmt::format("[{:.15g}|{:.15g}]", static_cast<double>(signal.min) * factor,
                           static_cast<double>(signal.max) * factor);
    }
    const auto half = static_cast<double>(1ULL << (signal.bits - 1));
    return fmt::format("[{:.15g}|{:.15g}]", -half * factor, (half - 1) * factor);
}

std::string signal_line(const Signal& signal, std::string_view receiver) {
    const auto [factor, unit] = scale_of(signal.unit);
    return fmt::format(" SG_ {}{} : {}|{}@{}{} ({:.15g},0) {} \"{}\" {}\n", signal.name,
                       multiplexing_of(signal), dbc_start(signal), signal.bits,
                       signal.is_high_byte_first ? 0 : 1, signal.is_signed ? '-' : '+', factor,
                       limits_text(signal, factor), unit, receiver);
}

std::string message_text(const BusMessage& message) {
    std::string text = fmt::format("BO_ {} {}: {} {}\n", message.can_id, message.name,
                                   message.spec->payload_len, message.sender);
    const char* receiver = message.sender == kHostName ? "Vector__XXX" : kHostName;
    for (const Signal& signal : signals_of(message.spec->type)) {
        text += signal_line(signal, receiver);
    }
    return text + "\n";
}

bool is_wide(const Signal& signal) {
    return signal.only_if && signal.only_if->min != signal.only_if->max;
}

/// A signal that is present for several values of the selector needs extended multiplexing. All other signals
/// of that selector then need it, too.
std::string ranges_text(const BusMessage& message) {
    const std::vector<Signal> signals = signals_of(message.spec->type);
    if (std::ranges::none_of(signals, is_wide)) {
        return "";
    }
    const auto selector = std::ranges::find(signals, true, &Signal::is_selector);
    std::string text;
    for (const Signal& signal : signals) {
        if (signal.only_if) {
            text += fmt::format("SG_MUL_VAL_ {} {} {} {}-{};\n", message.can_id, signal.name, selector->name,
                                signal.only_if->min, signal.only_if->max);
        }
    }
    return text;
}

std::string comments_text(const BusMessage& message) {
    std::string text;
    for (const Signal& signal : signals_of(message.spec->type)) {
        if (!signal.meaning.empty()) {
            text += fmt::format("CM_ SG_ {} {} \"{}\";\n", message.can_id, signal.name, signal.meaning);
        }
    }
    return text;
}

std::string value_tables_text(const BusMessage& message) {
    std::string text;
    for (const Signal& signal : signals_of(message.spec->type)) {
        if (signal.values.empty()) {
            continue;
        }
        text += fmt::format("VAL_ {} {}", message.can_id, signal.name);
        for (const auto& [value, name] : signal.values) {
            text += fmt::format(" {} \"{}\"", value, name);
        }
        text += " ;\n";
    }
    return text;
}

constexpr std::string_view kHead =
    "VERSION \"1\"\n\n"
    "NS_ :\n\n"
    "BS_:\n\n";

constexpr std::string_view kComment =
    "CM_ \"octoskin, protocol version 1; made by write_dbc from common/wire/layout.hpp, explained in "
    "docs/protocol.md. "
    "Take the bytes beyond the end of a RANGE_FD frame of less than 64 bytes as zero.\";\n";

// Attribute names and numbers used by CAN tools: 0 is a classical frame, 14 a CAN FD frame.
constexpr std::string_view kAttributes =
    "BA_DEF_ \"BusType\" STRING ;\n"
    "BA_DEF_ BO_ \"VFrameFormat\" ENUM "
    "\"StandardCAN\",\"ExtendedCAN\",\"reserved\",\"reserved\",\"reserved\",\"reserved\","
    "\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\",\"reserved\","
    "\"StandardCAN_FD\",\"ExtendedCAN_FD\";\n"
    "BA_DEF_ BO_ \"CANFD_BRS\" ENUM \"0\",\"1\";\n"
    "BA_DEF_DEF_ \"BusType\" \"CAN FD\";\n"
    "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n"
    "BA_DEF_DEF_ \"CANFD_BRS\" \"0\";\n"
    "BA_ \"BusType\" \"CAN FD\";\n";

std::string format_text(const BusMessage& message) {
    if (!message.spec->is_fd) {
        return "";
    }
    return fmt::format("BA_ \"VFrameFormat\" BO_ {0} 14;\nBA_ \"CANFD_BRS\" BO_ {0} 1;\n", message.can_id);
}

}  // namespace

bool is_sent_by(NodeKind kind, wire::FrameType type) noexcept {
    switch (type) {
        case FrameType::joint_state:
            return kind == NodeKind::joint_source;
        case FrameType::range:
        case FrameType::range_fd:
        case FrameType::range_aux:
        case FrameType::sensor_health:
        case FrameType::reflex:
        case FrameType::calibration:
        case FrameType::black_box:
            return kind == NodeKind::sensor_board;
        case FrameType::heartbeat:
        case FrameType::sync_report:
        case FrameType::node_info:
            return true;
        case FrameType::sync:
        case FrameType::follow_up:
        case FrameType::command:
        case FrameType::mark:
            return false;
    }
    return false;
}

std::vector<Node> shipped_nodes() {
    return {{1, NodeKind::sensor_board, "SensorBoard1"},
            {2, NodeKind::sensor_board, "SensorBoard2"},
            {3, NodeKind::joint_source, "JointSource"}};
}

std::optional<Node> node_from_text(std::string_view text) {
    unsigned id = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
    const std::string_view kind(end, static_cast<std::size_t>(text.data() + text.size() - end));
    if (error != std::errc{} || id < 1 || id >= wire::kBroadcastId) {
        return std::nullopt;
    }
    const auto node_id = static_cast<wire::NodeId>(id);
    if (kind == ":board") {
        return Node{node_id, NodeKind::sensor_board, fmt::format("Board{}", id)};
    }
    if (kind == ":joints") {
        return Node{node_id, NodeKind::joint_source, fmt::format("Joints{}", id)};
    }
    return std::nullopt;
}

std::string dbc_text(const std::vector<Node>& nodes) {
    const std::vector<BusMessage> messages = all_messages(nodes);
    std::string text(kHead);
    text += fmt::format("BU_: {}", kHostName);
    for (const Node& node : nodes) {
        text += fmt::format(" {}", node.name);
    }
    text += "\n\n";
    for (const BusMessage& message : messages) {
        text += message_text(message);
    }
    text += kComment;
    for (const BusMessage& message : messages) {
        text += comments_text(message);
    }
    text += kAttributes;
    for (const BusMessage& message : messages) {
        text += format_text(message);
    }
    for (const BusMessage& message : messages) {
        text += value_tables_text(message);
    }
    for (const BusMessage& message : messages) {
        text += ranges_text(message);
    }
    return text;
}

}  // namespace octoskin::dbc
