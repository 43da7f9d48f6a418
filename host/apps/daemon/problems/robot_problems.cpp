#include "host/apps/daemon/problems/problem_groups.hpp"

#include <fmt/format.h>

#include <string>

namespace octoskin {

/// Of those that the rig lists there is nothing to say: they are meant to be so.
void add_links_without_body(const DaemonView& view, Problems& problems) {
    std::string names;
    for (const LinkWithoutBody& link : view.rig->links_without_body) {
        if (!link.is_listed) names += (names.empty() ? "" : ", ") + link.link;
    }
    if (names.empty()) return;
    problems.push_back(
        {"links without body",
         fmt::format(
             "robot: {}: without a body (links_unknown): what the sensors see of it comes into the map, "
             "and a query answers unknown instead of free; give it capsules, or list it in "
             "robot.links_without_body of the rig",
             names)});
}

}  // namespace octoskin
