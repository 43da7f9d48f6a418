#include "host/apps/robot/body_picture.hpp"

#include <fmt/format.h>

#include "host/apps/robot/svg_view.hpp"
#include "host/core/body_fit/bounding_box.hpp"
#include "host/core/text/markup.hpp"
#include "host/core/text/printable.hpp"

namespace octoskin {
namespace {

constexpr double kSide_px = 300.0;
constexpr double kHead_px = 26.0;

Eigen::AlignedBox3d box_of_all(const LinkBody& link) {
    return box_of(link.fit->capsules).merged(box_of(link.mesh));
}

std::string drawn(const SvgView& view, const SurfaceMesh& mesh) {
    std::string path;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) path += view.path(mesh.corners(i), true);
    return fmt::format("<path class=\"mesh\" d=\"{}\"/>\n", path);
}

std::string row_of(const LinkBody& link, double top_px) {
    const Eigen::AlignedBox3d box = box_of_all(link);
    std::string row = fmt::format(
        "<text x=\"8\" y=\"{:.0f}\">{}: {} capsules; a panel is {:.0f} mm wide; {}; {}; {}</text>\n",
        top_px + 18.0, escaped(printable(link.link)), link.fit->capsules.size(), 1e3 * box.sizes().maxCoeff(),
        kThreeViews[0].name, kThreeViews[1].name, kThreeViews[2].name);
    for (std::size_t i = 0; i < kThreeViews.size(); ++i) {
        const SvgView view(box, kThreeViews[i], kSide_px, kSide_px * static_cast<double>(i),
                           top_px + kHead_px);
        row += drawn(view, link.mesh);
        for (const PosedCapsule& capsule : link.fit->capsules) row += view.capsule("fit", capsule);
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
