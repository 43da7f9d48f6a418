#include "host/lab/report/report.hpp"

#include "host/lab/report/report_style.hpp"
#include "host/lab/report/sections.hpp"
#include "host/lab/report/text.hpp"

namespace octoskin::report {

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
    html += view_section(input);
    html += paper_section(input);
    html += paired_section(input);
    html += unknown_section(input);
    html += metrics_section(input);
    html += thickness_section(input);
    html += free_section(input);
    html += update_section(input);
    html += calibration_section(input);
    html += inputs_section(input);
    html += idealisations_section(input);
    html += times_section(input);
    html += reproduce_section(input);
    return html + "</main>\n</body>\n</html>\n";
}

}  // namespace octoskin::report
