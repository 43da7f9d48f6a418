#include "host/lab/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>

namespace octoskin::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Ten voxels of a cable, and one of a wall.
evaluation::SeenMetrics seen() {
    evaluation::SeenMetrics seen;
    seen.by_class[0] = {.voxels = 10,
                        .occupied = 1,
                        .free = 7,
                        .unknown = 2,
                        .body_2cm = {.spheres = 40, .free = 30},
                        .body_5cm = {.spheres = 40, .free = 11}};
    seen.by_class[5] = {.voxels = 1, .occupied = 1, .body_2cm = {.spheres = 4}, .body_5cm = {.spheres = 4}};
    seen.f1_seen = 0.912;
    return seen;
}

evaluation::Run judged(std::string configuration, std::string map, std::uint64_t seed, std::uint64_t missed,
                       double occluded_recall) {
    evaluation::Run run{std::move(configuration), std::move(map), seed, {}};
    run.metrics.occupied = 12345;
    run.metrics.missed = missed;
    run.metrics.precision = 0.98;
    run.metrics.f1 = 0.5 + occluded_recall;
    run.metrics.occluded_recall = occluded_recall;
    run.metrics.calibration[9] = {.count = 10, .probability_sum = 9.6, .occupied_count = 9};
    if (run.map != "proximity") run.metrics.seen = seen();
    return run;
}

/// Two by two; all but one are known.
evaluation::UnknownColumns columns(double unknown_m) {
    return {
        .edge_m = 0.5, .side = 2, .low_x_m = -0.5, .low_y_m = -0.5, .unknown_m = {0.0, unknown_m, 0.0, 0.0}};
}

ReportInput two_seeds() {
    const std::vector<evaluation::Run> runs = {
        judged("paper", "fused", 0, 1100, 0.12),  judged("robust", "depth", 0, 2000, 0.0),
        judged("robust", "fused", 0, 1400, 0.10), judged("robust", "depth", 1, 2200, 0.0),
        judged("robust", "fused", 1, 1580, 0.12),
    };
    ReportInput input;
    input.main_configuration = "robust";
    input.results = evaluation::collect(runs, {{"simulate", 12.5, 14.25}}, {{"world", "experiment.sdf"}});
    const Image dot{1, 1, {10, 20, 30, 255}};
    input.pictures = {{"The scene", "A room.", dot, dot}, {"Fused", "Both.", dot, dot}};
    input.inputs = {{"ranges", 100, 90, {{"no_target", 7}, {"stale", 3}, {"duplicate", 0}}}};
    input.results.is_papers_experiment = true;
    input.results.unknown_space = {.region = {{0.02, 0.0, 0.0}, 1.0, 0.0},
                                   .region_m3 = 2.1,
                                   .samples = {{0.0, 2.1, 2.0}, {10.0, 1.4, 0.75}},
                                   .pockets = {{.voxels = 900,
                                                .border_voxels = 90,
                                                .volume_m3 = 0.0576,
                                                .centre = {0.52, -0.3, 0.4},
                                                .nearest_border = {}}},
                                   .depth_columns = columns(0.9),
                                   .fused_columns = columns(0.6)};
    input.hidden_objects = {"cone"};
    input.idealisations = {"Nothing moves."};
    input.reproduce = {"octoskin-lab experiment --seeds 0 1"};
    return input;
}

/// Every start tag has its end tag, in order; the void elements of HTML have none. Empty if so.
std::string first_unbalanced_tag(const std::string& html) {
    const std::set<std::string> void_elements = {"meta", "img", "input", "br"};
    const std::regex tag("<(/?)([a-z][a-z0-9]*)((?:[^>\"]|\"[^\"]*\")*?)(/?)>");
    std::vector<std::string> open;
    for (std::sregex_iterator i(html.begin(), html.end(), tag), end; i != end; ++i) {
        const std::string name = (*i)[2];
        if (void_elements.contains(name) || (*i)[4].length() > 0) {
            continue;
        }
        if ((*i)[1].length() == 0) {
            open.push_back(name);
        } else if (open.empty() || open.back() != name) {
            return "</" + name + ">";
        } else {
            open.pop_back();
        }
    }
    return open.empty() ? "" : "<" + open.back() + ">";
}

