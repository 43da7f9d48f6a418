#include "host/apps/robot/body_picture.hpp"

#include <fmt/format.h>

#include <array>

#include "host/core/body_fit/bounding_box.hpp"
#include "host/core/text/markup.hpp"
#include "host/core/text/printable.hpp"

namespace octoskin {
namespace {

constexpr double kSide_px = 300.0;
constexpr double kHead_px = 26.0;
constexpr double kEdge_px = 8.0;

/// The axes that a view shows to the right and upwards.
struct View {
    Eigen::Index right;
    Eigen::Index up;
    const char* name;
};
constexpr std::array kViews{View{0, 2, "x, z"}, View{1, 2, "y, z"}, View{0, 1, "x, y"}};

Eigen::AlignedBox3d box_of_all(const LinkBody& link) {
    return box_of(link.fit->capsules).merged(box_of(link.mesh));
}

/// A view of one link, with its corner at (x, y).
class Panel {
  public:
    Panel(const Eigen::AlignedBox3d& box, const View& view, double x, double y)
        : view_(view),
          px_per_m_((kSide_px - 2.0 * kEdge_px) / box.sizes().maxCoeff()),
          middle_(box.center()),
          x_(x + 0.5 * kSide_px),
          y_(y + 0.5 * kSide_px) {}

    [[nodiscard]] std::string mesh(const SurfaceMesh& mesh) const {
        std::string path;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const auto [a, b, c] = mesh.corners(i);
            path += fmt::format("M{}L{}L{}Z", at(a), at(b), at(c));
        }
        return fmt::format("<path class=\"mesh\" d=\"{}\"/>\n", path);
    }

    /// Seen from far away, a capsule is a line with round ends.
    [[nodiscard]] std::string capsule(const PosedCapsule& capsule) const {
        return fmt::format("<path class=\"fit\" stroke-width=\"{:.1f}\" d=\"M{}L{}\"/>\n",
                           2.0 * capsule.radius_m * px_per_m_, at(capsule.p_a), at(capsule.p_b));
    }

  private:
    [[nodiscard]] std::string at(const Eigen::Vector3d& point) const {
        return fmt::format("{:.1f},{:.1f}", x_ + px_per_m_ * (point[view_.right] - middle_[view_.right]),
                           y_ - px_per_m_ * (point[view_.up] - middle_[view_.up]));
    }

    View view_;
    double px_per_m_;
    Eigen::Vector3d middle_;
    double x_;
    double y_;
};

std::string row_of(const LinkBody& link, double top_px) {
    const Eigen::AlignedBox3d box = box_of_all(link);
    std::string row = fmt::format(
        "<text x=\"8\" y=\"{:.0f}\">{}: {} capsules; a panel is {:.0f} mm wide; {}; {}; {}</text>\n",
        top_px + 18.0, escaped(printable(link.link)), link.fit->capsules.size(), 1e3 * box.sizes().maxCoeff(),
        kViews[0].name, kViews[1].name, kViews[2].name);
    for (std::size_t i = 0; i < kViews.size(); ++i) {
        const Panel panel(box, kViews[i], kSide_px * static_cast<double>(i), top_px + kHead_px);
        row += panel.mesh(link.mesh);
        for (const PosedCapsule& capsule : link.fit->capsules) row += panel.capsule(capsule);
    }
    return row;
}

}  // namespace

std::string body_picture(const RobotFit& robot) {
    std::string rows;
    double top_px = 0.0;
    for (const LinkBody& link : robot.links) {
        if (!link.fit) continue;
        rows += row_of(link, top_px);
        top_px += kSide_px + kHead_px;
    }
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n"
        "<style>text {{ font: 13px sans-serif }} .mesh {{ fill: #888; fill-opacity: .35; stroke: #555; "
        "stroke-width: .3 }} "
        ".fit {{ stroke: #f80; stroke-opacity: .25; stroke-linecap: round; fill: none }}</style>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{2}</svg>\n",
        3.0 * kSide_px, top_px, rows);
}

}  // namespace octoskin
