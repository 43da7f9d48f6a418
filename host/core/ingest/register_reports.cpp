#include "host/core/ingest/register_reports.hpp"

#include <algorithm>
#include <cstdio>

namespace octoskin {
namespace {

std::string hex(std::uint8_t byte) {
    std::array<char, 8> text{};
    (void)std::snprintf(text.data(), text.size(), "0x%02X", unsigned{byte});
    return text.data();
}

bool is_same(const wire::RegisterReport& a, const wire::RegisterReport& b) {
    return a.index == b.index && a.read == b.read;
}

}  // namespace

void RegisterReports::take(const wire::InfoFault& fault) {
    const auto report = wire::RegisterReport::of(fault.where);
    if (fault.kind == wire::FaultKind::register_fixed) {
        if (report.subject < of_sensors_.size()) of_sensors_.at(report.subject) = report;
        return;
    }
    if (fault.kind != wire::FaultKind::register_alike) return;
    for (auto& of_sensor : of_sensors_) {
        if (of_sensor && is_same(*of_sensor, report)) of_sensor.reset();
    }
    const bool is_known = std::ranges::any_of(
        alike_, [&](const wire::RegisterReport& known) { return is_same(known, report); });
    if (!is_known && alike_.size() < kAlikeMax) alike_.push_back(report);
}

std::string text_of(const wire::RegisterReport& report) {
    return "register " + hex(report.index) + " was written " + hex(report.written) + " and reads " +
           hex(report.read);
}

std::string leave_out_text(const wire::RegisterReport& report, const std::string& node) {
    return "`verification: {leave_out: [" + hex(report.index) + "]}` at node '" + node +
           "' of the rig leaves that register out";
}

std::string alike_text(const wire::RegisterReport& report) {
    return text_of(report) + ", the same on " + std::to_string(report.subject) +
           " sensors or more: normal for this type of part, no reading is withheld";
}

}  // namespace octoskin
