#include "host/apps/report/report.hpp"

#include "host/apps/report/report_style.hpp"
#include "host/apps/report/sections.hpp"
#include "host/apps/report/text.hpp"

namespace octoskin::report {

std::vector<std::string> experiment_idealisations() {
    return {
        ("The range sensors run in long mode with a 20 ms timing budget every 33 ms. ST's driver allows it; "
         "the datasheet asks for at least 33 ms, and for 140 ms to reach 4 m."),
        ("Their noise (2 cm) and reach (0.04 to 4 m) are set by the simulated world, not by budget, target "
         "or ambient light."),
        ("A range is measured along one ideal ray. The real sensor sees a cone of 27 degrees and answers "
         "with something like the nearest part of it."),
        ("The camera's noise (3 cm along the ray, independent from pixel to pixel) knows no flying pixels, "
         "no reflections and no dependence on distance or material."),
        ("Extrinsics, link lengths and joint angles are exactly those of the rig file and the robot "
         "description."),
        "Nothing in the scene moves but the arm.",
    };
}

std::string report_html(const ReportInput& input) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>";
    html += escaped(input.title);
    html += "</title>\n<style>";
    html += report_style();
    html += "</style>\n</head>\n<body>\n<main>\n";
    html += headline_section(input);
    html += pictures_section(input);
    html += paper_section(input);
    html += paired_section(input);
    html += metrics_section(input);
    html += update_section(input);
    html += calibration_section(input);
    html += account_section(input);
    html += idealisations_section(input);
    html += times_section(input);
    html += reproduce_section(input);
    return html + "</main>\n</body>\n</html>\n";
}

}  // namespace octoskin::report
