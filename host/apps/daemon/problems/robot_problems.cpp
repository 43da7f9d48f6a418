#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include <string>

namespace octoskin {

/// Links that the rig lists are meant to have no body: nothing is reported for them.
void add_links_without_body(const DaemonView& view, Problems& problems) {
    std::string names;
    for (const LinkWithoutBody& link : view.rig->links_without_body) {
        if (!link.is_listed) names += (names.empty() ? "" : ", ") + link.link;
    }
    if (names.empty()) return;
    problems.push_back({.code = ProblemCode::links_without_body,
                        .on = "robot: " + names,
                        .what = "without a body (links_unknown), so what the sensors see of it enters the "
                                "map, and a query answers unknown instead of free",
                        .remedy = "give it capsules, or list it in robot.links_without_body of the rig",
                        .key = "robot.links_without_body"});
}

}  // namespace octoskin
