#include "tests/system/reference/protocol_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/range_status.hpp"
#include "common/wire/black_box.hpp"
#include "common/wire/bus_load.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/frame_type.hpp"
#include "host/core/counters/counter_meanings.hpp"
#include "hw/dbc/dbc_text.hpp"
#include "hw/dbc/field_meanings.hpp"
#include "hw/dbc/signals.hpp"

namespace octoskin {
namespace {

using dbc::NodeKind;
using dbc::Signal;
using wire::FrameSpec;
using wire::FrameType;
using wire::Party;
using wire::Unit;

void add(Tables& to, Tables from) {
    to.merge(from);
}

std::string_view node_text(Party party) {
    switch (party) {
        case Party::from_host:
            return "0, the host";
        case Party::from_node:
            return "1..62, the sender";
        case Party::to_node:
            return "1..62, the receiver; 63 for all";
    }
    return "";
}

std::string identifiers_text(const FrameSpec& spec) {
    const auto is_allowed = [&spec](unsigned id) {
        return wire::is_allowed(spec.party, static_cast<wire::NodeId>(id));
    };
    unsigned first = 0;
    while (!is_allowed(first)) ++first;
    unsigned last = wire::kBroadcastId;
    while (!is_allowed(last)) --last;
    const std::string from =
        fmt::format("0x{:03X}", wire::can_id(spec.type, static_cast<wire::NodeId>(first)));
    const std::uint32_t to = wire::can_id(spec.type, static_cast<wire::NodeId>(last));
    return first == last ? from : fmt::format("{}-0x{:03X}", from, to);
}

std::string bytes_text(const FrameSpec& spec) {
    if (spec.type != FrameType::range_fd) return fmt::format("{}", spec.payload_len);
    std::string text;
    for (std::uint8_t readings = 1; readings <= wire::kReadingsPerFdFrame; ++readings)
        text += fmt::format("{}{}", text.empty() ? "" : ", ", wire::range_fd_length(readings));
    return text;
}

Tables type_tables() {
    Tables tables;
    for (const FrameSpec& spec : wire::kFrameSpecs)
        add_row(tables, "message types",
                "| Type | Identifier | Message | Node id | Format | Bytes | Checksum |\n"
                "|---|---|---|---|---|---|---|",
                fmt::format("| {} | {} | {} | {} | {} | {} | {} |", static_cast<unsigned>(spec.type),
                            identifiers_text(spec), spec.name, node_text(spec.party),
                            spec.is_fd ? "CAN FD" : "classical", bytes_text(spec),
                            spec.checksum == wire::Checksum::crc8 ? "CRC-8" : "CRC-16"));
    return tables;
}

std::string_view sender_text(FrameType type) {
    const bool is_of_board = is_sent_by(NodeKind::sensor_board, type);
    const bool is_of_joints = is_sent_by(NodeKind::joint_source, type);
    if (is_of_board && is_of_joints) return "sensor board, joint source";
    if (is_of_board) return "sensor board";
    return is_of_joints ? "joint source" : "host";
}

Tables sender_tables() {
    Tables tables;
    for (const dbc::SendingTime& time : dbc::sending_times())
        add_row(tables, "senders", "| Message | Sender | When |\n|---|---|---|",
                fmt::format("| {} | {} | {} |", wire::frame_spec(time.type)->name, sender_text(time.type),
                            cell(time.text)));
    return tables;
}

/// The meaning of each refusal is that of its counter.
Tables refusal_tables() {
    Tables tables;
    for (std::size_t i = 0; i < wire::kDecodeErrors; ++i) {
        const std::string_view name = wire::name(static_cast<wire::DecodeError>(i));
        const CounterMeaning* counter = find_counter("CAN frames", name);
        add_row(tables, "refusals of frames", "| Name | Refused because |\n|---|---|",
                fmt::format("| `{}` | {} |", name, counter == nullptr ? "" : cell(counter->text)));
    }
    return tables;
}

std::string_view unit_text(Unit unit) {
    switch (unit) {
        case Unit::none:
            return "";
        case Unit::millimetre:
            return "mm";
        case Unit::quarter_millimetre:
            return "1/4 mm";
        case Unit::microsecond:
            return "us";
        case Unit::step_of_64_us:
            return "64 us";
        case Unit::second:
            return "s";
        case Unit::mcps_by_128:
            return "1/128 Mcps";
        case Unit::microradian:
            return "urad";
        case Unit::permille:
            return "1/1000";
        case Unit::kcps_by_512:
            return "1/512 kcps";
    }
    return "";
}

const dbc::ValueMeaning* find_value(FrameType type, std::string_view field, std::string_view value) {
    const auto all = dbc::value_meanings();
    const auto found = std::ranges::find_if(all, [=](const dbc::ValueMeaning& meaning) {
        return meaning.type == type && meaning.field == field && meaning.value == value;
    });
    return found == all.end() ? nullptr : &*found;
}

/// True if the values of the field have meanings, and so a table. Values without meanings are in the row of
/// the field. All messages share the table of device statuses.
bool has_value_table(FrameType type, const Signal& signal) {
    return std::ranges::any_of(signal.values, [&](const auto& value) {
        return find_value(type, signal.field, value.second) != nullptr;
    });
}

Tables value_tables(const FrameSpec& spec, const Signal& signal) {
    Tables tables;
    const std::string_view detail = dbc::detail_field(spec.type, signal.field);
    const std::string head =
        detail.empty() ? "| Value | Name | Meaning |\n|---|---|---|"
                       : fmt::format("| Value | Name | Meaning | `{}` |\n|---|---|---|---|", detail);
    for (const auto& [value, name] : signal.values) {
        const dbc::ValueMeaning* meaning = find_value(spec.type, signal.field, name);
        std::string row =
            fmt::format("| {} | `{}` | {} |", value, name, meaning == nullptr ? "" : cell(meaning->text));
        if (!detail.empty()) row += fmt::format(" {} |", meaning == nullptr ? "" : cell(meaning->detail));
        add_row(tables, fmt::format("values of {} {}", spec.name, signal.field), head, row);
    }
    return tables;
}

std::string meaning_text(FrameType type, const Signal& signal) {
    std::string text(signal.meaning);
    const bool is_limited = signal.min != 0 || signal.max != wire::max_of_bits(signal.bits);
    if (is_limited) text += fmt::format("; {}..{}", signal.min, signal.max);
    if (signal.is_signed) text += "; signed";
    if (signal.field == "device_status") return cell(text) + " ([table](#device-status))";
    if (has_value_table(type, signal)) return cell(text) + "; table below";
    std::string values;
    for (const auto& [value, name] : signal.values)
        values += fmt::format("{}{} `{}`", values.empty() ? "" : ", ", value, name);
    return values.empty() ? cell(text) : fmt::format("{} ({})", cell(text), values);
}

std::string bits_text(FrameType type, const Signal& signal) {
    const unsigned last = signal.start + signal.bits - 1;
    std::string text = signal.bits == 1 ? fmt::format("{}", last) : fmt::format("{}..{}", signal.start, last);
    if (type == FrameType::range_fd && signal.index)
        text += fmt::format(" + {} *i*", wire::kRangeFdEntryBits);
    return text;
}

std::string field_text(FrameType type, const Signal& signal) {
    return type == FrameType::range_fd && signal.index ? fmt::format("`{}` *i*", signal.field)
                                                       : fmt::format("`{}`", signal.name);
}

/// "page 2" or "index 0..2"; empty for a field of all layouts.
std::string condition_text(const Signal& signal, std::string_view selector) {
    if (!signal.only_if) return "";
    const auto [min, max] = *signal.only_if;
    return min == max ? fmt::format("{} {}", selector, min) : fmt::format("{} {}..{}", selector, min, max);
}

/// The rows of a message's table: the readings of RANGE_FD are alike, so only its first one has rows.
std::vector<Signal> fields_of(FrameType type) {
    std::vector<Signal> fields = dbc::signals_of(type);
    std::erase_if(fields, [type](const Signal& signal) {
        return signal.field.empty() || (type == FrameType::range_fd && signal.index.value_or(0) > 0);
    });
    return fields;
}

Tables message_tables(const FrameSpec& spec) {
    Tables tables;
    const std::vector<Signal> fields = fields_of(spec.type);
    const bool has_units = std::ranges::any_of(fields, [](auto& s) { return s.unit != Unit::none; });
    const bool has_layouts = std::ranges::any_of(fields, [](auto& s) { return s.only_if.has_value(); });
    const std::string head =
        fmt::format("|{} Bits | Field |{} Meaning |\n|{}---|---|{}---|", has_layouts ? " Only if |" : "",
                    has_units ? " Unit |" : "", has_layouts ? "---|" : "", has_units ? "---|" : "");
    const auto selector = std::ranges::find(fields, true, &Signal::is_selector);
    for (const Signal& field : fields) {
        std::string row = "|";
        if (has_layouts) row += fmt::format(" {} |", condition_text(field, selector->field));
        row += fmt::format(" {} | {} |", bits_text(spec.type, field), field_text(spec.type, field));
        if (has_units) row += fmt::format(" {} |", unit_text(field.unit));
        row += fmt::format(" {} |", meaning_text(spec.type, field));
        add_row(tables, fmt::format("message {}", spec.name), head, row);
        if (has_value_table(spec.type, field)) add(tables, value_tables(spec, field));
    }
    return tables;
}

std::string_view use_text(RangeUse use) {
    switch (use) {
        case RangeUse::hit:
            return "a hit, and free space before it";
        case RangeUse::no_return:
            return "no hit; may clear space up to a configured distance";
        case RangeUse::nothing:
            return "none";
    }
    return "";
}

Tables device_status_tables() {
    Tables tables;
    for (std::uint8_t code = 0; code < kDeviceStatusesDefined; ++code) {
        const RangeStatusEntry& entry = range_status(code);
        const std::string user =
            entry.status == RangeStatus::none ? "" : fmt::format("{}", static_cast<unsigned>(entry.status));
        add_row(tables, "device status", "| Code | ST's user status | Meaning | Use |\n|---|---|---|---|",
                fmt::format("| {} | {} | {} | {} |", code, user, entry.text, use_text(entry.use)));
    }
    return tables;
}

Tables transfer_tables() {
    Tables tables;
    for (std::uint8_t i = 0; i < wire::kTransferOutcomes; ++i)
        add_row(tables, "outcomes of transfers", "| Value | Outcome |\n|---|---|",
                fmt::format("| {} | `{}` |", i, wire::name(static_cast<wire::TransferOutcome>(i))));
    return tables;
}

/// 34 sensors on two boards, joints at 100 Hz from a third node.
double load_percent(double readings_hz, double aux_share, std::uint8_t per_fd_frame,
                    const wire::BitRates& rates) {
    constexpr std::uint32_t kSensors = 34;
    const bool is_fd = per_fd_frame > 0;
    const auto traffic = wire::traffic_of({.nodes = 3,
                                           .sensors = kSensors,
                                           .readings_per_s = kSensors * readings_hz,
                                           .aux_per_s = kSensors * readings_hz * aux_share,
                                           .joint_samples_per_s = 100,
                                           .uses_can_fd = is_fd,
                                           .readings_per_fd_frame = is_fd ? per_fd_frame : std::uint8_t{1}});
    return 100 * wire::bus_load(traffic, rates);
}

Tables load_tables() {
    struct Case {
        std::string_view name;
        double aux_share = 0;
        std::uint8_t per_fd_frame = 0;  ///< 0: classical
        wire::BitRates rates;
    };
    constexpr wire::BitRates kSlow{.nominal = 500'000, .data = 2'000'000};
    constexpr wire::BitRates kFast{.nominal = 1'000'000, .data = 5'000'000};
    const auto cases = std::to_array<Case>({
        {"classical, 500 kbit/s", 0, 0, kSlow},
        {"the same with RANGE_AUX for every 10th reading", 0.1, 0, kSlow},
        {"the same with RANGE_AUX for every reading", 1, 0, kSlow},
        {"classical, 1 Mbit/s", 0, 0, kFast},
        {"CAN FD, 500 kbit/s and 2 Mbit/s, one reading a frame", 0, 1, kSlow},
        {"the same, four readings a frame", 0, 4, kSlow},
        {"CAN FD, 1 and 5 Mbit/s, one reading a frame", 0, 1, kFast},
        {"the same, four readings a frame", 0, 4, kFast},
    });
    Tables tables;
    for (const auto& [name, aux_share, per_fd_frame, rates] : cases)
        add_row(tables, "bus load", "| Bus | Readings at 30 Hz | At 50 Hz |\n|---|---|---|",
                fmt::format("| {} | {:.1f} % | {:.1f} % |", name,
                            load_percent(30, aux_share, per_fd_frame, rates),
                            load_percent(50, aux_share, per_fd_frame, rates)));
    return tables;
}

}  // namespace

Tables protocol_tables() {
    Tables tables = type_tables();
    add(tables, sender_tables());
    add(tables, refusal_tables());
    for (const FrameSpec& spec : wire::kFrameSpecs) add(tables, message_tables(spec));
    add(tables, device_status_tables());
    add(tables, transfer_tables());
    add(tables, load_tables());
    return tables;
}

}  // namespace octoskin
