#include "host/apps/daemon/problems/problem_groups.hpp"

namespace octoskin {

std::vector<Problem> problems(const DaemonView& view) {
    Problems problems;
    add_wall_clock(view, problems);
    add_link(view, problems);
    add_other_hosts(view, problems);
    add_links_without_body(view, problems);
    if (!view.is_settling()) {
        add_clock(view, problems);
        add_nodes(view, problems);
        add_joint_nodes(view, problems);
        add_joints(view, problems);
        add_readings(view, problems);
        add_cameras(view, problems);
    }
    add_map(view, problems);
    add_log(view, problems);
    return problems;
}

}  // namespace octoskin
