#include "hw/dbc/signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <concepts>
#include <iterator>
#include <string_view>

#include "common/range_status.hpp"
#include "common/wire/names.hpp"
#include "hw/dbc/field_meanings.hpp"

namespace octoskin::dbc {
namespace {

using namespace wire;

/// Visits the fields of a message and lists them as signals: see common/wire/layout.hpp.
class SignalLister {
  public:
    static constexpr bool kFillsIn = false;

    explicit SignalLister(std::vector<Signal>& signals) : signals_(signals) {}

    template <std::integral T>
    void number(const Field& field, const T&) {
        add(field).is_signed = std::signed_integral<T>;
    }
    template <class T>
    void saturated(const Field& field, const T&) {
        add(field);
    }
    void rounded_up(const Field& field, std::uint16_t) { add(field); }
    void residue(const Field& field, const TimeResidue&) { add(field); }
    void flag(const Field& field, bool) { add(field); }
    template <class T>
    void bytes(const Field& field, const T&) {
        add(field);
    }
    template <class E>
    void choice(const Field& field, const E&) {
        add(field, named_values<E>());
    }
    void selector(const Field& field, const std::uint8_t& value) {
        add(field, std::string_view(field.name) == "page" ? named_values<InfoPage>() : Names{}).is_selector =
            true;
        only_if_ = {.min = value, .max = value};
    }
    void zeros(unsigned bits) { position_ += bits; }
    [[nodiscard]] std::uint8_t entries_present(std::uint8_t count) const { return count; }

  private:
    using Names = std::vector<std::pair<unsigned, std::string>>;

    template <class E>
    static Names named_values() {
        Names names;
        for (const auto& [value, text] : values_of(E{})) {
            names.emplace_back(static_cast<unsigned>(value), text);
        }
        return names;
    }

    Signal& add(const Field& field, Names names = {}) {
        const std::string name = field.index ? fmt::format("{}_{}", field.name, *field.index) : field.name;
        signals_.push_back({.name = name,
                            .field = field.name,
                            .index = field.index,
                            .start = position_,
                            .bits = field.bits,
                            .unit = field.unit,
                            .min = field.min,
                            .max = field.max,
                            .only_if = only_if_,
                            .values = names.empty() ? names_of_numbers(field.name) : std::move(names)});
        position_ += field.bits;
        return signals_.back();
    }

    /// Names for numeric fields, some or all of whose values have one.
    static Names names_of_numbers(std::string_view field) {
        Names names;
        if (field == "zone") {
            names.emplace_back(kZoneUnknown, "unknown");
        } else if (field == "device_status") {
            for (std::uint8_t code = 0; code < kDeviceStatusesDefined; ++code) {
                names.emplace_back(code, range_status(code).text);
            }
        }
        return names;
    }