TEST(Report, has_every_section) {
    const std::string html = report_html(two_seeds());
    for (const char* id : {"pictures", "paper", "paired", "unknown", "metrics", "thickness", "update",
                           "calibration", "inputs", "idealisations", "times", "reproduce"}) {
        EXPECT_THAT(html, HasSubstr(std::string("<section id=\"") + id + "\"")) << id;
    }
    EXPECT_THAT(html, HasSubstr("<h1>octoskin: what the camera cannot see</h1>"));
}

TEST(Report, loads_nothing_from_outside) {
    const std::string html = report_html(two_seeds());
    EXPECT_THAT(html, Not(HasSubstr("http://")));
    EXPECT_THAT(html, Not(HasSubstr("https://")));
    EXPECT_THAT(html, Not(HasSubstr("<script")));
    EXPECT_THAT(html, Not(HasSubstr("<link")));
    EXPECT_THAT(html, Not(HasSubstr("@import")));
    EXPECT_THAT(html, Not(HasSubstr("url(")));
    const std::regex source("(src|href|srcset)=\"([^\"]{0,15})");
    for (std::sregex_iterator i(html.begin(), html.end(), source), end; i != end; ++i) {
        EXPECT_EQ((*i)[2], "data:image/png;");
    }
}

TEST(Report, is_valid_utf8_and_balanced_html) {
    const std::string html = report_html(two_seeds());
    EXPECT_NO_THROW((void)nlohmann::json(html).dump()) << "the JSON library refuses what is not UTF-8";
    EXPECT_EQ(first_unbalanced_tag(html), "");
    EXPECT_TRUE(html.starts_with("<!DOCTYPE html>"));
    EXPECT_TRUE(html.ends_with("</html>\n"));
}

TEST(Report, says_first_what_fusion_found) {
    const std::string html = report_html(two_seeds());
    EXPECT_THAT(
        html,
        HasSubstr(
            "its own map contains 0.0\u00a0%; with the range sensors on the arm, the\nfused map contains "
            "11.0\u00a0%."));
    EXPECT_THAT(html, HasSubstr("2\u202f100 →</span> 1\u202f490"));
    EXPECT_THAT(html, HasSubstr("\u221229.0\u00a0%; \u2212610 ± 14, better in 2 of 2 seeds"));
}

TEST(Report, names_what_fusion_costs_beside_what_it_gains) {
    ReportInput input = two_seeds();
    for (auto& map : input.results.maps) {
        const bool is_fused = map.map == "fused";
        map.metrics["lost"] = evaluation::summarise({is_fused ? 860.0 : 470.0, is_fused ? 900.0 : 480.0});
    }
    EXPECT_THAT(report_html(input), HasSubstr("Lost: occupied voxels that the map calls free</div><div "
                                              "class=\"big\"><span class=\"from\">475 →</span> 880</div>"));
    EXPECT_THAT(report_html(input), HasSubstr("+85.3\u00a0%; +405 ± 21, better in 0 of 2 seeds"));
}

TEST(Report, shows_what_nobody_has_seen_and_where) {
    ReportInput input = two_seeds();
    const std::string html = report_html(input);
    EXPECT_THAT(html, HasSubstr("At the end 0.75 m³ are unknown; the camera alone leaves 1.40 m³."));
    EXPECT_THAT(html, HasSubstr("<td>1</td><td>57.6</td><td>0.50</td><td>−0.30</td><td>0.40</td>"));
    EXPECT_THAT(html, HasSubstr("<b>Depth camera only</b>, at the end, seen from above"));
    EXPECT_THAT(html, HasSubstr("unknown, from 0 m\n(no colour) to 0.9 m (full colour). The numbers are"));
    // The column at the lower right: in a picture the second row's second pixel. Two thirds of the camera's.
    const auto picture = [](std::uint8_t red, std::uint8_t green, std::uint8_t blue, std::uint8_t opacity) {
        Image image{2, 2, {}};
        for (const int pixel : {0, 1, 2, 3}) {
            const std::uint8_t own = pixel == 3 ? opacity : std::uint8_t{0};
            image.rgba.insert(image.rgba.end(), {red, green, blue, own});
        }
        return base64(encode_png(image));
    };
    EXPECT_THAT(html, HasSubstr(picture(0x2b, 0x6c, 0xb0, 255)));
    EXPECT_THAT(html, HasSubstr(picture(0x4b, 0x7f, 0x2b, 170)));
    input.results.unknown_space->depth_columns.reset();
    input.results.unknown_space->pockets.clear();
    for (auto& sample : input.results.unknown_space->samples) sample.depth_m3.reset();
    const std::string alone = report_html(input);
    EXPECT_THAT(alone, HasSubstr("At the end 0.75 m³ are unknown."));
    EXPECT_THAT(alone, HasSubstr("unknown, from 0 m\n(no colour) to 0.6 m (full colour)."));
    EXPECT_THAT(alone, HasSubstr(picture(0x4b, 0x7f, 0x2b, 255)));
    EXPECT_THAT(alone,
                Not(AllOf(HasSubstr("<b>Depth camera only</b>, at the end"), HasSubstr("The numbers are"))));
    EXPECT_EQ(first_unbalanced_tag(alone), "");
    input.results.unknown_space->samples.clear();
    EXPECT_THAT(report_html(input), Not(HasSubstr("<section id=\"unknown\"")));
}

