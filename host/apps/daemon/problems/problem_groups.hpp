// The groups of problems, each in the file of its name. problems.cpp has the order of the whole list.
#pragma once

#include <string>
#include <vector>

#include "host/apps/daemon/problem_log.hpp"
#include "host/apps/daemon/status.hpp"

namespace octoskin {

using Problems = std::vector<Problem>;

// --- bus_problems.cpp: the CAN link, and the shared time on it
void add_wall_clock(const DaemonView& view, Problems& problems);
void add_link(const DaemonView& view, Problems& problems);
void add_other_hosts(const DaemonView& view, Problems& problems);
void add_clock(const DaemonView& view, Problems& problems);

// --- robot_problems.cpp
void add_links_without_body(const DaemonView& view, Problems& problems);

// --- node_problems.cpp: nodes, their sensors and registers, and the fate of their readings
void add_nodes(const DaemonView& view, Problems& problems);
/// Subject of all problems of a node.
[[nodiscard]] inline std::string node_subject(wire::NodeId node) {
    return "node " + std::to_string(node);
}
void add_joint_nodes(const DaemonView& view, Problems& problems);
void add_readings(const DaemonView& view, Problems& problems);

// --- silence_problems.cpp: missing data of a node that is usable
void add_silence(const DaemonView& view, const HostNode& node, Problems& problems);

// --- joint_problems.cpp: joint states and their senders
void add_joints(const DaemonView& view, Problems& problems);

// --- camera_problems.cpp
void add_cameras(const DaemonView& view, Problems& problems);

// --- map_problems.cpp: the map, its folder, the recording, the newest reload
void add_map(const DaemonView& view, Problems& problems);

// --- log_problems.cpp
void add_log(const DaemonView& view, Problems& problems);

}  // namespace octoskin
