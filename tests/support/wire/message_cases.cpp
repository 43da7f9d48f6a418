#include "tests/support/wire/message_cases.hpp"

#include <type_traits>
#include <utility>
#include <variant>

namespace octoskin::test {
namespace {

using namespace wire;

template <class T, class Variant>
constexpr bool kIsAlternative = false;
template <class T, class... Ts>
constexpr bool kIsAlternative<T, std::variant<Ts...>> = (std::is_same_v<T, Ts> || ...);

template <class T>
T& as(Message& message) {
    if constexpr (kIsAlternative<T, NodeInfo>) {
        return std::get<T>(std::get<NodeInfo>(message));
    } else if constexpr (kIsAlternative<T, JointState>) {
        return std::get<T>(std::get<JointState>(message));
    } else {
        return std::get<T>(message);
    }
}

/// A field that is a member of T, or of a member of T, and carries its raw value unchanged.
template <class T, class M>
FieldCase plain(const char* name, unsigned start, unsigned bits, M T::*member) {
    return {name, start, bits,
            [member](Message& m, std::uint64_t raw) { as<T>(m).*member = static_cast<M>(raw); }};
}
template <class T>
FieldCase field(const char* name, unsigned start, unsigned bits, void (*set)(T&, std::uint64_t)) {
    return {name, start, bits, [set](Message& m, std::uint64_t raw) { set(as<T>(m), raw); }};
}
FieldCase valid_if(bool (*is_valid)(std::uint64_t), FieldCase field) {
    field.is_valid = is_valid;
    return field;
}
FieldCase valid_below(std::uint64_t limit, FieldCase field) {
    field.is_valid = [limit](std::uint64_t raw) { return raw < limit; };
    return field;
}
template <class T>
FieldCase uid(const char* name) {
    return field<T>(name, 8, 48, [](T& info, std::uint64_t raw) {
        for (std::uint8_t& byte : info.uid) {
            byte = static_cast<std::uint8_t>(raw & 0xFFU);
            raw >>= 8U;
        }
    });
}
std::int32_t sign_extended_24(std::uint64_t raw) {
    return static_cast<std::int32_t>(raw) - (raw >= (1U << 23U) ? (1 << 24) : 0);
}

MessageCase range_case() {
    const RangeReading reading{.sensor = 33,
                               .zone = 5,
                               .device_status = 9,
                               .sequence = 42,
                               .range_mm = 1234,
                               .sigma_quarter_mm = 4 * 21,
                               .capture = {.value_us = 64 * 2741, .span_us = 262'144}};
    return {
        "RANGE",
        Range{reading},
        2,
        0x202,
        false,
        8,
        1,
        {valid_below(63, field<Range>("sensor", 3, 6,
                                      [](Range& r, std::uint64_t raw) {
                                          r.reading.sensor = static_cast<std::uint8_t>(raw);
                                      })),
         field<Range>("zone", 9, 4,
                      [](Range& r, std::uint64_t raw) { r.reading.zone = static_cast<std::uint8_t>(raw); }),
         field<Range>(
             "device_status", 13, 5,
             [](Range& r, std::uint64_t raw) { r.reading.device_status = static_cast<std::uint8_t>(raw); }),
         field<Range>(
             "range", 18, 13,
             [](Range& r, std::uint64_t raw) { r.reading.range_mm = static_cast<std::uint16_t>(raw); }),
         field<Range>("sigma", 31, 7,
                      [](Range& r, std::uint64_t raw) {
                          r.reading.sigma_quarter_mm = static_cast<std::uint16_t>(4 * raw);
                      }),
         field<Range>("capture_time", 38, 12,
                      [](Range& r, std::uint64_t raw) {
                          r.reading.capture = {static_cast<std::uint32_t>(64 * raw), 262'144};
                      }),
         field<Range>(
             "sequence", 50, 6,
             [](Range& r, std::uint64_t raw) { r.reading.sequence = static_cast<std::uint8_t>(raw); })},
        {},
        {}};
}

MessageCase aux_case() {
    return {"RANGE_AUX",
            RangeAux{33, 42, {.peak_signal = 2048, .ambient = 16}},
            2,
            0x302,
            false,
            8,
            2,
            {valid_below(63, plain("sensor", 3, 6, &RangeAux::sensor)),
             plain("sequence", 9, 6, &RangeAux::sequence),
             field<RangeAux>("peak_signal", 15, 16,
                             [](RangeAux& a, std::uint64_t raw) {
                                 a.signal.peak_signal = static_cast<std::uint16_t>(raw);
                             }),
             field<RangeAux>(
                 "ambient", 31, 16,
                 [](RangeAux& a, std::uint64_t raw) { a.signal.ambient = static_cast<std::uint16_t>(raw); })},
            {},
            {{47, 1}}};
}

template <class T>
FieldCase entry_field(const char* name, unsigned i, unsigned offset, unsigned bits, T RangeReading::*member) {
    return {name + std::to_string(i), 8 + 112 * i + offset, bits, [i, member](Message& m, std::uint64_t raw) {
                as<RangeFd>(m).entries[i].reading.*member = static_cast<T>(raw);
            }};
}
FieldCase entry_signal(const char* name, unsigned i, unsigned offset, std::uint16_t SignalReading::*member) {
    return {name + std::to_string(i), 8 + 112 * i + offset, 16, [i, member](Message& m, std::uint64_t raw) {
                as<RangeFd>(m).entries[i].signal.*member = static_cast<std::uint16_t>(raw);
            }};
}

MessageCase range_fd_case(std::uint8_t readings) {
    constexpr unsigned kLengths[] = {20, 32, 48, 64};
    const unsigned length = kLengths[readings - 1];
    RangeFd frame{.count = readings};
    MessageCase result{
        "RANGE_FD of " + std::to_string(readings), {}, 1, 0x241, true, length, 2, {}, {{3, 3}}, {{6, 2}}};
    for (std::uint8_t i = 0; i < readings; ++i) {
        frame.entries[i] = {
            .reading = {.sensor = static_cast<std::uint8_t>(16 - i),
                        .zone = static_cast<std::uint8_t>(i + 1),
                        .device_status = 9,
                        .sequence = static_cast<std::uint8_t>(60 + i),
                        .range_mm = static_cast<std::uint16_t>(1234 + 1000 * i),
                        .sigma_quarter_mm = static_cast<std::uint16_t>(81 + i),
                        .capture = {.value_us = 0x123456U + 33'001U * i, .span_us = 16'777'216}},
            .signal = {.peak_signal = static_cast<std::uint16_t>(2047 + i), .ambient = 17}};
        result.fields.push_back(valid_below(63, entry_field("sensor", i, 0, 6, &RangeReading::sensor)));
        result.fields.push_back(entry_field("zone", i, 6, 4, &RangeReading::zone));
        result.fields.push_back(entry_field("device_status", i, 10, 5, &RangeReading::device_status));
        result.fields.push_back(entry_field("sequence", i, 15, 6, &RangeReading::sequence));
        result.fields.push_back(entry_field("range", i, 21, 16, &RangeReading::range_mm));
        result.fields.push_back(entry_field("sigma", i, 37, 16, &RangeReading::sigma_quarter_mm));
        result.fields.push_back(entry_signal("peak_signal", i, 53, &SignalReading::peak_signal));
        result.fields.push_back(entry_signal("ambient", i, 69, &SignalReading::ambient));
        result.fields.push_back(
            {"capture_time" + std::to_string(i), 8 + 112U * i + 85, 24, [i](Message& m, std::uint64_t raw) {
                 as<RangeFd>(m).entries[i].reading.capture = {static_cast<std::uint32_t>(raw), 16'777'216};
             }});
        result.padding.push_back({8 + 112U * i + 109, 3});
    }
    const unsigned used = 8 + 112U * readings;
    result.padding.push_back({used, 8 * (length - 2) - used});
    result.message = frame;
    return result;
}

MessageCase reflex_case() {
    const Reflex reflex{
        .sensor = 33, .zone = 5, .range_mm = 1234, .capture = {2741 * 64, 262'144}, .sequence = 42};
    return {"REFLEX",
            reflex,
            2,
            0x002,
            false,
            8,
            2,
            {valid_below(63, plain("sensor", 3, 6, &Reflex::sensor)), plain("zone", 9, 4, &Reflex::zone),
             plain("range", 13, 13, &Reflex::range_mm),
             field<Reflex>("capture_time", 26, 12,
                           [](Reflex& r, std::uint64_t raw) {
                               r.capture = {static_cast<std::uint32_t>(raw * 64), 262'144};
                           }),
             plain("sequence", 38, 6, &Reflex::sequence)},
            {},
            {{44, 4}}};
}

MessageCase black_box_case() {
    const BlackBox piece{.bus = 2, .dump = 1, .index = 300, .bytes = {1, 2, 3, 4, 5}};
    return {"BLACK_BOX",
            piece,
            2,
            0x7C2,
            false,
            8,
            1,
            {plain("bus", 3, 2, &BlackBox::bus), plain("dump", 5, 2, &BlackBox::dump),
             plain("index", 7, 9, &BlackBox::index),
             field<BlackBox>("bytes", 16, 40,
                             [](BlackBox& box, std::uint64_t raw) {
                                 for (std::uint8_t& byte : box.bytes) {
                                     byte = static_cast<std::uint8_t>(raw & 0xFFU);
                                     raw >>= 8U;
                                 }
                             })},
            {},
            {}};
}

MessageCase calibration_case() {
    const Calibration calibration{.sensor = 33,
                                  .quantity = CalibrationQuantity::crosstalk,
                                  .outcome = CalibrationOutcome::no_target,
                                  .sequence = 129,
                                  .offset_quarter_mm = -1234,
                                  .crosstalk_raw = 0x8421};
    return {"CALIBRATION",
            calibration,
            2,
            0x342,
            false,
            8,
            1,
            {valid_below(63, plain("sensor", 3, 6, &Calibration::sensor)),
             plain("quantity", 9, 1, &Calibration::quantity),
             valid_below(8, plain("outcome", 10, 4, &Calibration::outcome)),
             plain("sequence", 16, 8, &Calibration::sequence),
             field<Calibration>("offset", 24, 16,
                                [](Calibration& c, std::uint64_t raw) {
                                    const auto value = static_cast<int>(raw);
                                    c.offset_quarter_mm =
                                        static_cast<std::int16_t>(raw < 0x8000U ? value : value - 0x1'0000);
                                }),
             plain("crosstalk", 40, 16, &Calibration::crosstalk_raw)},
            {},
            {{14, 2}}};
}

MessageCase heartbeat_case() {
    const Heartbeat beat{.state = NodeState::safe,
                         .reset_cause = ResetCause::watchdog,
                         .is_rate_overridden = true,
                         .is_time_suspect = false,
                         .degraded_sensors = 17,
                         .uid_crc = 0xBEEF,
                         .node_hash_low = 0x1234};
    FieldCase reset_cause = plain("reset_cause", 6, 3, &Heartbeat::reset_cause);
    reset_cause.is_valid = [](std::uint64_t raw) { return raw != 6; };
    return {"HEARTBEAT",
            beat,
            62,
            0x17E,
            false,
            8,
            2,
            {valid_below(8, plain("state", 3, 3, &Heartbeat::state)), reset_cause,
             plain("is_rate_overridden", 9, 1, &Heartbeat::is_rate_overridden),
             plain("is_time_suspect", 10, 1, &Heartbeat::is_time_suspect),
             plain("degraded_sensors", 11, 5, &Heartbeat::degraded_sensors),
             plain("uid_crc", 16, 16, &Heartbeat::uid_crc),
             plain("node_hash_low", 32, 16, &Heartbeat::node_hash_low)},
            {},
            {}};
}

MessageCase info_case(const char* name, NodeInfo info, std::vector<FieldCase> fields) {
    return {name, info, 7, 0x2C7, false, 8, 1, std::move(fields), {{3, 3}}, {{6, 2}}};
}

void add_info_cases(std::vector<MessageCase>& cases) {
    cases.push_back(
        info_case("NODE_INFO uid_low", InfoUidLow{{1, 2, 3, 4, 5, 250}}, {uid<InfoUidLow>("uid_low")}));
    cases.push_back(
        info_case("NODE_INFO uid_high", InfoUidHigh{{7, 8, 9, 10, 11, 251}}, {uid<InfoUidHigh>("uid_high")}));
    cases.push_back(info_case("NODE_INFO identity", InfoIdentity{0xDEADBEEF, 17, 3},
                              {plain("node_hash", 8, 32, &InfoIdentity::node_hash),
                               plain("sensor_count", 40, 8, &InfoIdentity::sensor_count),
                               plain("board_type", 48, 8, &InfoIdentity::board_type)}));
    cases.push_back(info_case(
        "NODE_INFO build", InfoBuild{0xCAFEF00D, 54'321},
        {plain("build_id", 8, 32, &InfoBuild::build_id), plain("uptime", 40, 16, &InfoBuild::uptime_s)}));
    cases.push_back(info_case("NODE_INFO counters", InfoCounters{301, 302, 303},
                              {plain("i2c_errors", 8, 16, &InfoCounters::i2c_errors),
                               plain("reads_disagreed", 24, 16, &InfoCounters::reads_disagreed),
                               plain("sensor_restarts", 40, 16, &InfoCounters::sensor_restarts)}));
    cases.push_back(info_case("NODE_INFO traffic", InfoTraffic{401, 402, 43, 44},
                              {plain("tx_dropped", 8, 16, &InfoTraffic::tx_dropped),
                               plain("late_dropped", 24, 16, &InfoTraffic::late_dropped),
                               plain("bus_off_count", 40, 8, &InfoTraffic::bus_off_count),
                               plain("rx_rejected", 48, 8, &InfoTraffic::rx_rejected)}));
    cases.push_back(info_case(
        "NODE_INFO fault", InfoFault{FaultKind::hard_fault, 6, 0x0800'1234, 77},
        {valid_if([](std::uint64_t raw) { return raw <= 13 || raw == 15; },
                  plain("fault_kind", 8, 4, &InfoFault::kind)),
         plain("fault_count", 12, 4, &InfoFault::count), plain("fault_where", 16, 32, &InfoFault::where),
         plain("fault_uptime", 48, 8, &InfoFault::uptime_s)}));
}

MessageCase health_case() {
    const SensorHealth health{.sensor = 16,
                              .state = SensorState::degraded,
                              .fault = SensorFault::stale_stream,
                              .sent = 40'000,
                              .capture_bound_64us = 9,
                              .rejected = 77,
                              .period_error_permille = -65};
    return {"SENSOR_HEALTH",
            health,
            1,
            0x281,
            false,
            8,
            1,
            {valid_below(63, plain("sensor", 3, 6, &SensorHealth::sensor)),
             valid_below(6, plain("state", 9, 3, &SensorHealth::state)),
             valid_below(13, plain("fault", 12, 4, &SensorHealth::fault)),
             plain("sent", 16, 16, &SensorHealth::sent),
             plain("capture_bound", 32, 8, &SensorHealth::capture_bound_64us),
             plain("rejected", 40, 8, &SensorHealth::rejected),
             plain("period_error", 48, 8, &SensorHealth::period_error_permille)},
            {},
            {}};
}

void add_sync_cases(std::vector<MessageCase>& cases) {
    cases.push_back(
        {"SYNC", Sync{21}, 0, 0x040, false, 3, 2, {plain("sequence", 3, 5, &Sync::sequence)}, {}, {}});
    cases.push_back(
        {"FOLLOW_UP",
         FollowUp{21, 1'234'567'890'123},
         0,
         0x080,
         false,
         8,
         1,
         {plain("sequence", 3, 5, &FollowUp::sequence), plain("host_time", 8, 48, &FollowUp::host_time_us)},
         {},
         {}});
    cases.push_back({"SYNC_REPORT",
                     SyncReport{21, NodeTime{0xFEDCBA98}},
                     3,
                     0x1C3,
                     false,
                     7,
                     2,
                     {plain("sequence", 3, 5, &SyncReport::sequence),
                      field<SyncReport>("heard", 8, 32,
                                        [](SyncReport& report, std::uint64_t raw) {
                                            report.heard.us = static_cast<std::uint32_t>(raw);
                                        })},
                     {},
                     {}});
}

void add_joint_cases(std::vector<MessageCase>& cases) {
    cases.push_back({"JOINT_STATE pair",
                     JointState(JointPair{1, 5, {-2'356'194, 3'270'123}}),
                     3,
                     0x183,
                     false,
                     8,
                     1,
                     {plain("sequence", 5, 3, &JointPair::sequence),
                      field<JointPair>("position_even", 8, 24,
                                       [](JointPair& joints, std::uint64_t raw) {
                                           joints.position_urad[0] = sign_extended_24(raw);
                                       }),
                      field<JointPair>("position_odd", 32, 24,
                                       [](JointPair& joints, std::uint64_t raw) {
                                           joints.position_urad[1] = sign_extended_24(raw);
                                       })},
                     {{3, 2}},
                     {}});
    cases.push_back({"JOINT_STATE last",
                     JointState(JointLast{5, -785'398, {0xABCDEF, 16'777'216}}),
                     3,
                     0x183,
                     false,
                     8,
                     1,
                     {plain("sequence", 5, 3, &JointLast::sequence),
                      field<JointLast>("position_last", 8, 24,
                                       [](JointLast& joint, std::uint64_t raw) {
                                           joint.position_urad = sign_extended_24(raw);
                                       }),
                      field<JointLast>("sample_time", 32, 24,
                                       [](JointLast& joint, std::uint64_t raw) {
                                           joint.sampled = {static_cast<std::uint32_t>(raw), 16'777'216};
                                       })},
                     {{3, 2}},
                     {}});
}

void add_host_cases(std::vector<MessageCase>& cases) {
    cases.push_back(
        {"MARK",
         Mark{MarkKind::start, 1'234'567'890'123},
         0,
         0x100,
         false,
         8,
         1,
         {valid_below(2, plain("kind", 3, 5, &Mark::kind)), plain("host_time", 8, 48, &Mark::host_time_us)},
         {},
         {}});
    FieldCase code = plain("code", 3, 5, &Command::code);
    code.is_valid = [](std::uint64_t raw) { return raw >= 1 && raw <= 10; };
    cases.push_back(
        {"COMMAND",
         Command{CommandCode::set_rate, 62, 33, 129},
         63,
         0x0FF,
         false,
         7,
         2,
         {code, plain("sensor", 8, 6, &Command::sensor), plain("argument", 16, 16, &Command::argument),
          plain("sequence", 32, 8, &Command::sequence)},
         {},
         {{14, 2}}});
}

}  // namespace

std::vector<MessageCase> all_message_cases() {
    std::vector<MessageCase> cases = {range_case(), aux_case(), heartbeat_case(), health_case()};
    for (std::uint8_t readings = 1; readings <= 4; ++readings) {
        cases.push_back(range_fd_case(readings));
    }
    add_info_cases(cases);
    add_sync_cases(cases);
    add_joint_cases(cases);
    add_host_cases(cases);
    cases.push_back(reflex_case());
    cases.push_back(black_box_case());
    cases.push_back(calibration_case());
    return cases;
}

}  // namespace octoskin::test
