#include "hw/rigfile/urdf_document.hpp"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <tinyxml2.h>
#include <urdf_model/joint.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/unopened_file.hpp"
#include "hw/rigfile/urdf_counted.hpp"
#include "hw/rigfile/urdf_xml.hpp"

namespace octoskin::rig {
namespace {

constexpr std::size_t kFileBytesMax = 16U << 20U;

/// Captures console_bridge's output during its lifetime: urdfdom reports errors only there.
class CapturedLog final : public console_bridge::OutputHandler {
  public:
    CapturedLog() : previous_(console_bridge::getOutputHandler()) { console_bridge::useOutputHandler(this); }
    ~CapturedLog() override { console_bridge::useOutputHandler(previous_); }
    CapturedLog(const CapturedLog&) = delete;
    CapturedLog& operator=(const CapturedLog&) = delete;

    void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
        if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
        errors_ += (errors_.empty() ? "" : "; ") + text;
    }
    [[nodiscard]] const std::string& errors() const noexcept { return errors_; }

  private:
    console_bridge::OutputHandler* previous_;
    std::string errors_;
};

/// Whether the text is UTF-16: by its byte order mark, or by the zero byte in the first character.
bool is_utf16(std::string_view text) {
    using namespace std::string_view_literals;
    const std::string_view beginning = text.substr(0, 2);
    return beginning == "\xFF\xFE"sv || beginning == "\xFE\xFF"sv || beginning == "<\0"sv ||
           beginning == "\0<"sv;
}

/// The model, or urdfdom's messages if it has none.
std::pair<urdf::ModelInterfaceSharedPtr, std::string> parse(const std::string& text) {
    CapturedLog log;
    try {
        auto model = urdf::parseURDF(text);
        // For some errors urdfdom only logs a message and returns an incomplete model.
        if (!log.errors().empty()) model = nullptr;
        return {std::move(model), log.errors()};
    } catch (const std::exception& exception) {
        return {nullptr, exception.what()};
    }
}

constexpr double kOriginMax_m = 10.0;             ///< no arm's link is longer
constexpr double kTurnMax_rad = 4.0 * 3.1415927;  ///< no arm's joint turns further than twice round

bool is_within(double value, double max) {
    return std::abs(value) <= max;  // false for NaN
}

/// Normalises an axis whose length is 1 to three digits, as in hand-written files.
void make_exact(urdf::Vector3& axis) {
    constexpr double kWritten = 1e-3;
    const double length = std::hypot(axis.x, axis.y, axis.z);
    if (is_within(length - 1.0, kWritten)) axis = {axis.x / length, axis.y / length, axis.z / length};
}

/// An error if a joint seems to be in millimetres or degrees.
std::optional<Error> unit_fault(const urdf::Joint& joint) {
    const urdf::Vector3& at = joint.parent_to_joint_origin_transform.position;
    if (!is_within(at.x, kOriginMax_m) || !is_within(at.y, kOriginMax_m) || !is_within(at.z, kOriginMax_m)) {
        return Error{ErrorCode::out_of_range,
                     fmt::format("expected an origin in metres, up to {:g}", kOriginMax_m),
                     fmt::format("({:g}, {:g}, {:g})", at.x, at.y, at.z), "is it written in millimetres?"};
    }
    if (!joint.limits) return std::nullopt;
    const auto found = [&joint] {
        return fmt::format("{:g} to {:g}", joint.limits->lower, joint.limits->upper);
    };
    const auto outside = [&](double max) {
        return !is_within(joint.limits->lower, max) || !is_within(joint.limits->upper, max);
    };
    if (joint.type == urdf::Joint::REVOLUTE && outside(kTurnMax_rad)) {
        return Error{ErrorCode::out_of_range, "expected limits in radians, at most two turns", found(),
                     "are they written in degrees?"};
    }
    if (joint.type == urdf::Joint::PRISMATIC && outside(kOriginMax_m)) {
        return Error{ErrorCode::out_of_range,
                     fmt::format("expected limits in metres up to {:g}", kOriginMax_m), found(),
                     "are they written in millimetres?"};
    }
    return std::nullopt;
}

}  // namespace

Result<std::string, Error> read_urdf_text(const FilePlace& file) {
    const auto failed = [&file](Error error) {
        error.file = file.shown();
        return unexpected(std::move(error));
    };
    auto text = file.read(kFileBytesMax);
    if (!text) return failed(unopened_file(text.error(), "URDF"));
    if (text->size() > kFileBytesMax) {
        return failed(
            {ErrorCode::too_large, fmt::format("expected at most {} bytes", kFileBytesMax), "more"});
    }
    return std::move(*text);
}

