#include <fmt/format.h>

#include "host/lab/report/sections.hpp"
#include "host/lab/report/text.hpp"

namespace octoskin::report {
namespace {

std::string counter_rows(const ReportCounters& inputs) {
    std::uint64_t rejected = 0;
    std::string rows;
    for (const auto& [counter, count] : inputs.rejected) {
        rejected += count;
        if (count > 0) {
            rows += fmt::format("<tr><td class=\"name\">&emsp;{}</td><td></td><td></td><td>{}</td></tr>\n",
                                escaped(counter), count_text(static_cast<double>(count)));
        }
    }
    const bool is_balanced = inputs.received == inputs.used + rejected;
    return fmt::format(
               "<tr><th>{}{}</th><td>{}</td><td>{}</td><td>{}</td></tr>\n", escaped(inputs.input),
               is_balanced ? "" : " (does not balance)", count_text(static_cast<double>(inputs.received)),
               count_text(static_cast<double>(inputs.used)), count_text(static_cast<double>(rejected))) +
           rows;
}

std::string seeds_text(const std::vector<std::uint64_t>& seeds) {
    std::string text;
    for (const auto seed : seeds) {
        text += fmt::format("{}{}", text.empty() ? "" : ", ", seed);
    }
    return text;
}

constexpr std::string_view kInputsText =
    R"(<section id="inputs">
<h2>Input counters</h2>
<p>Each input is used or adds one to exactly one named counter: in = used + sum of rejected. Seed {}.</p>
<div class="table"><table>
<thead><tr><th>input</th><th>in</th><th>used</th><th>rejected</th></tr></thead>
<tbody>
)";

constexpr std::string_view kIdealisationsText =
    R"(<section id="idealisations">
<h2>Idealisations</h2>
<p>The simulation is simpler than a robot cell in these ways:</p>
<ul>
)";

constexpr std::string_view kTimesText =
    R"(<section id="times">
<h2>Time spent</h2>
<div class="table"><table>
<thead><tr><th>part</th><th>wall, s</th><th>CPU, s</th></tr></thead>
<tbody>
)";

constexpr std::string_view kTimesCaveat =
    R"(<p class="soft">Summed over all seeds; parts may overlap on several threads.</p>
)";

}  // namespace

std::string inputs_section(const ReportInput& input) {
    std::string html = fmt::format(fmt::runtime(kInputsText), input.picture_seed);
    for (const auto& inputs : input.inputs) {
        html += counter_rows(inputs);
    }
    return html + "</tbody></table></div>\n</section>\n";
}

std::string idealisations_section(const ReportInput& input) {
    std::string html(kIdealisationsText);
    for (const auto& sentence : input.idealisations) {
        html += fmt::format("<li>{}</li>\n", escaped(sentence));
    }
    return html + "</ul>\n</section>\n";
}

std::string times_section(const ReportInput& input) {
    std::string html(kTimesText);
    for (const auto& time : input.results.times) {
        html += fmt::format("<tr><th>{}</th><td>{}</td><td>{}</td></tr>\n", escaped(time.part),
                            ratio_text(time.wall_s, 2), ratio_text(time.cpu_s, 2));
    }
    return html + "</tbody></table></div>\n" + std::string(kTimesCaveat) + "</section>\n";
}

std::string reproduce_section(const ReportInput& input) {
    std::string html = "<section id=\"reproduce\">\n<h2>How to reproduce this</h2>\n<pre>";
    for (const auto& command : input.reproduce) {
        html += escaped(command) + "\n";
    }
    html += fmt::format("</pre>\n<p>Seeds {}. The same seeds give the same maps, byte for byte.</p>\n",
                        seeds_text(input.results.seeds));
    html += "<div class=\"table\"><table>\n<tbody>\n";
    for (const auto& [key, value] : input.results.provenance) {
        html += fmt::format("<tr><th>{}</th><td class=\"name\"><code>{}</code></td></tr>\n", escaped(key),
                            escaped(value));
    }
    return html + "</tbody></table></div>\n</section>\n";
}

}  // namespace octoskin::report
