#include <fmt/format.h>

#include "host/lab/report/sections.hpp"
#include "host/lab/report/text.hpp"

namespace octoskin::report {
namespace {

/// No text of a script ends the element that it is in. In JSON and in JavaScript's strings "<\/" is "</".
std::string inside_script(std::string_view text) {
    std::string safe;
    safe.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        safe += text[i];
        if (text[i] == '<' && text.substr(i + 1).starts_with('/')) safe += '\\';
    }
    return safe;
}

std::string map_button(const ViewedMap& map, std::size_t number) {
    return fmt::format("<button type=\"button\" data-map=\"{}\" aria-pressed=\"{}\">{}</button>\n", number,
                       number == 0, escaped(map.title));
}

/// Payloads in a line each, which no JSON parser has to hold twice.
std::string map_data(const ViewedMap& map, std::size_t number) {
    std::string html =
        fmt::format("<script type=\"text/plain\" class=\"map-data\" data-map=\"{}\">\n", number);
    for (const std::string& payload : map.payloads) {
        html += base64({payload.begin(), payload.end()});
        html += '\n';
    }
    return html + "</script>\n";
}

}  // namespace

std::string view_section(const ReportInput& input) {
    if (input.viewed_maps.empty() || input.view_script.empty()) return {};
    std::string html = fmt::format(
        "<section id=\"view\">\n<h2>The maps in three dimensions</h2>\n"
        "<p>The maps of seed {}: drag to turn, scroll or pinch to zoom; with the keyboard the arrow keys, "
        "plus and minus. A click on a voxel, or Enter in the middle, shows what the map holds about it.</p>\n"
        "<div class=\"map-view\">\n<div class=\"map-buttons\" role=\"group\" aria-label=\"Map\">\n",
        input.picture_seed);
    for (std::size_t i = 0; i < input.viewed_maps.size(); ++i) html += map_button(input.viewed_maps[i], i);
    html +=
        "</div>\n<div class=\"map-canvas\"></div>\n<p class=\"soft map-said\" aria-live=\"polite\">Needs "
        "JavaScript and WebGL.</p>\n";
    for (std::size_t i = 0; i < input.viewed_maps.size(); ++i) html += map_data(input.viewed_maps[i], i);
    return html + "</div>\n<script>" + inside_script(input.view_script) + "</script>\n</section>\n";
}

}  // namespace octoskin::report