Result<UrdfDocument, Error> UrdfDocument::read(const FilePlace& place) {
    const auto text = read_urdf_text(place);
    const std::filesystem::path file = place.shown();
    if (!text) return unexpected(text.error());
    if (is_utf16(*text)) {
        return unexpected(Error{.code = ErrorCode::unsupported,
                                .what = "is in UTF-16",
                                .remedy = "save it as UTF-8 (`iconv -f UTF-16 -t UTF-8 FILE > NEW_FILE`)",
                                .file = file});
    }
    // An untrusted rig may name any file of this machine: its content is not shown.
    if (text->find("<robot") == std::string::npos) return unexpected(no_robot_in(file));
    tinyxml2::XMLDocument xml;
    const auto robot = parse_robot(file, *text, xml);
    if (!robot) return unexpected(robot.error());
    auto outline = UrdfOutline::read(file, **robot);
    if (!outline) return unexpected(outline.error());
    UrdfDocument document;
    document.file_ = file;
    document.outline_ = std::move(outline).value();
    const auto counted = counted_urdf(file, **robot);
    if (!counted) return unexpected(counted.error());
    auto [model, complaint] = parse(*counted);
    if (!model || !model->getRoot()) {
        return unexpected(Error{
            .code = ErrorCode::bad_value,
            .what = "not a usable URDF: " + (complaint.empty() ? "no robot found" : complaint),
            .remedy = complaint.find("No name given for the robot") == std::string::npos
                          ? ""
                          : "name it in <robot name=\"...\">. If a xacro was expanded, it may only define "
                            "macros: expand the file that uses them",
            .file = file});
    }
    std::vector<ElementFault> faults;
    for (const auto& [name, joint] : model->joints_) {
        make_exact(joint->axis);
        if (auto fault = unit_fault(*joint))
            faults.push_back({document.error("joint", name, *std::move(fault)), "its numbers"});
    }
    if (!faults.empty()) return unexpected(one_error_of(std::move(faults)));
    document.model_ = std::move(model);
    return document;
}

std::optional<std::string> UrdfDocument::joint_moving(const std::string& link) const {
    const auto is_moving = [](int type) {
        return type == urdf::Joint::REVOLUTE || type == urdf::Joint::CONTINUOUS ||
               type == urdf::Joint::PRISMATIC;
    };
    for (auto at = model_->links_.at(link); at->parent_joint != nullptr;
         at = model_->links_.at(at->parent_joint->parent_link_name)) {
        if (is_moving(at->parent_joint->type)) return at->parent_joint->name;
    }
    return std::nullopt;
}

bool UrdfDocument::is_below(const std::string& base_link, const std::string& link) const {
    const auto& links = model_->links_;
    // The outline guarantees that every path to the root ends.
    for (auto at = links.find(link); at != links.end();) {
        if (at->first == base_link) return true;
        const auto& joint = at->second->parent_joint;
        at = joint ? links.find(joint->parent_link_name) : links.end();
    }
    return false;
}

std::vector<std::string> UrdfDocument::link_names(const std::string& base_link) const {
    std::vector<std::string> names;
    for (const auto& [name, link] : model_->links_) {
        if (base_link.empty() || is_below(base_link, name)) names.push_back(name);
    }
    return names;
}

std::vector<std::string> UrdfDocument::moving_joints(const std::string& base_link) const {
    std::vector<std::string> names;
    for (const auto& [name, joint] : model_->joints_) {
        const bool is_its_own = joint->type != urdf::Joint::FIXED && !joint->mimic;
        if (is_its_own && is_below(base_link, joint->parent_link_name)) names.push_back(name);
    }
    return names;
}

std::vector<JointOfLink> UrdfDocument::moving_joints_outward(const std::string& base_link) const {
    const auto depth_of = [this](const JointOfLink& joint) {
        std::size_t depth = 0;
        const urdf::Link* link = model_->links_.at(joint.child_link).get();
        for (; link->getParent(); link = link->getParent().get()) ++depth;
        return depth;
    };
    std::vector<JointOfLink> joints;
    for (const std::string& name : moving_joints(base_link))
        joints.push_back({name, model_->joints_.at(name)->child_link_name});
    std::ranges::stable_sort(joints, {}, depth_of);
    return joints;
}

}  // namespace octoskin::rig
