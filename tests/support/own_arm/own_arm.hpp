// An arm whose links are meshes of our own, as files.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/scratch_folder.hpp"

namespace octoskin::testing_support {

struct Ring {
    double height_m;
    double radius_m;
};

/// A solid of revolution about z with square flanks, like the housings of an arm, as binary STL.
inline std::string turned_stl(const std::vector<Ring>& rings, double y_scale) {
    constexpr int kSides = 24;
    std::vector<std::array<Eigen::Vector3d, 3>> triangles;
    const auto at = [&](const Ring& ring, int side) {
        const double angle = 2.0 * std::numbers::pi * side / kSides;
        return Eigen::Vector3d(ring.radius_m * std::cos(angle), y_scale * ring.radius_m * std::sin(angle),
                               ring.height_m);
    };
    for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
        for (int side = 0; side < kSides; ++side) {
            triangles.push_back({at(rings[i], side), at(rings[i], side + 1), at(rings[i + 1], side)});
            triangles.push_back({at(rings[i], side + 1), at(rings[i + 1], side + 1), at(rings[i + 1], side)});
        }
    }
    std::string bytes(80, ' ');
    const auto add = [&bytes](const auto& value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    add(static_cast<std::uint32_t>(triangles.size()));
    for (const auto& triangle : triangles) {
        for (int i = 0; i < 3; ++i) add(0.0F);
        for (const Eigen::Vector3d& corner : triangle)
            for (const double value : corner) add(static_cast<float>(value));
        add(std::uint16_t{0});
    }
    return bytes;
}

/// Four links: a pedestal, two arms with a wide shoulder and elbow, and a flat hand.
class OwnArm {
  public:
    OwnArm() {
        folder_.write("pedestal.stl",
                      turned_stl({{0, 0}, {0, 0.1}, {0.05, 0.1}, {0.05, 0.06}, {0.3, 0.06}, {0.3, 0}}, 1));
        folder_.write("arm.stl", turned_stl({{-0.07, 0},
                                             {-0.07, 0.075},
                                             {0.07, 0.075},
                                             {0.1, 0.05},
                                             {0.35, 0.045},
                                             {0.38, 0.06},
                                             {0.46, 0.06},
                                             {0.46, 0}},
                                            1.2));
        folder_.write("hand.stl", turned_stl({{0, 0}, {0, 0.05}, {0.06, 0.09}, {0.1, 0.09}, {0.1, 0}}, 0.4));
        std::string urdf = "<robot name=\"own\">";
        for (const auto& [link, mesh] : {std::pair{"base", "pedestal"}, std::pair{"upper", "arm"},
                                         std::pair{"fore", "arm"}, std::pair{"hand", "hand"}})
            urdf += fmt::format(
                "<link name=\"{}\"><collision><geometry><mesh "
                "filename=\"{}.stl\"/></geometry></collision></link>",
                link, mesh);
        const auto joint = [&](const char* name, const char* parent, const char* child, const char* xyz,
                               const char* axis) {
            urdf += fmt::format(
                "<joint name=\"{}\" type=\"revolute\"><parent link=\"{}\"/><child link=\"{}\"/><origin "
                "xyz=\"{}\"/><axis xyz=\"{}\"/><limit lower=\"-1.4\" upper=\"1.4\" effort=\"1\" "
                "velocity=\"3\"/></joint>",
                name, parent, child, xyz, axis);
        };
        joint("shoulder", "base", "upper", "0 0 0.36", "0 1 0");
        joint("elbow", "upper", "fore", "0 0.02 0.46", "1 0 0");
        joint("wrist", "fore", "hand", "0 0 0.47", "0 1 0");
        urdf_ = folder_.write("own.urdf", urdf + "</robot>");
    }
    [[nodiscard]] const std::filesystem::path& urdf() const noexcept { return urdf_; }

  private:
    ScratchFolder folder_;
    std::filesystem::path urdf_;
};

}  // namespace octoskin::testing_support
