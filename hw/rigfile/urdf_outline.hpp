// The names in a URDF file and the lines they stand at, read before urdfdom sees the file: urdfdom knows no
// lines, leaks what hangs in a loop, and its XML reader recurses as deep as the file goes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"

namespace tinyxml2 {
class XMLElement;
}

namespace octoskin::rig {

class UrdfOutline {
  public:
    /// Errors, each with its line: a xacro element, more than 4,000 links and joints, an <origin rpy> of more
    /// than a turn, a link that hangs from two joints, a loop. O(n log n). `file` is for the messages only.
    [[nodiscard]] static Result<UrdfOutline, RigError> read(const std::filesystem::path& file,
                                                            const tinyxml2::XMLElement& robot);

    /// An error about one element ("joint", "panda_joint3"), with its line if there is such an element.
    [[nodiscard]] RigError error(std::string_view tag, std::string_view name, std::string what) const;

    /// Whether a joint has a <limit> that says no `upper`, for which urdfdom takes 0.
    [[nodiscard]] bool is_upper_missing(std::string_view joint) const;

  private:
    struct Element {
        std::string tag;
        std::string name;
        int line = 0;
        std::string parent_link;  ///< of a joint
        std::string child_link;
        bool is_upper_missing = false;  ///< of a joint with a <limit>
    };
    [[nodiscard]] std::optional<RigError> find_loop() const;

    std::filesystem::path file_;
    std::vector<Element> elements_;  ///< links and joints in the order of the file
};

}  // namespace octoskin::rig
