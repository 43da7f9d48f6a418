// Reads a rig file into a Rig: the top level, and all keys that do not belong to a node.
#include <fmt/format.h>
#include <urdf_model/model.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "common/wire/bus_load.hpp"
#include "common/wire/messages.hpp"
#include "host/io/folder/confined.hpp"
#include "hw/rigfile/camera_reader.hpp"
#include "hw/rigfile/can_load.hpp"
#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/joint_reader.hpp"
#include "hw/rigfile/links_without_body.hpp"
#include "hw/rigfile/node_reader.hpp"
#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/rig_keys.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/rigfile/table.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::rig {
namespace {

UrdfDocument read_robot(const Table& robot, const std::filesystem::path& urdf_instead, Rig& rig) {
    const Value& named = robot.require(keys::robot::kUrdf);
    rig.urdf = urdf_instead.empty() ? existing_file(named, robot.path_of(keys::robot::kUrdf))
                                    : confined_to_recording(urdf_instead);
    // Absolute, so that it stays valid if this process changes its working directory.
    if (rig.urdf.folder() == nullptr)
        rig.urdf = FilePlace(std::filesystem::absolute(rig.urdf.name()).lexically_normal());
    auto text = read_urdf_text(rig.urdf);
    if (!text) throw text.error();
    rig.urdf = FilePlace::held(*std::move(text), rig.urdf);
    auto document = UrdfDocument::read(rig.urdf);
    if (!document) throw document.error();
    return std::move(document).value();
}

void require_link(const Value& value, const std::string& path, const std::string& link,
                  const UrdfDocument& robot) {
    if (robot.model().links_.contains(link)) return;
    fail(value, path,
         {ErrorCode::unknown_name, fmt::format("expected a link of {}", robot.file().filename().string()),
          fmt::format("'{}'", link), "it has " + joined(robot.link_names())});
}

/// Its place in the map is fixed, so no joint of the robot may move it. A mobile robot's place is that of its
/// base: a `floating` or `planar` joint above it has no position here.
void refuse_moved_base(const Table& table, const std::string& base_link, const UrdfDocument& robot) {
    const auto joint = robot.joint_moving(base_link);
    if (!joint) return;
    table.fail(keys::robot::kBaseLink, {ErrorCode::conflict, "expected a link that no joint moves",
                                        fmt::format("'{}', which joint '{}' moves", base_link, *joint),
                                        fmt::format("name '{}' or a link fixed to it above that joint",
                                                    robot.model().getRoot()->name)});
}

void read_self_filter(const Table& robot, const UrdfDocument& document, Rig& rig) {
    rig.base_link = robot.text(keys::robot::kBaseLink);
    require_link(robot.require(keys::robot::kBaseLink), robot.path_of(keys::robot::kBaseLink), rig.base_link,
                 document);
    rig.depth_self_margin_m = robot.number(keys::robot::kDepthSelfMargin);
    rig.range_self_margin_m = robot.number(keys::robot::kRangeSelfMargin);
    if (const Value* paddings = robot.find(keys::robot::kLinkPadding)) {
        const std::string path = robot.path_of(keys::robot::kLinkPadding);
        if (paddings->kind != Value::Kind::table)
            fail(*paddings, path,
                 {ErrorCode::wrong_type, "expected a table of link names and metres", describe(*paddings)});
        for (const Value& padding : paddings->items) {
            const std::string entry = path + "." + padding.key;
            require_link(padding, entry, padding.key, document);
            rig.link_padding_m[padding.key] = read_number(padding, entry, keys::robot::kLinkPadding.range);
        }
    }
    rig.fits_capsules = robot.flag(keys::robot::kFitsCapsules);
    if (const Value* ignored = robot.find(keys::robot::kLinksIgnoredBySensors)) {
        const std::string path = robot.path_of(keys::robot::kLinksIgnoredBySensors);
        for (const Value& link : read_list(*ignored, path)) {
            rig.links_ignored_by_sensors.push_back(read_element_name(link, path));
            require_link(link, path, link.text, document);
        }
    }
}

AttachedCapsule read_attached(const Value& value, const std::string& path, const UrdfDocument& robot,
                              const Rig& rig) {
    const Table table(value, path, keys::kAttachedCapsule);
    AttachedCapsule capsule;
    capsule.name = table.text(keys::capsule::kName);
    capsule.link = table.text(keys::capsule::kLink);
    require_link(table.require(keys::capsule::kLink), table.path_of(keys::capsule::kLink), capsule.link,
                 robot);
    if (!robot.is_below(rig.base_link, capsule.link)) {
        table.fail(keys::capsule::kLink,
                   {ErrorCode::unknown_name, fmt::format("expected a link at or below {}", rig.base_link),
                    fmt::format("'{}'", capsule.link)});
    }
    capsule.p_link_a = read_position(table, keys::capsule::kFrom);
    capsule.p_link_b = table.find(keys::capsule::kTo) == nullptr ? capsule.p_link_a
                                                                 : read_position(table, keys::capsule::kTo);
    capsule.radius_m = table.number(keys::capsule::kRadius);
    capsule.padding_m = table.number(keys::capsule::kPadding);
    for (const AttachedCapsule& other : rig.attached_capsules) {
        if (other.name == capsule.name)
            table.fail(keys::capsule::kName, {ErrorCode::duplicate, "expected each name once",
                                              fmt::format("'{}' again", capsule.name)});
    }
    return capsule;
}

void read_attached_capsules(const Table& robot, const UrdfDocument& document, Rig& rig) {
    constexpr std::size_t kAttachedMax = keys::robot::kAttachedCapsules.count.max;
    const Value* const list = robot.find(keys::robot::kAttachedCapsules);
    if (list == nullptr) return;
    const std::string path = robot.path_of(keys::robot::kAttachedCapsules);
    for (const Value& item : read_list(*list, path)) {
        if (rig.attached_capsules.size() == kAttachedMax)
            fail(item, path,
                 {ErrorCode::limit_exceeded, fmt::format("expected at most {} capsules", kAttachedMax),
                  "more"});
        rig.attached_capsules.push_back(
            read_attached(item, fmt::format("{}[{}]", path, rig.attached_capsules.size()), document, rig));
    }
}

bool has_mesh(const UrdfDocument& robot) {
    return std::ranges::any_of(robot.model().links_, [](const auto& link) {
        return std::ranges::any_of(link.second->collision_array, [](const auto& collision) {
            return collision->geometry && collision->geometry->type == urdf::Geometry::MESH;
        });
    });
}

/// Whether the link's capsules are too few or too small for a body. True also if the robot has meshes: its
/// bodies are not known before capsules are fitted to them.
bool is_without_body(const std::string& link, const UrdfDocument& robot, const Rig& rig) {
    const auto body = padded_body(rig);
    if (!body && has_mesh(robot)) return true;
    if (!body) throw body.error();
    const auto found = bodyless_links(rig, *body);
    if (!found) throw found.error();
    return std::ranges::find(found->without_body, link) != found->without_body.end();
}

/// The source of the link's body; empty if there is none.
std::string body_of(const std::string& link, const UrdfDocument& robot, const Rig& rig) {
    const auto found = robot.model().links_.find(link);
    if (found != robot.model().links_.end() && !found->second->collision_array.empty())
        return "a <collision> in " + robot.file().filename().string();
    for (const AttachedCapsule& capsule : rig.attached_capsules) {
        if (capsule.link == link) return fmt::format("the attached capsule '{}'", capsule.name);
    }
    return "";
}

void read_links_without_body(const Table& robot, const UrdfDocument& document, Rig& rig) {
    const Value* const list = robot.find(keys::robot::kLinksWithoutBody);
    if (list == nullptr) return;
    const std::string path = robot.path_of(keys::robot::kLinksWithoutBody);
    for (const Value& item : read_list(*list, path)) {
        auto link = read_element_name(item, path);
        require_link(item, path, link, document);
        if (!document.is_below(rig.base_link, link))
            fail(item, path,
                 {ErrorCode::unknown_name, fmt::format("expected a link at or below {}", rig.base_link),
                  fmt::format("'{}'", link)});
        if (const std::string body = body_of(link, document, rig);
            !body.empty() && !is_without_body(link, document, rig)) {
            fail(item, path,
                 {ErrorCode::conflict, "expected a link without a body",
                  fmt::format("'{}', which has {}", link, body), "remove it here"});
        }
        if (std::ranges::find(rig.links_without_body, link) != rig.links_without_body.end())
            fail(item, path,
                 {ErrorCode::duplicate, "expected each link once", fmt::format("'{}' again", link)});
        rig.links_without_body.push_back(std::move(link));
    }
}

std::uint32_t read_bitrate(const Table& bus, const IntegerKey& key) {
    const auto bitrate = bus.integer<std::int64_t>(key);
    if (std::ranges::find(key.values, bitrate) == key.values.end()) {
        bus.fail(key, {ErrorCode::out_of_range, fmt::format("expected one of {}", joined(key.values)),
                       std::to_string(bitrate)});
    }
    return static_cast<std::uint32_t>(bitrate);
}

Bus read_bus(const Value& value) {
    const Table table(value, std::string(name_of(keys::kBusTable)), keys::kBus);
    Bus bus;
    bus.uses_can_fd = table.choice(keys::bus::kProtocol);
    bus.nominal_bitrate = read_bitrate(table, keys::bus::kNominalBitrate);
    if (bus.uses_can_fd) {
        bus.data_bitrate = read_bitrate(table, keys::bus::kDataBitrate);
    } else if (table.find(keys::bus::kDataBitrate)) {
        table.fail(keys::bus::kDataBitrate, {.code = ErrorCode::conflict,
                                             .what = "expected none with protocol can",
                                             .remedy = "remove it (`~` removes an inherited key)"});
    }
    return bus;
}

RangeLimits read_range_limits(const Value& value) {
    const Table table(value, std::string(name_of(keys::kRangeLimitsTable)), keys::kRangeLimits);
    const RangeLimits limits{
        .min_m = table.number(keys::range_limits::kMin),
        .max_m = table.number(keys::range_limits::kMax),
        .sigma_max_m = table.number(keys::range_limits::kSigmaMax),
        .time_uncertainty_max_ms = table.number(keys::range_limits::kTimeUncertaintyMax)};
    if (!(limits.min_m < limits.max_m)) {
        table.fail(keys::range_limits::kMax,
                   {ErrorCode::out_of_range, "expected more than min_m", fmt::format("{}", limits.max_m)});
    }
    return limits;
}

void refuse_overloaded_bus(const Table& top, const Rig& rig) {
    const double load = can_load(rig);
    if (load <= wire::kBusLoadLimit) return;
    top.fail(keys::kBusTable,
             {ErrorCode::overload,
              fmt::format("expected a CAN load of at most {:.0f} %", 100.0 * wire::kBusLoadLimit),
              fmt::format("{:.1f} % in the worst case", 100.0 * load),
              "use a longer inter_measurement_ms, a higher bitrate, can_fd, or fewer sensors"});
}

Rig read_checked(const FilePlace& file, const std::filesystem::path& urdf_instead) {
    Rig rig;
    const Value document = load_with_extends(file, &rig.extended_files);
    const Table top(document, "", keys::kTop);
    rig.name = top.text(keys::kName);
    const Table robot(top.require(keys::kRobotTable), top.path_of(keys::kRobotTable), keys::kRobot);
    const UrdfDocument urdf = read_robot(robot, urdf_instead, rig);
    read_self_filter(robot, urdf, rig);
    read_attached_capsules(robot, urdf, rig);
    read_links_without_body(robot, urdf, rig);
    if (const Value* pose = top.find(keys::kMapBase)) {
        rig.T_map_base = read_pose(*pose, top.path_of(keys::kMapBase), {.reach_m = keys::kRoomReach_m});
    }
    rig.bus = read_bus(top.require(keys::kBusTable));
    if (const Value* limits = top.find(keys::kRangeLimitsTable))
        rig.range_limits = read_range_limits(*limits);
    rig.cameras = read_cameras(top, urdf, rig.base_link);
    rig.nodes = read_nodes(top.require(keys::kNodes), top.path_of(keys::kNodes),
                           {urdf, rig.base_link, rig.bus, top.find(keys::kSensorDefaults)});
    refuse_moved_base(robot, rig.base_link, urdf);
    rig.joint_sources = read_joint_sources(top.require(keys::kJointsTable), urdf, rig);
    refuse_overloaded_bus(top, rig);
    return rig;
}

}  // namespace

Result<Rig, Error> read_rig(const FilePlace& file, const std::filesystem::path& urdf_instead) {
    try {
        return read_checked(confined_to_recording(file), urdf_instead);
    } catch (const Error& error) {
        return unexpected(error);
    }
}

}  // namespace octoskin::rig
