// The names in a URDF file with their lines, read before urdfdom parses it: urdfdom reports no lines, leaks
// links in a loop, and its XML reader recurses as deep as the file is nested.
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
    /// than a turn, a link with two parent joints, a loop. O(n log n). `file` is for the messages only.
    [[nodiscard]] static Result<UrdfOutline, Error> read(const std::filesystem::path& file,
                                                         const tinyxml2::XMLElement& robot);

    /// An error about one element ("joint", "panda_joint3"), with its line if the element exists.
    [[nodiscard]] Error error(std::string_view tag, std::string_view name, Error error) const;

    /// Whether a joint has a <limit> without `upper`, for which urdfdom uses 0.
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
    [[nodiscard]] std::optional<Error> find_loop() const;

    std::filesystem::path file_;
    std::vector<Element> elements_;  ///< links and joints in the order of the file
};

}  // namespace octoskin::rig
