// A candump log as the host decodes it, a line each frame: for checks that are shell scripts.
//   NODE range SENSOR STATUS RANGE_MM CAPTURE_US SPAN_US SEQUENCE
//   NODE heartbeat STATE DEGRADED
//   NODE health SENSOR STATE FAULT BOUND_64US
//   NODE sync_report SEQUENCE HEARD_US
//   NODE rejected        (its checks failed)
// Frames of other kinds are left out.
#include <cstdio>
#include <variant>

#include "common/wire/codec.hpp"
#include "common/wire/names.hpp"
#include "host/io/candump/log_reader.hpp"

namespace {

using namespace octoskin;

void print(unsigned node, const wire::RangeReading& reading) {
    std::printf("%u range %u %u %u %u %u %u\n", node, reading.sensor, reading.device_status, reading.range_mm,
                reading.capture.value_us, reading.capture.span_us, reading.sequence);
}

void print(const wire::Decoded& decoded) {
    const unsigned node = decoded.node_id;
    if (const auto* range = std::get_if<wire::Range>(&decoded.message)) {
        print(node, range->reading);
    } else if (const auto* several = std::get_if<wire::RangeFd>(&decoded.message)) {
        for (std::size_t i = 0; i < several->count; ++i) print(node, several->entries.at(i).reading);
    } else if (const auto* beat = std::get_if<wire::Heartbeat>(&decoded.message)) {
        std::printf("%u heartbeat %s %u\n", node, wire::name(beat->state), beat->degraded_sensors);
    } else if (const auto* health = std::get_if<wire::SensorHealth>(&decoded.message)) {
        std::printf("%u health %u %s %s %u\n", node, health->sensor, wire::name(health->state),
                    wire::name(health->fault), health->capture_bound_64us);
    } else if (const auto* report = std::get_if<wire::SyncReport>(&decoded.message)) {
        std::printf("%u sync_report %u %u\n", node, report->sequence, report->heard.us);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: decode_log LOG\n"), 64;
    auto log = candump::LogReader::open(argv[1]);
    if (!log) return std::fprintf(stderr, "%s\n", log.error().message().c_str()), 66;
    while (true) {
        const auto entry = log->next();
        if (!entry) return std::fprintf(stderr, "%s\n", entry.error().message().c_str()), 65;
        if (!*entry) return 0;
        const wire::CanFrame& frame = (*entry)->frame;
        if (frame.is_extended || frame.is_error) continue;
        if (const auto decoded = wire::decode(frame)) {
            print(*decoded);
        } else {
            std::printf("%u rejected\n", unsigned{wire::node_of(frame.can_id)});
        }
    }
}