    std::vector<Signal>& signals_;
    unsigned position_ = kVersionBits;
    std::optional<Signal::SelectorRange> only_if_;
};

template <class T>
void list(std::vector<Signal>& signals, const T& message) {
    SignalLister lister(signals);
    walk(lister, message);
}

bool are_in_one_place(const Signal& a, const Signal& b) {
    return a.name == b.name && a.start == b.start && a.bits == b.bits;
}

void widen(Signal& signal, const Signal& other) {
    signal.min = std::min(signal.min, other.min);
    signal.max = std::max(signal.max, other.max);
    if (signal.only_if) {
        signal.only_if->min = std::min(signal.only_if->min, other.only_if->min);
        signal.only_if->max = std::max(signal.only_if->max, other.only_if->max);
    }
}

/// Merges the signals of `layouts` alternative layouts. A signal that several layouts have in the same place
/// becomes one; a signal of all layouts no longer depends on the selector. Layouts that share a field must
/// have consecutive selector values, so that one range identifies them.
std::vector<Signal> merge_alternatives(const std::vector<Signal>& all, std::ptrdiff_t layouts) {
    std::vector<Signal> merged;
    for (const Signal& signal : all) {
        const auto is_same = [&signal](const Signal& other) { return are_in_one_place(signal, other); };
        const auto known = std::ranges::find_if(merged, is_same);
        if (known != merged.end()) {
            widen(*known, signal);
            continue;
        }
        merged.push_back(signal);
        if (std::ranges::count_if(all, is_same) == layouts) {
            merged.back().only_if.reset();
        }
    }
    return merged;
}

std::vector<Signal> joint_state_signals() {
    std::vector<Signal> signals;
    for (std::uint8_t index = 0; index < kJointIndexLast; ++index) {
        list(signals, JointPair{.index = index});
    }
    list(signals, JointLast{});
    return merge_alternatives(signals, kJointIndexLast + 1);
}

std::vector<Signal> node_info_signals() {
    std::vector<Signal> signals;
    list(signals, InfoUidLow{});
    list(signals, InfoUidHigh{});
    list(signals, InfoIdentity{});
    list(signals, InfoBuild{});
    list(signals, InfoCounters{});
    list(signals, InfoTraffic{});
    list(signals, InfoFault{});
    return merge_alternatives(signals, kInfoPages);
}

std::vector<Signal> range_fd_signals() {
    std::vector<Signal> signals;
    for (std::uint8_t count = 1; count <= kReadingsPerFdFrame; ++count) {
        list(signals, RangeFd{.count = count});
    }
    return merge_alternatives(signals, kReadingsPerFdFrame);
}

std::vector<Signal> fields_of(FrameType type) {
    std::vector<Signal> signals;
    switch (type) {
        case FrameType::sync:
            list(signals, Sync{});
            break;
        case FrameType::follow_up:
            list(signals, FollowUp{});
            break;
        case FrameType::command:
            list(signals, Command{});
            signals[1].values = {{kAllSensors, "all"}};
            break;
        case FrameType::mark:
            list(signals, Mark{});
            break;
        case FrameType::heartbeat:
            list(signals, Heartbeat{});
            break;
        case FrameType::joint_state:
            return joint_state_signals();
        case FrameType::sync_report:
            list(signals, SyncReport{});
            break;
        case FrameType::range:
            list(signals, Range{});
            break;
        case FrameType::range_fd:
            return range_fd_signals();
        case FrameType::sensor_health:
            list(signals, SensorHealth{});
            break;
        case FrameType::node_info:
            return node_info_signals();
        case FrameType::range_aux:
            list(signals, RangeAux{});
            break;
        case FrameType::reflex:
            list(signals, Reflex{});
            break;
        case FrameType::calibration:
            list(signals, Calibration{});
            break;
        case FrameType::black_box:
            list(signals, BlackBox{});
            break;
    }
    return signals;
}

Signal checksum_signal(Checksum kind, unsigned payload_len, const std::string& name) {
    const auto bytes = static_cast<unsigned>(kind);
    return {.name = name,
            .start = 8 * (payload_len - bytes),
            .bits = 8 * bytes,
            .is_high_byte_first = kind == Checksum::crc16,
            .max = max_of_bits(8 * bytes)};
}

void add_range_fd_checksums(std::vector<Signal>& signals) {
    for (std::uint8_t readings = 1; readings <= kReadingsPerFdFrame; ++readings) {
        const std::string name = fmt::format("crc_of_{}", readings);
        signals.push_back(checksum_signal(Checksum::crc16, range_fd_length(readings), name));
        signals.back().only_if = {.min = readings, .max = readings};
    }
}

}  // namespace

std::vector<Signal> signals_of(FrameType type) {
    const FrameSpec* spec = frame_spec(type);
    assert(spec != nullptr);
    std::vector<Signal> signals = {
        {.name = "version", .start = 0, .bits = kVersionBits, .max = max_of_bits(kVersionBits)}};
    std::ranges::move(fields_of(type), std::back_inserter(signals));
    if (type == FrameType::range_fd) {
        add_range_fd_checksums(signals);
    } else {
        signals.push_back(checksum_signal(spec->checksum, spec->payload_len, "crc"));
    }
    for (Signal& signal : signals) {
        signal.meaning = meaning_of(type, signal.field);
    }
    return signals;
}

}  // namespace octoskin::dbc