TEST(Report, shows_thin_things_of_the_main_configuration) {
    const std::string html = report_html(two_seeds());
    EXPECT_THAT(
        html,
        HasSubstr("<tr><th>rod, 5 to 8 mm: Fused</th><td>20</td><td>0.100</td><td>0.700</td><td>0.200</td>"
                  "<td>0.750</td><td>0.275</td></tr>"))
        << "two seeds pooled";
    EXPECT_THAT(html, HasSubstr("<tr><th>other: Depth camera only</th><td>2</td><td>1.000</td>"));
    EXPECT_THAT(html, Not(HasSubstr("<th>board: "))) << "none was seen";
    EXPECT_THAT(html, Not(HasSubstr("<th>too coarse: ")));
    EXPECT_THAT(html, HasSubstr("<tr class=\"group\"><th colspan=\"4\">seen by the camera</th></tr>\n"));
    EXPECT_THAT(html, HasSubstr("<th>f1 seen</th><td>0.912 ± 0.000</td><td>0.912 ± 0.000</td>"));
}

TEST(Report, judges_timid_and_bold_by_the_side_of_one_half) {
    EXPECT_THAT(report_html(two_seeds()), HasSubstr("for free voxels, above is overconfident"));
}

TEST(Report, shows_the_papers_table_beside_ours) {
    const std::string html = report_html(two_seeds());
    for (const char* cell : {"970", "27\u202f510", "3\u202f523", "299", "587", "47\u202f847", "3\u202f697",
                             "26", "1\u202f430", "66\u202f697", "2\u202f469", "317"}) {
        EXPECT_THAT(html, HasSubstr(std::string("<td>") + cell + "</td>"));
    }
    EXPECT_THAT(html, HasSubstr("<td>12\u202f345 ± 0</td>"));
    EXPECT_THAT(html, HasSubstr("Missed changes by \u221229.9\u00a0% in the paper"));
    EXPECT_THAT(html, HasSubstr("by \u221229.0\u00a0% in <code>robust</code>"));
}

TEST(Report, names_the_papers_swapped_labels) {
    EXPECT_THAT(report_html(two_seeds()), HasSubstr("the two labels are swapped"));
}

TEST(Report, draws_what_ranges_count_as_they_were_counted) {
    ReportInput input = two_seeds();
    EXPECT_THAT(report_html(input), Not(HasSubstr("see a cone")));
    input.range_counting = {.has_rays = false, .cone = ConeModel{}, .zone = {}, .counts = {}};
    const std::string cones = report_html(input);
    EXPECT_THAT(cones, HasSubstr("The range sensors of this run see a cone."));
    EXPECT_THAT(cones, HasSubstr("A range of up to 0.7 m adds 1 to H in total"));
    EXPECT_THAT(cones, HasSubstr("whole cone: 0.646")) << "1.37 of 2.12";
    EXPECT_THAT(cones, Not(HasSubstr("Range sensor</li>"))) << "the update model's curve is of none of them";
    EXPECT_THAT(cones, Not(HasSubstr("Fig. 2")));
    EXPECT_EQ(first_unbalanced_tag(cones), "");
    input.range_counting.has_rays = true;
    input.range_counting.zone = ConeModel{.hit_mass = 2.5F};
    const std::string mixed = report_html(input);
    EXPECT_THAT(mixed, HasSubstr("The range sensors that are no rays see a cone."));
    EXPECT_THAT(mixed, HasSubstr("adds 1 (of a zone 2.5) to H"));
    EXPECT_THAT(mixed, HasSubstr("zone: 0.793")) << "2.87 of 3.62";
    EXPECT_THAT(mixed, HasSubstr("Range sensor</li>"));
}

