#include "host/bridge/received/robot_description.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <limits>
#include <locale>
#include <map>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "host/bridge/robot/first_names.hpp"

namespace octoskin::bridge {
namespace {

constexpr std::size_t kBytesMax = std::size_t{16} << 20U;

using Element = tinyxml2::XMLElement;

std::string attribute(const Element* element, const char* name) {
    const char* const value = element == nullptr ? nullptr : element->Attribute(name);
    return value == nullptr ? std::string() : value;
}

/// Three numbers separated by blanks; zeros without the attribute, NaN for anything else.
Eigen::Vector3d numbers(const Element* element, const char* name, const Eigen::Vector3d& none) {
    const std::string text = attribute(element, name);
    if (text.empty()) return none;
    std::istringstream stream(text);
    stream.imbue(std::locale::classic());
    Eigen::Vector3d v = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    for (double& number : v)
        if (!(stream >> number)) return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    return v;
}

template <class Use>
void for_each(const Element& robot, const char* kind, Use use) {
    for (const auto* one = robot.FirstChildElement(kind); one != nullptr; one = one->NextSiblingElement(kind))
        use(*one);
}

std::set<std::string> links_of(const Element& robot) {
    std::set<std::string> links;
    for_each(robot, "link", [&links](const Element& link) {
        if (std::string name = attribute(&link, "name"); !name.empty()) links.insert(std::move(name));
    });
    return links;
}

/// What differs between a joint of the text and the rig's; empty: nothing that a map shows.
std::string difference(const Element& joint, const JointDescription& own) {
    constexpr double kTolerance = 1e-4;  // metres, and parts of a unit
    const Element* const origin = joint.FirstChildElement("origin");
    const Eigen::Vector3d rpy = numbers(origin, "rpy", Eigen::Vector3d::Zero());
    const Eigen::Quaterniond rotation = Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX());
    const Eigen::Vector3d xyz = numbers(origin, "xyz", Eigen::Vector3d::Zero());
    if (attribute(joint.FirstChildElement("parent"), "link") != own.parent_link ||
        attribute(joint.FirstChildElement("child"), "link") != own.child_link)
        return "joins other links";
    const bool is_moved = !((xyz - own.T_parent_joint.translation()).norm() <= kTolerance) ||
                          !((rotation.toRotationMatrix() - own.T_parent_joint.linear()).norm() <= kTolerance);
    if (is_moved) return "has another origin";
    const bool is_fixed = own.kind == JointKind::fixed;
    if ((attribute(&joint, "type") == "fixed") != is_fixed) return "is of another kind";
    const Eigen::Vector3d axis = numbers(joint.FirstChildElement("axis"), "xyz", Eigen::Vector3d::UnitX());
    if (!is_fixed && !((axis.normalized() - own.axis).norm() <= kTolerance)) return "has another axis";
    return {};
}

/// The first joint below the base link that differs, in words; empty: none.
std::string joint_difference(const Element& robot, const std::vector<JointDescription>& joints) {
    std::map<std::string, const Element*> described;
    for_each(robot, "joint",
             [&described](const Element& joint) { described[attribute(&joint, "name")] = &joint; });
    for (const JointDescription& own : joints) {
        const auto found = described.find(own.name);
        if (found == described.end()) return fmt::format("it lacks the joint {}", own.name);
        if (std::string what = difference(*found->second, own); !what.empty())
            return fmt::format("its joint {} {}", own.name, what);
    }
    return {};
}

}  // namespace

std::string description_differs(const std::string& urdf, const RobotFacts& robot) {
    tinyxml2::XMLDocument document;
    const bool is_xml =
        urdf.size() <= kBytesMax && document.Parse(urdf.data(), urdf.size()) == tinyxml2::XML_SUCCESS;
    const Element* const element = is_xml ? document.FirstChildElement("robot") : nullptr;
    const std::set<std::string> described = element == nullptr ? std::set<std::string>() : links_of(*element);
    if (described.empty()) return "/robot_description is no URDF";
    const std::set<std::string> own(robot.links.begin(), robot.links.end());
    std::vector<std::string> missing;
    std::vector<std::string> other;
    std::ranges::set_difference(own, described, std::back_inserter(missing));
    std::ranges::set_difference(described, own, std::back_inserter(other));
    std::vector<std::string> differences;
    if (!missing.empty()) differences.push_back("it lacks the links " + first_names(missing));
    if (!other.empty()) differences.push_back("it has in addition " + first_names(other));
    if (differences.empty())
        if (std::string joint = joint_difference(*element, robot.joints); !joint.empty())
            differences.push_back(std::move(joint));
    if (differences.empty()) return {};
    return fmt::format(
        "/robot_description is another robot than the rig's: {}: use the same URDF in both (octoskin "
        "bridge robot FILE saves it)",
        fmt::join(differences, ", "));
}

}  // namespace octoskin::bridge
