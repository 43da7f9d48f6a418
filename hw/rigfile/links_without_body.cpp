#include "hw/rigfile/links_without_body.hpp"

#include <urdf_model/joint.h>
#include <urdf_model/link.h>
#include <urdf_model/model.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <string_view>

#include "hw/rigfile/urdf_document.hpp"
#include "hw/rigfile/urdf_pose.hpp"
#include "hw/rigfile/visual_cover.hpp"

namespace octoskin::rig {
namespace {

constexpr double kShareMin = 0.5;
constexpr double kShareToNextJointMin = 0.2;
constexpr double kCapsuleLengthMin_m = 0.05;
constexpr std::size_t kVisualsMax = 100;

struct GroupLink {
    const urdf::Link* link = nullptr;
    Eigen::Isometry3d T_group_link = Eigen::Isometry3d::Identity();
    std::vector<Capsule> body;       ///< in the group's frame
    std::vector<VisualBox> visuals;  ///< of known size
    bool has_mesh = false;           ///< or another <visual> of unknown size

    [[nodiscard]] bool is_seen() const { return has_mesh || !visuals.empty(); }
};

/// Links that are connected by fixed joints only. The group's frame is that of its first link.
struct Group {
    const urdf::Joint* joint = nullptr;  ///< the joint that moves the group; null: the base's group
    std::vector<GroupLink> links;        ///< parents first
    std::vector<Axis> carried;           ///< axes of the joints of other groups
    std::vector<Capsule> body;           ///< of all its links
};

using BodyOfLink = std::multimap<std::string_view, const Capsule*>;

bool is_turning(const urdf::Joint& joint) {
    return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS;
}

Axis axis_of(const urdf::Joint& joint, const Eigen::Isometry3d& T_group_joint) {
    return {T_group_joint.translation(),
            T_group_joint.linear() * Eigen::Vector3d(joint.axis.x, joint.axis.y, joint.axis.z)};
}

GroupLink group_link(const urdf::Link& link, const Eigen::Isometry3d& T_group_link,
                     const BodyOfLink& bodies) {
    GroupLink made{&link, T_group_link, {}, {}, false};
    const auto [begin, end] = bodies.equal_range(link.name);
    for (auto found = begin; found != end; ++found) {
        const Capsule& capsule = *found->second;
        made.body.push_back({capsule.link, T_group_link * capsule.p_link_a, T_group_link * capsule.p_link_b,
                             capsule.radius_m});
    }
    for (const auto& visual : link.visual_array) {
        if (const auto box = visual_box(*visual, T_group_link))
            made.visuals.push_back(*box);
        else
            made.has_mesh = true;
    }
    return made;
}

/// The groups at or below `base`. urdfdom guarantees a tree: each link occurs once.
std::vector<Group> groups_of(const urdf::Link& base, const BodyOfLink& bodies) {
    std::vector<Group> groups(1);
    groups[0].links.push_back(group_link(base, Eigen::Isometry3d::Identity(), bodies));
    for (std::size_t g = 0; g < groups.size(); ++g) {
        for (std::size_t i = 0; i < groups[g].links.size(); ++i) {
            const urdf::Link& link = *groups[g].links[i].link;
            const Eigen::Isometry3d T_group_link = groups[g].links[i].T_group_link;
            for (const auto& child : link.child_links) {
                const urdf::Joint& joint = *child->parent_joint;
                const Eigen::Isometry3d T_group_joint =
                    T_group_link * urdf_isometry(joint.parent_to_joint_origin_transform);
                if (joint.type == urdf::Joint::FIXED) {
                    groups[g].links.push_back(group_link(*child, T_group_joint, bodies));
                    continue;
                }
                if (is_turning(joint)) groups[g].carried.push_back(axis_of(joint, T_group_joint));
                groups.emplace_back().joint = &joint;
                groups.back().links.push_back(group_link(*child, Eigen::Isometry3d::Identity(), bodies));
            }
        }
        for (const GroupLink& link : groups[g].links)
            groups[g].body.insert(groups[g].body.end(), link.body.begin(), link.body.end());
    }
    return groups;
}

/// True also if there are none.
bool are_visuals_covered(std::vector<VisualBox> visuals, std::span<const Capsule> body) {
    const auto kept = std::min(visuals.size(), kVisualsMax);
    std::ranges::partial_sort(visuals, visuals.begin() + static_cast<std::ptrdiff_t>(kept),
                              std::ranges::greater(), &VisualBox::length_m);
    visuals.resize(kept);
    double length_m = 0.0;
    double found_m = 0.0;
    for (const VisualBox& visual : visuals) {
        length_m += visual.length_m();
        found_m += covered_m(visual, body);
    }
    return found_m >= kShareMin * length_m;
}

bool is_way_covered(const Stretch& stretch, double share, std::span<const Capsule> body) {
    constexpr double kAlike_m = 1e-6;
    const double length_m = stretch.length_m();
    return length_m < kAlike_m || covered_m(stretch, body) >= share * length_m;
}

/// A link extends from the axis that turns it to the axes that it carries. The joints' origins may be
/// anywhere on these axes.
bool are_axes_joined(const Group& group) {
    if (!is_turning(*group.joint)) return true;
    const Axis own = axis_of(*group.joint, Eigen::Isometry3d::Identity());
    return std::ranges::all_of(group.carried, [&](const Axis& next) {
        return is_way_covered(between(own, next), kShareMin, group.body);
    });
}

/// The size of a mesh is unknown. This check still detects a body that is far smaller than the link.
bool is_large_enough_for_a_mesh(const Group& group) {
    const bool has_long = std::ranges::any_of(group.body, [](const Capsule& capsule) {
        return (capsule.p_link_b - capsule.p_link_a).norm() + 2.0 * capsule.radius_m >= kCapsuleLengthMin_m;
    });
    if (!has_long) return false;
    if (!is_turning(*group.joint)) return true;
    return std::ranges::all_of(group.carried, [&](const Axis& next) {
        return is_way_covered({Eigen::Vector3d::Zero(), next.p_group}, kShareToNextJointMin, group.body);
    });
}

bool is_body_enough(const Group& group) {
    if (group.body.empty()) return false;
    std::vector<VisualBox> visuals;
    bool has_mesh = false;
    bool has_mesh_alone = false;
    for (const GroupLink& link : group.links) {
        visuals.insert(visuals.end(), link.visuals.begin(), link.visuals.end());
        has_mesh |= link.has_mesh;
        has_mesh_alone |= link.has_mesh && link.body.empty();
    }
    return are_visuals_covered(std::move(visuals), group.body) && (!has_mesh || are_axes_joined(group)) &&
           (!has_mesh_alone || is_large_enough_for_a_mesh(group));
}

/// The link with the longest capsule, for the message.
std::string lender_of(const Group& group) {
    const auto longest = std::ranges::max_element(group.body, {}, [](const Capsule& capsule) {
        return (capsule.p_link_b - capsule.p_link_a).norm() + 2.0 * capsule.radius_m;
    });
    return longest->link;
}

bool is_covered_by_itself(const GroupLink& link) {
    return !link.body.empty() && !link.has_mesh && are_visuals_covered(link.visuals, link.body);
}

void add_bodyless(const Group& group, BodylessLinks& found) {
    const bool is_enough = is_body_enough(group);
    for (const GroupLink& link : group.links) {
        if (!link.is_seen()) continue;
        if (is_enough && link.body.empty()) found.borrowed.push_back({link.link->name, lender_of(group)});
        if (!is_enough && !is_covered_by_itself(link)) found.without_body.push_back(link.link->name);
    }
}

}  // namespace

Result<BodylessLinks, Error> bodyless_links(const Rig& rig, std::span<const Capsule> body) {
    const auto document = UrdfDocument::read(rig.urdf);
    if (!document) return unexpected(document.error());
    const auto base = document->model().getLink(rig.base_link);
    if (!base)
        return unexpected(document->error(
            "link", rig.base_link,
            {ErrorCode::unknown_name, "expected this base link, found no link of this name"}));
    BodyOfLink bodies;
    for (const Capsule& capsule : body) bodies.emplace(capsule.link, &capsule);
    BodylessLinks found;
    for (const Group& group : groups_of(*base, bodies)) {
        if (group.joint != nullptr) add_bodyless(group, found);
    }
    std::ranges::sort(found.without_body);
    std::ranges::sort(found.borrowed, {}, &BorrowedBody::link);
    return found;
}

}  // namespace octoskin::rig