TEST(Report, balances_the_account_or_says_that_it_does_not) {
    ReportInput input = two_seeds();
    EXPECT_THAT(report_html(input), HasSubstr("<th>ranges</th><td>100</td><td>90</td><td>10</td>"));
    EXPECT_THAT(report_html(input), HasSubstr("no_target"));
    EXPECT_THAT(report_html(input), Not(HasSubstr("duplicate"))) << "counters at 0 are left out";
    input.inputs[0].received = 101;
    EXPECT_THAT(report_html(input), HasSubstr("ranges (does not balance)"));
}

TEST(Report, embeds_each_picture) {
    const std::string html = report_html(two_seeds());
    const std::regex picture("<img [^>]*src=\"data:image/png;base64,iVBOR[A-Za-z0-9+/=]+\"");
    EXPECT_EQ(std::distance(std::sregex_iterator(html.begin(), html.end(), picture), std::sregex_iterator()),
              4);
}

std::size_t count_of(std::string_view text, std::string_view part) {
    std::size_t count = 0;
    for (auto at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

TEST(Report, has_maps_to_view_with_all_of_their_bytes_and_no_script_that_ends_early) {
    ReportInput input = two_seeds();
    EXPECT_THAT(report_html(input), Not(HasSubstr("map-view\"")));
    input.viewed_maps = {{"Fused <b>", {"abc", std::string("\0\xff", 2)}}, {"Camera", {"z"}}};
    EXPECT_THAT(report_html(input), Not(HasSubstr("map-view\"")));
    input.view_script = "const end = '</script>';";
    const std::string html = report_html(input);
    EXPECT_THAT(html, HasSubstr("data-map=\"0\">\nYWJj\nAP8=\n</script>"));
    EXPECT_THAT(html, HasSubstr("data-map=\"1\">\neg==\n</script>"));
    EXPECT_THAT(html, HasSubstr("aria-pressed=\"true\">Fused &lt;b&gt;</button>"));
    EXPECT_THAT(html, HasSubstr("const end = '<\\/script>';</script>"));
    EXPECT_EQ(count_of(html, "<script"), 3U);
    EXPECT_EQ(count_of(html, "</script>"), 3U);
}

TEST(Report, disarms_hostile_names) {
    ReportInput input = two_seeds();
    input.title = "<script>alert(1)</script>";
    input.results.provenance = {{"world\"", "</code><img src=x>"}};
    input.pictures[0].caption = "caf\xe9 & \"quotes\"";
    input.results.maps[0].configuration = "<i>";
    input.results.maps[0].map = "<u>";
    input.inputs[0].input = "<u>";
    input.reproduce = {"./demo && echo '<done>'"};
    const std::string html = report_html(input);
    EXPECT_THAT(html, Not(HasSubstr("<script>")));
    EXPECT_THAT(html, Not(HasSubstr("<img src=x>")));
    EXPECT_THAT(html, Not(HasSubstr("<u>")));
    EXPECT_THAT(html, HasSubstr("caf\ufffd &amp; &quot;quotes&quot;"));
    EXPECT_EQ(first_unbalanced_tag(html), "");
}

TEST(Report, of_nothing_is_still_a_document) {
    const std::string html = report_html(ReportInput{});
    EXPECT_THAT(html, HasSubstr("No pictures were made"));
    EXPECT_EQ(first_unbalanced_tag(html), "");
    EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(Report, of_a_world_without_hidden_objects_leaves_them_out) {
    const std::string html = report_html(two_seeds());
    EXPECT_THAT(html, Not(HasSubstr("on the hidden objects only")));
    EXPECT_THAT(html, HasSubstr("<th>object recall</th><td>\u2013</td>"));
}

TEST(Report, of_a_single_seed_claims_no_spread) {
    ReportInput input = two_seeds();
    const std::vector<evaluation::Run> runs = {judged("robust", "depth", 0, 2000, 0.0),
                                               judged("robust", "fused", 0, 1400, 0.10)};
    input.results = evaluation::collect(runs);
    const std::string html = report_html(input);
    EXPECT_THAT(html, HasSubstr("\u221230.0\u00a0%; \u2212600</div>"));
    EXPECT_THAT(html, HasSubstr("</code>, one seed.</p>"));
}

TEST(Report, of_another_experiment_leaves_the_papers_figures_out) {
    ReportInput input = two_seeds();
    input.results.is_papers_experiment = false;
    const std::string html = report_html(input);
    EXPECT_THAT(html, Not(HasSubstr("Strong et al.")));
    EXPECT_THAT(html, Not(HasSubstr("in the paper")));
    EXPECT_THAT(html, Not(HasSubstr("27\u202f510")));
    EXPECT_THAT(html, HasSubstr("<td>12\u202f345 ± 0</td>")) << "our own row stays";
    EXPECT_EQ(first_unbalanced_tag(html), "");
}

TEST(Report, tabulates_free_voxels_by_evidence) {
    ReportInput input = two_seeds();
    EXPECT_THAT(report_html(input), Not(HasSubstr("<section id=\"free\"")));
    for (auto& map : input.results.maps) map.free_calibration.beams[3] = {.voxels = 200, .surface = 3};
    const std::string html = report_html(input);
    EXPECT_THAT(html, HasSubstr("<section id=\"free\""));
    EXPECT_THAT(html, HasSubstr("<tr><th>beams: 3</th><td>1.5\u00a0%</td><td>200</td>"));
    EXPECT_EQ(first_unbalanced_tag(html), "");
}

TEST(Report, of_a_rig_with_several_cameras_speaks_of_all) {
    ReportInput input = two_seeds();
    input.cameras = 2;
    const std::string html = report_html(input);
    EXPECT_THAT(html, HasSubstr("Of the surfaces that no external camera can see, the cameras’ own map"));
    EXPECT_THAT(html, HasSubstr("<p class=\"soft\">2 depth cameras alone → fused, "));
    EXPECT_THAT(html, HasSubstr("<h2>What the cameras see, by thickness</h2>"));
    EXPECT_THAT(html, HasSubstr("<tr><th>other: 2 depth cameras only</th>"));
    EXPECT_THAT(html, HasSubstr("; the cameras alone leave 1.40 m³."));
    EXPECT_THAT(html, Not(HasSubstr("Depth camera only")));
    EXPECT_EQ(first_unbalanced_tag(html), "");
}

TEST(Report, of_a_rig_without_camera_says_nothing_of_one) {
    ReportInput input = two_seeds();
    const std::vector<evaluation::Run> runs = {judged("robust", "proximity", 0, 1400, 0.10)};
    input.results = evaluation::collect(runs);
    const std::string html = report_html(input);
    EXPECT_THAT(html, HasSubstr("this rig has no camera"));
    EXPECT_THAT(html, Not(HasSubstr("camera alone")));
    EXPECT_THAT(html, Not(HasSubstr("Depth camera only")));
    EXPECT_THAT(html, Not(HasSubstr("fused − depth")));
    EXPECT_THAT(html, Not(HasSubstr("<section id=\"paired\"")));
    EXPECT_THAT(html, Not(HasSubstr("<section id=\"thickness\"")));
    EXPECT_THAT(html, Not(HasSubstr("f1 seen")));
    EXPECT_THAT(html, HasSubstr("98.0\u00a0%"));
    EXPECT_EQ(first_unbalanced_tag(html), "");
}

TEST(Report, names_the_hidden_objects_or_none) {
    ReportInput input = two_seeds();
    input.hidden_objects = {"mug", "<b>"};
    EXPECT_THAT(report_html(input), HasSubstr("the same, on mug, &lt;b&gt;</li>"));
    input.hidden_objects.clear();
    EXPECT_THAT(report_html(input), Not(HasSubstr("swatch-hidden\"")));
}

TEST(Report, is_the_same_text_for_the_same_input) {
    EXPECT_EQ(report_html(two_seeds()), report_html(two_seeds()));
}

}  // namespace
}  // namespace octoskin::report
