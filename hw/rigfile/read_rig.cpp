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
#include "hw/rigfile/links_without_body.hpp"
#include "hw/rigfile/node_reader.hpp"
#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/rigfile/table.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::rig {
namespace {

UrdfDocument read_robot(const Table& robot, const std::filesystem::path& urdf_instead, Rig& rig) {
    const Value& named = robot.require("urdf");
    rig.urdf = urdf_instead.empty() ? existing_file(named, robot.path_of("urdf"))
                                    : confined_to_recording(urdf_instead);
    // Absolute, so that it stays valid if this process changes its working directory.
    if (rig.urdf.folder() == nullptr)
        rig.urdf = FilePlace(std::filesystem::absolute(rig.urdf.name()).lexically_normal());
    auto document = UrdfDocument::read(rig.urdf);
    if (!document) throw Fault{document.error()};
    return std::move(document).value();
}

void require_link(const Value& value, const std::string& path, const std::string& link,
                  const UrdfDocument& robot) {
    if (robot.model().links_.contains(link)) return;
    fail(value, path,
         fmt::format("expected a link of {}, found '{}'; it has {}", robot.file().filename().string(), link,
                     joined(robot.link_names())));
}

void read_self_filter(const Table& robot, const UrdfDocument& document, Rig& rig) {
    rig.base_link = robot.element_name("base_link");
    require_link(robot.require("base_link"), robot.path_of("base_link"), rig.base_link, document);
    rig.depth_self_margin_m = robot.number("depth_self_margin_m", {0.0, 1.0}, rig.depth_self_margin_m);
    rig.range_self_margin_m = robot.number("range_self_margin_m", {0.0, 1.0}, rig.range_self_margin_m);
    if (const Value* paddings = robot.find("link_padding_m")) {
        const std::string path = robot.path_of("link_padding_m");
        if (paddings->kind != Value::Kind::table)
            fail(*paddings, path, "expected a table of link names and metres");
        for (const Value& padding : paddings->items) {
            const std::string entry = path + "." + padding.key;
            require_link(padding, entry, padding.key, document);
            rig.link_padding_m[padding.key] = read_number(padding, entry, {0.0, 0.5});
        }
    }
    rig.fits_capsules = robot.flag("fits_capsules", false);
    if (const Value* ignored = robot.find("links_ignored_by_sensors")) {
        const std::string path = robot.path_of("links_ignored_by_sensors");
        for (const Value& link : read_list(*ignored, path)) {
            rig.links_ignored_by_sensors.push_back(read_element_name(link, path));
            require_link(link, path, link.text, document);
        }
    }
}

AttachedCapsule read_attached(const Value& value, const std::string& path, const UrdfDocument& robot,
                              const Rig& rig) {
    constexpr double kReachM = 2.0;
    const Table table(value, path, {"name", "link", "from_m", "to_m", "radius_m", "padding_m"});
    AttachedCapsule capsule;
    capsule.name = table.name("name");
    capsule.link = table.element_name("link");
    require_link(table.require("link"), table.path_of("link"), capsule.link, robot);
    if (!robot.is_below(rig.base_link, capsule.link)) {
        table.fail("link",
                   fmt::format("expected a link at or below {}, found '{}'", rig.base_link, capsule.link));
    }
    capsule.p_link_a = read_position(table.require("from_m"), table.path_of("from_m"), kReachM);
    capsule.p_link_b = capsule.p_link_a;
    if (const Value* end = table.find("to_m"))
        capsule.p_link_b = read_position(*end, table.path_of("to_m"), kReachM);
    capsule.radius_m = table.number("radius_m", {0.001, 1.0});
    capsule.padding_m = table.number("padding_m", {0.0, 0.5}, 0.0);
    for (const AttachedCapsule& other : rig.attached_capsules) {
        if (other.name == capsule.name)
            table.fail("name", fmt::format("expected each name once, found '{}' again", capsule.name));
    }
    return capsule;
}

void read_attached_capsules(const Table& robot, const UrdfDocument& document, Rig& rig) {
    constexpr std::size_t kAttachedMax = 64;
    const Value* const list = robot.find("attached_capsules");
    if (list == nullptr) return;
    const std::string path = robot.path_of("attached_capsules");
    for (const Value& item : read_list(*list, path)) {
        if (rig.attached_capsules.size() == kAttachedMax)
            fail(item, path, fmt::format("expected at most {} capsules, found more", kAttachedMax));
        rig.attached_capsules.push_back(
            read_attached(item, fmt::format("{}[{}]", path, rig.attached_capsules.size()), document, rig));
    }
}

/// Whether the link's capsules are too few or too small for a body.
bool is_without_body(const std::string& link, const Rig& rig) {
    const auto body = padded_body(rig);
    if (!body) throw Fault{body.error()};
    const auto found = bodyless_links(rig, *body);
    if (!found) throw Fault{found.error()};
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
    const Value* const list = robot.find("links_without_body");
    if (list == nullptr) return;
    const std::string path = robot.path_of("links_without_body");
    for (const Value& item : read_list(*list, path)) {
        auto link = read_element_name(item, path);
        require_link(item, path, link, document);
        if (!document.is_below(rig.base_link, link))
            fail(item, path, fmt::format("expected a link at or below {}, found '{}'", rig.base_link, link));
        if (const std::string body = body_of(link, document, rig);
            !body.empty() && !is_without_body(link, rig)) {
            fail(item, path,
                 fmt::format("expected a link without a body, found '{}', which has {}: remove it here", link,
                             body));
        }
        if (std::ranges::find(rig.links_without_body, link) != rig.links_without_body.end())
            fail(item, path, fmt::format("expected each link once, found '{}' again", link));
        rig.links_without_body.push_back(std::move(link));
    }
}

std::uint32_t read_bitrate(const Table& bus, std::string_view key,
                           std::initializer_list<std::int64_t> rates) {
    const auto bitrate = bus.integer<std::int64_t>(key, {1, 8'000'000});
    if (std::find(rates.begin(), rates.end(), bitrate) == rates.end()) {
        bus.fail(key, fmt::format("expected one of {}, found {}", joined(rates), bitrate));
    }
    return static_cast<std::uint32_t>(bitrate);
}

Bus read_bus(const Value& value) {
    const Table table(value, "bus", {"protocol", "nominal_bitrate_bps", "data_bitrate_bps"});
    Bus bus;
    bus.uses_can_fd = table.choice<bool>("protocol", {{"can", false}, {"can_fd", true}});
    bus.nominal_bitrate = read_bitrate(table, "nominal_bitrate_bps", {125'000, 250'000, 500'000, 1'000'000});
    if (bus.uses_can_fd) {
        bus.data_bitrate =
            read_bitrate(table, "data_bitrate_bps", {1'000'000, 2'000'000, 4'000'000, 5'000'000, 8'000'000});
    } else if (table.find("data_bitrate_bps")) {
        table.fail("data_bitrate_bps",
                   "expected none with protocol can: remove it (`~` removes an inherited key)");
    }
    return bus;
}

/// The error for a robot with more moving joints than a rig can name, or with joints that the rig does not
/// name.
[[noreturn]] void fail_unnamed(const Value& list, const std::string& path, const UrdfDocument& robot,
                               const std::vector<std::string>& moving,
                               const std::vector<std::string>& unnamed) {
    const std::string file = robot.file().filename().string();
    const std::string fix = "make each joint that does not move type=\"fixed\" in " + file;
    if (moving.size() > wire::kJointsPerSample) {
        fail(list, path,
             fmt::format("expected at most {} moving joints, found {} in {}; not named are {}: {}",
                         wire::kJointsPerSample, moving.size(), file, joined(unnamed), fix));
    }
    fail(list, path,
         fmt::format("expected every moving joint of {}, found none named {}: its position would be unknown. "
                     "Name it, or {}",
                     file, joined(unnamed), fix));
}

std::vector<std::string> read_joint_names(const Table& table, const UrdfDocument& robot,
                                          const std::string& base_link) {
    const Value& list = table.require("names");
    const std::string path = table.path_of("names");
    const auto moving = robot.moving_joints(base_link);
    std::vector<std::string> names;
    for (const Value& item : read_list(list, path)) {
        auto name = read_element_name(item, path);
        if (std::find(moving.begin(), moving.end(), name) == moving.end()) {
            fail(item, path,
                 fmt::format("expected a moving joint of {}, found '{}'; it has {}",
                             robot.file().filename().string(), name, joined(moving)));
        }
        if (std::find(names.begin(), names.end(), name) != names.end()) {
            fail(item, path, fmt::format("expected each joint once, found '{}' again", name));
        }
        names.push_back(std::move(name));
    }
    std::vector<std::string> unnamed;
    std::copy_if(moving.begin(), moving.end(), std::back_inserter(unnamed), [&names](const auto& name) {
        return std::find(names.begin(), names.end(), name) == names.end();
    });
    if (!unnamed.empty()) fail_unnamed(list, path, robot, moving, unnamed);
    if (names.empty() || names.size() > wire::kJointsPerSample) {
        fail(list, path,
             fmt::format("expected 1 to {} joints, found {} in {}{}", wire::kJointsPerSample, names.size(),
                         robot.file().filename().string(),
                         names.empty() ? "" : ": make those that stay as they are type=\"fixed\" there"));
    }
    return names;
}

JointSource read_joints(const Value& value, const UrdfDocument& robot, const Rig& rig) {
    const Table table(value, "joints", {"node_id", "names", "rate_hz"});
    JointSource joints;
    joints.node_id = table.integer<std::uint8_t>("node_id", {1, kUnconfiguredNodeId - 1});
    for (const Node& node : rig.nodes) {
        if (node.config.node_id != joints.node_id) continue;
        table.fail("node_id", fmt::format("expected a unique id, found {}: node '{}' has it", joints.node_id,
                                          node.name));
    }
    joints.joints = read_joint_names(table, robot, rig.base_link);
    joints.rate_hz = table.number("rate_hz", {1.0, 1000.0});
    return joints;
}

RangeLimits read_range_limits(const Value& value) {
    // SENSOR_HEALTH reports a bound of up to 16.32 ms, which also stands for all greater values. The limit
    // must be below it.
    constexpr Range<double> kUncertaintyMs{0.1, 16.0};
    const Table table(value, "range_limits", {"min_m", "max_m", "sigma_max_m", "time_uncertainty_max_ms"});
    RangeLimits limits;
    limits.min_m = table.number("min_m", {0.0, 8.0}, limits.min_m);
    limits.max_m = table.number("max_m", {0.0, 8.0}, limits.max_m);
    limits.sigma_max_m = table.number("sigma_max_m", {0.001, 1.0}, limits.sigma_max_m);
    limits.time_uncertainty_max_ms =
        table.number("time_uncertainty_max_ms", kUncertaintyMs, limits.time_uncertainty_max_ms);
    if (!(limits.min_m < limits.max_m)) table.fail("max_m", "expected more than min_m");
    return limits;
}

void refuse_overloaded_bus(const Table& top, const Rig& rig) {
    const double load = can_load(rig);
    if (load <= wire::kBusLoadLimit) return;
    top.fail(
        "bus",
        fmt::format("expected a CAN load of at most {:.0f} %, found {:.1f} % in the worst case: use a longer "
                    "inter_measurement_ms, a higher bitrate, can_fd, or fewer sensors",
                    100.0 * wire::kBusLoadLimit, 100.0 * load));
}

Rig read_checked(const FilePlace& file, const std::filesystem::path& urdf_instead) {
    Rig rig;
    const Value document = load_with_extends(file, &rig.extended_files);
    // `extends` is already removed; it is listed for the hint about an unknown key.
    const Table top(document, "",
                    {"name", "robot", "T_map_base", "bus", "range_limits", "joints", "camera",
                     "sensor_defaults", "nodes", "extends"});
    rig.name = top.folder_name("name");
    const Table robot(
        top.require("robot"), "robot",
        {"urdf", "base_link", "link_padding_m", "fits_capsules", "attached_capsules", "links_without_body",
         "links_ignored_by_sensors", "depth_self_margin_m", "range_self_margin_m"});
    const UrdfDocument urdf = read_robot(robot, urdf_instead, rig);
    read_self_filter(robot, urdf, rig);
    read_attached_capsules(robot, urdf, rig);
    read_links_without_body(robot, urdf, rig);
    if (const Value* pose = top.find("T_map_base")) {
        rig.T_map_base = read_pose(*pose, "T_map_base", {.reach_m = kRoomReachM});
    }
    rig.bus = read_bus(top.require("bus"));
    if (const Value* limits = top.find("range_limits")) rig.range_limits = read_range_limits(*limits);
    if (const Value* camera = top.find("camera")) rig.camera = read_camera(*camera);
    rig.nodes = read_nodes(top.require("nodes"), "nodes",
                           {urdf, rig.base_link, rig.bus, top.find("sensor_defaults")});
    rig.joints = read_joints(top.require("joints"), urdf, rig);
    refuse_overloaded_bus(top, rig);
    return rig;
}

}  // namespace

std::string RigError::message() const {
    std::string place = file.string();
    if (line > 0) place += fmt::format(":{}", line);
    if (line > 0 && column > 0) place += fmt::format(":{}", column);
    return key.empty() ? fmt::format("{}: {}", place, what) : fmt::format("{}: {}: {}", place, key, what);
}

Result<Rig, RigError> read_rig(const FilePlace& file, const std::filesystem::path& urdf_instead) {
    try {
        return read_checked(confined_to_recording(file), urdf_instead);
    } catch (const Fault& fault) {
        return unexpected(fault.error);
    }
}

}  // namespace octoskin::rig
