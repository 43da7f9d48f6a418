#include "hw/rigfile/links_without_body.hpp"

#include <urdf_model/joint.h>
#include <urdf_model/link.h>
#include <urdf_model/model.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <string_view>

#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::rig {
namespace {

/// A link, and the rigid group that it belongs to: links between which there are fixed joints alone.
struct GroupedLink {
    const urdf::Link* link = nullptr;
    std::size_t group = 0;
};

/// At or below `base`, parents first. Group 0 is the base's, which no joint moves.
std::vector<GroupedLink> grouped_links(const urdf::Link& base) {
    std::vector<GroupedLink> links = {{&base, 0}};
    std::size_t groups = 1;
    // urdfdom has made sure that it is a tree: each link comes once.
    for (std::size_t i = 0; i < links.size(); ++i) {
        const std::size_t group = links[i].group;
        for (const auto& child : links[i].link->child_links) {
            const bool is_rigid = child->parent_joint->type == urdf::Joint::FIXED;
            links.push_back({child.get(), is_rigid ? group : groups++});
        }
    }
    return links;
}

}  // namespace

Result<std::vector<std::string>, RigError> links_without_body(const Rig& rig, std::span<const Capsule> body) {
    const auto document = UrdfDocument::read(rig.urdf);
    if (!document) return unexpected(document.error());
    const auto base = document->model().getLink(rig.base_link);
    if (!base)
        return unexpected(
            document->error("link", rig.base_link, "expected this base link, found none of its name"));
    std::set<std::string_view> bodies;
    for (const Capsule& capsule : body) bodies.insert(capsule.link);
    const std::vector<GroupedLink> links = grouped_links(*base);
    std::set<std::size_t> groups_with_body;
    for (const GroupedLink& link : links) {
        if (bodies.contains(link.link->name)) groups_with_body.insert(link.group);
    }
    std::vector<std::string> names;
    for (const GroupedLink& link : links) {
        const bool is_moving = link.group != 0;
        if (is_moving && !link.link->visual_array.empty() && !groups_with_body.contains(link.group))
            names.push_back(link.link->name);
    }
    std::ranges::sort(names);
    return names;
}

}  // namespace octoskin::rig
