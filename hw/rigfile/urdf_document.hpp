// Reads a robot description with urdfdom and converts urdfdom's messages into errors. The only caller of its
// parser.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/urdf_outline.hpp"

namespace urdf {
class ModelInterface;
}

namespace octoskin::rig {

/// The file's text. Errors, for the user: it cannot be read, or is over 16 MiB.
[[nodiscard]] Result<std::string, Error> read_urdf_text(const FilePlace& file);

struct JointOfLink {
    std::string joint;
    std::string child_link;
};

class UrdfDocument {
  public:
    /// Errors: unreadable, in UTF-16, over 16 MiB, those of UrdfOutline and counted_urdf(), errors of urdfdom
    /// in the elements used (a joint without its link, two roots, a repeated name), signs of millimetres (an
    /// origin or a sliding limit beyond 10 m) or of degrees (a limit beyond two turns). The message contains
    /// urdfdom's text. urdfdom prints nothing. Not to be called from two threads at once: urdfdom's log is
    /// global.
    [[nodiscard]] static Result<UrdfDocument, Error> read(const FilePlace& file);

    [[nodiscard]] const urdf::ModelInterface& model() const noexcept { return *model_; }
    [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
    /// True if `link` is `base_link` or below it; false also if the robot has no such links.
    /// The joint that moves a link against the root: revolute, continuous or prismatic, the nearest above it;
    /// empty if there is none. The link must exist (asserted).
    [[nodiscard]] std::optional<std::string> joint_moving(const std::string& link) const;
    [[nodiscard]] bool is_below(const std::string& base_link, const std::string& link) const;
    /// At or below `base_link`, by name; all of them if that is empty.
    [[nodiscard]] std::vector<std::string> link_names(const std::string& base_link = {}) const;
    /// The joints below `base_link` with a position of their own, by name: neither fixed nor with a <mimic>.
    [[nodiscard]] std::vector<std::string> moving_joints(const std::string& base_link) const;
    /// The same joints from the base to the tips, each with the link that it carries.
    [[nodiscard]] std::vector<JointOfLink> moving_joints_outward(const std::string& base_link) const;
    /// An error about one element ("joint", "panda_joint3"), with its line if the element exists.
    [[nodiscard]] Error error(std::string_view tag, std::string_view name, Error error) const {
        return outline_.error(tag, name, std::move(error));
    }

    /// Whether a joint has a <limit> without `upper`, for which urdfdom uses 0.
    [[nodiscard]] bool is_upper_missing(std::string_view joint) const {
        return outline_.is_upper_missing(joint);
    }

  private:
    std::filesystem::path file_;
    UrdfOutline outline_;
    std::shared_ptr<const urdf::ModelInterface> model_;
};

}  // namespace octoskin::rig
