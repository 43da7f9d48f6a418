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
    problems.push_back({"links without body",
                        fmt::format("robot: {}: without a body (links_unknown): the map has what the sensors "
                                    "see of it, and a query answers unknown instead of free; give it "
                                    "capsules, or list it in robot.links_without_body of the rig",
                                    names)});
}

}  // namespace octoskin
