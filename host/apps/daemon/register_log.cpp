#include "host/apps/daemon/register_log.hpp"

#include <fmt/format.h>

namespace octoskin {

std::vector<std::string> RegisterLog::news(const NodeRegistry& nodes) {
    // A node that restarts and reads other values each time must not fill the log.
    constexpr std::size_t kToldMax = 256;
    std::vector<std::string> lines;
    for (const auto& [node, record] : nodes.records()) {
        for (const wire::RegisterReport& report : record.registers.alike()) {
            if (reported_.size() >= kToldMax || !reported_.emplace(node, report.index, report.read).second)
                continue;
            lines.push_back(fmt::format("node {} '{}': {}", node, record.expected.name, alike_text(report)));
        }
    }
    return lines;
}

}  // namespace octoskin
