#include <fmt/format.h>

#include "host/lab/report/sections.hpp"
#include "host/lab/report/text.hpp"

namespace octoskin::report {
namespace {

/// A click enlarges the picture to the window, another one ends that.
std::string picture(const Image& image, std::string_view title, std::string_view side) {
    return fmt::format(
        "<label class=\"zoom\"><input type=\"checkbox\" aria-label=\"Enlarge\"><img width=\"{}\" "
        "height=\"{}\" alt=\"{}, {}\" src=\"data:image/png;base64,{}\"><span class=\"side\">{}</span>"
        "</label>\n",
        image.width, image.height, escaped(title), side, base64(encode_png(image)), side);
}

std::string figure(const PicturePair& pair) {
    return fmt::format(
        "<figure><div class=\"pair\">\n{}{}</div>\n<figcaption><b>{}.</b> {}</figcaption></figure>\n",
        picture(pair.front, pair.title, "from the robot’s side"),
        picture(pair.back, pair.title, "from the far side"), escaped(pair.title), escaped(pair.caption));
}

constexpr std::string_view kLegend =
    R"(<ul class="legend">
<li><i class="swatch-right"></i>occupied, and a surface is there</li>
{}<li><i class="swatch-wrong"></i>occupied, but no surface is there</li>
<li><i class="swatch-lost"></i>free, but a surface is there</li>
<li><i class="swatch-floor"></i>floor, not judged</li>
</ul>
)";

constexpr std::string_view kOrigin =
    R"(<p class="soft">Every cube is one occupied voxel of the map file itself, ray-cast without changes; space that is free or
unknown is not drawn. Click a picture to enlarge it.</p>
)";

}  // namespace

std::string pictures_section(const ReportInput& input) {
    std::string html = "<section id=\"pictures\">\n<h2>The scene and its maps</h2>\n";
    if (input.pictures.empty()) {
        return html + "<p>No pictures were made in this run.</p>\n</section>\n";
    }
    html += fmt::format("<div class=\"pictures scene\">\n{}</div>\n<h3>Maps of seed {}</h3>\n",
                        figure(input.pictures.front()), input.picture_seed);
    const std::string hidden = hidden_objects_text(input);
    html += fmt::format(
        fmt::runtime(kLegend),
        hidden.empty() ? ""
                       : fmt::format("<li><i class=\"swatch-hidden\"></i>the same, on {}</li>\n", hidden));
    html += "<div class=\"pictures\">\n";
    for (std::size_t i = 1; i < input.pictures.size(); ++i) {
        html += figure(input.pictures[i]);
    }
    return html + "</div>\n" + std::string(kOrigin) + "</section>\n";
}

}  // namespace octoskin::report
