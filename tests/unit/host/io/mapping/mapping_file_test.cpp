#include "host/io/mapping/mapping_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include <sstream>
#include <string>

#include "host/io/mapping/mapping_keys.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::is_no_error;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::ScratchFolder;
using testing_support::value_is;
using testing_support::what_is;

Result<MappingConfig, Error> read_text(const std::string& text) {
    const ScratchFolder folder;
    return read_mapping(folder.write("my.yaml", text).string());
}

Error error_of(const std::string& text) {
    const Error error = error_in(read_text(text));
    EXPECT_TRUE(has_its_fields(error)) << text;
    return error;
}

TEST(MappingFile, knows_those_that_ship_by_name) {
    EXPECT_EQ(*read_mapping("paper"), paper_mapping());
    EXPECT_EQ(*read_mapping("fast"), fast_mapping());
    EXPECT_EQ(*read_mapping("denoised"), denoised_mapping());
    EXPECT_EQ(*read_mapping(kDefaultMapping), denoised_mapping());
    EXPECT_EQ(*read_mapping("robust"), robust_mapping());
    EXPECT_EQ(read_mapping("paper")->depth_update, DepthUpdate::paper);
    EXPECT_FALSE(read_mapping("paper")->depth_filter.is_enabled);
    EXPECT_EQ(read_mapping("robust")->depth_update, DepthUpdate::robust);
    EXPECT_TRUE(read_mapping("robust")->depth_filter.is_enabled);
}

TEST(MappingFile, shipped_files_say_what_is_built_in) {
    const std::string folder = OCTOSKIN_SOURCE_DIR "/host/config/";
    const auto paper = read_mapping(folder + "paper.yaml");
    ASSERT_TRUE(paper.has_value()) << paper.error().message();
    EXPECT_EQ(*paper, paper_mapping());
    const auto robust = read_mapping(folder + "robust.yaml");
    ASSERT_TRUE(robust.has_value()) << robust.error().message();
    EXPECT_EQ(*robust, robust_mapping());
    const auto fast = read_mapping(folder + "fast.yaml");
    ASSERT_TRUE(fast.has_value()) << fast.error().message();
    EXPECT_EQ(*fast, fast_mapping());
    const auto denoised = read_mapping(folder + "denoised.yaml");
    ASSERT_TRUE(denoised.has_value()) << denoised.error().message();
    EXPECT_EQ(*denoised, denoised_mapping());
}

/// With another `base`, so that every value has to come from the file itself.
TEST(MappingFile, shipped_files_leave_nothing_out) {
    for (const std::string name : {"paper", "robust", "fast", "denoised"}) {
        std::string text = ScratchFolder::read(OCTOSKIN_SOURCE_DIR "/host/config/" + name + ".yaml");
        const std::string base = "base: " + name;
        ASSERT_NE(text.find(base), std::string::npos);
        text.replace(text.find(base), base.size(), name == "paper" ? "base: robust" : "base: paper");
        EXPECT_EQ(*read_text(text), *read_mapping(name));
    }
}

TEST(MappingFile, starts_from_the_default_or_the_base_it_names_and_overrides_what_it_mentions) {
    EXPECT_EQ(*read_text("{}"), denoised_mapping());
    EXPECT_EQ(*read_text("base: robust"), robust_mapping());
    MappingConfig expected = paper_mapping();
    expected.map.resolution_m = 0.02;
    expected.removes_robot_from_depth = false;
    EXPECT_EQ(*read_text("base: paper\nremoves_robot_from_depth: false\nmap: {resolution_m: 0.02}\n"),
              expected);
}

TEST(MappingFile, reads_every_key) {
    const auto config = read_text(
        "map: {resolution_m: 0.02, log_odds_min: -3.5, log_odds_max: 4, log_odds_passed_max: 1.25, "
        "log_odds_hit_min: -0.75, log_odds_occupied: 0.25, memory_max_mib: 10}\n"
        "age: {stale_after_s: 5, unknown_after_s: 6}\n"
        "proximity_hit: {log_odds_offset: 0.5, log_odds_slope_per_m: 0.25, range_min_m: 0.125, "
        "is_range_min_exclusive: true}\n"
        "depth_hit: {log_odds_offset: 0.75, log_odds_slope_per_m: 0.5, range_min_m: 1.5, "
        "is_range_min_exclusive: false}\n"
        "miss_log_odds: -0.5\ndepth_update: paper\n"
        "depth_filter: {is_enabled: false, window_px: 3, sigma_m: 0.01, gate_sigmas: 5, mean_sigmas: 2, "
        "min_support: 4}\n"
        "depth_denoiser: {noise_m: 0.0025, noise_per_m: 0.0019, noise_from_m: 0.5, bias_per_m: 0.0625, "
        "gate_sigmas: 4.5, "
        "step_sigmas: 5.5, drift_sigmas: 2.5, drift_memory: 0.75, count_max: 33, pair_sigmas: 2.25, "
        "min_support: 7, doubt_sigmas: 1.75}\nmoving_miss_log_odds: -0.125\n"
        "range_update: ray\nray_end_sigmas: 1.5\n"
        "cone: {hit_range_max_m: 2, cap_half_thickness_m: 0.25, cap_sigmas: 1.5, core_weight_min: 0.75, "
        "core_margin_voxels: 0.125, hit_mass: 1.25, miss_mass: 0.625, cap_angle_share: 0.75}\n"
        "zone: {hit_range_max_m: 3, cap_half_thickness_m: 0.5, cap_sigmas: 2.5, core_weight_min: 0.875, "
        "core_margin_voxels: 0.375, hit_mass: 3.25, miss_mass: 1.625, cap_angle_share: 0.25}\n"
        "standing: {readings: 6, hits: 1.75, angle_share: 0.375, clears_after_s: 1.25}\n"
        "counts: {prior_hits: 0.75, prior_misses: 1.25, occupied_hits: 30, free_misses: 4, "
        "occupied_probability: 0.625, hits_min: 0.5, misses_min: 2.5, counts_max: 40, image_clears: 0.5, "
        "image_marks: 0.25, range_clears: 0.125, range_clears_from: 4.5}\n"
        "removes_robot_from_depth: false\nremoves_robot_from_ranges: false\n"
        "refuses_contradicting_sensors: true\ndepth_range_max_m: "
        "3.5\nno_return_clear_m: 1.25\n"
        "depth_box_voxels_max: 5000\n");
    ASSERT_TRUE(config.has_value()) << config.error().message();
    const MappingConfig expected{
        .map = {.resolution_m = 0.02,
                .log_odds_min = -3.5F,
                .log_odds_max = 4.0F,
                .log_odds_passed_max = 1.25F,
                .log_odds_hit_min = -0.75F,
                .log_odds_occupied = 0.25F,
                .memory_max_mib = 10,
                .counts = {.prior_hits = 0.75F,
                           .prior_misses = 1.25F,
                           .occupied_hits = 30.0F,
                           .free_misses = 4.0F,
                           .occupied_probability = 0.625F,
                           .hits_min = 0.5F,
                           .misses_min = 2.5F,
                           .counts_max = 40.0F,
                           .image_clears = 0.5F,
                           .image_marks = 0.25F,
                           .range_clears = 0.125F,
                           .range_clears_from = 4.5F},
                .age = {.stale_after_s = 5, .unknown_after_s = 6}},
        .model =
            {.proximity =
                 {.offset = 0.5, .slope_per_m = 0.25, .range_min_m = 0.125, .is_min_exclusive = true},
             .depth = {.offset = 0.75, .slope_per_m = 0.5, .range_min_m = 1.5, .is_min_exclusive = false},
             .miss_log_odds = -0.5F},
        .range_update = RangeUpdate::ray,
        .ray_end_sigmas = 1.5,
        .cone = {.hit_range_max_m = 2.0,
                 .cap_half_thickness_m = 0.25,
                 .cap_sigmas = 1.5,
                 .cap_angle_share = 0.75,
                 .core_weight_min = 0.75,
                 .core_margin_voxels = 0.125,
                 .hit_mass = 1.25F,
                 .miss_mass = 0.625F},
        .zone = {.hit_range_max_m = 3.0,
                 .cap_half_thickness_m = 0.5,
                 .cap_sigmas = 2.5,
                 .cap_angle_share = 0.25,
                 .core_weight_min = 0.875,
                 .core_margin_voxels = 0.375,
                 .hit_mass = 3.25F,
                 .miss_mass = 1.625F},
        .standing = {.readings = 6, .hits = 1.75F, .angle_share = 0.375, .clears_after_s = 1.25},
        .depth_update = DepthUpdate::paper,
        .depth_filter = {.is_enabled = false,
                         .window = 3,
                         .sigma_m = 0.01,
                         .gate_sigmas = 5.0,
                         .mean_sigmas = 2.0,
                         .min_support = 4},
        .depth_denoiser =
            {.noise = {.constant_m = 0.0025, .quadratic_per_m = 0.0019, .from_m = 0.5, .bias_per_m = 0.0625},
             .gate_sigmas = 4.5,
             .step_sigmas = 5.5,
             .drift_sigmas = 2.5,
             .drift_memory = 0.75,
             .count_max = 33,
             .pair_sigmas = 2.25,
             .support_min = 7,
             .doubt_sigmas = 1.75},
        .moving_miss_log_odds = -0.125F,
        .depth_range_max_m = 3.5,
        .removes_robot_from_depth = false,
        .removes_robot_from_ranges = false,
        .refuses_contradicting_sensors = true,
        .no_return_clear_m = 1.25,
        .depth_box_voxels_max = 5000};
    EXPECT_EQ(*config, expected);
    // And writes every key: what it writes reads back as the same.
    EXPECT_EQ(*read_text("base: robust\n" + mapping_text(*config)), *config);
    EXPECT_EQ(*read_text("base: paper\n" + mapping_text(*config)), *config);
    EXPECT_EQ(mapping_text(*read_text(mapping_text(*config))), mapping_text(*config));
}

TEST(MappingFile, names_file_line_key_value_and_remedy) {
    EXPECT_THAT(error_of("map:\n  resolution: 0.04\n"),
                AllOf(code_is(ErrorCode::unknown_key), file_is("my.yaml"), line_is(2),
                      key_is("map.resolution"), remedy_is(HasSubstr("resolution_m"))));
    EXPECT_THAT(error_of("\nno_return_clear_mm: 100\n"),
                AllOf(code_is(ErrorCode::unknown_key), line_is(2), key_is("no_return_clear_mm")));
    for (const auto& [key, value] : {std::pair("depth_update", "best"), std::pair("base", "worst")})
        EXPECT_THAT(error_of(std::string(key) + ": " + value + "\n"),
                    AllOf(code_is(ErrorCode::unknown_word), line_is(1), key_is(key),
                          what_is(HasSubstr("paper or robust or fast or denoised")),
                          value_is("'" + std::string(value) + "'")));
    EXPECT_THAT(error_of("miss_log_odds: 0.4\n"), AllOf(code_is(ErrorCode::out_of_range), line_is(1),
                                                        key_is("miss_log_odds"), value_is("'0.4'")));
    EXPECT_THAT(error_of("depth_filter: {window_px: 4}\n"),
                AllOf(code_is(ErrorCode::bad_value), line_is(1), key_is("depth_filter.window_px"),
                      what_is(HasSubstr("an odd number")), value_is("4")));
    EXPECT_THAT(error_of("depth_filter: {is_enabled: 1}\n"),
                AllOf(code_is(ErrorCode::wrong_type), what_is(HasSubstr("true or false")), value_is("'1'")));
    for (const char* odds : {"4", "-2"})
        EXPECT_THAT(error_of(std::string("map: {log_odds_occupied: ") + odds + "}\n"),
                    AllOf(line_is(1), key_is("map.log_odds_occupied")));
    EXPECT_THAT(error_of("map: 0.04\n"),
                AllOf(code_is(ErrorCode::wrong_type), line_is(1), key_is("map"), value_is("'0.04'")));
    for (const char* metres : {".nan", "0"})
        EXPECT_THAT(error_of(std::string("map: {resolution_m: ") + metres + "}\n"),
                    AllOf(line_is(1), key_is("map.resolution_m")));
    EXPECT_THAT(error_of("depth_hit: {range_min_m: -1}\n"),
                AllOf(code_is(ErrorCode::out_of_range), line_is(1), key_is("depth_hit.range_min_m")));
    EXPECT_THAT(error_of("map: [\n"), AllOf(code_is(ErrorCode::bad_syntax), file_is("my.yaml")));
    EXPECT_THAT(error_in(read_mapping("no/such/file.yaml")),
                AllOf(code_is(ErrorCode::not_found), file_is("file.yaml")));
}

TEST(MappingFile, refuses_ages_at_which_nothing_could_be_stale) {
    EXPECT_THAT(error_of("age:\n  unknown_after_s: 60\n"),
                AllOf(code_is(ErrorCode::conflict), line_is(2), key_is("age.unknown_after_s"),
                      what_is(HasSubstr("more than stale_after_s, 60, or 0 (never)")), value_is("60")));
    EXPECT_THAT(error_of("age: {stale_after_s: 7201}\n"),
                AllOf(code_is(ErrorCode::out_of_range), line_is(1), key_is("age.stale_after_s")));
    EXPECT_THAT(error_of("age: {stale_after_s: 1.5}\n"),
                AllOf(code_is(ErrorCode::wrong_type), line_is(1), key_is("age.stale_after_s")));
    EXPECT_THAT(error_of("age: {stale_after_s: 0, unknown_after_s: 1}\n"), is_no_error());
    EXPECT_THAT(error_of("age: {stale_after_s: 7200, unknown_after_s: 0}\n"), is_no_error());
}

TEST(MappingFile, refuses_sensors_only_where_they_are_reported) {
    EXPECT_THAT(error_of("reports_contradicting_sensors: false\nrefuses_contradicting_sensors: true\n"),
                AllOf(code_is(ErrorCode::conflict), line_is(2), key_is("refuses_contradicting_sensors"),
                      what_is(HasSubstr("reports_contradicting_sensors"))));
    EXPECT_THAT(error_of("refuses_contradicting_sensors: true\n"), is_no_error());
    EXPECT_THAT(error_of("reports_contradicting_sensors: false\n"), is_no_error());
    for (const MappingConfig& config :
         {paper_mapping(), robust_mapping(), fast_mapping(), denoised_mapping()}) {
        EXPECT_TRUE(config.reports_contradicting_sensors);
        EXPECT_FALSE(config.refuses_contradicting_sensors);
    }
}

TEST(MappingFile, refuses_to_believe_one_reading_alone) {
    EXPECT_THAT(error_of("standing: {readings: 1}\n"),
                AllOf(code_is(ErrorCode::out_of_range), line_is(1), key_is("standing.readings"),
                      what_is(HasSubstr("2 or more, or 0 (never)")), value_is("1")));
    EXPECT_THAT(error_of("standing: {readings: 2}\n"), is_no_error());
    EXPECT_THAT(error_of("standing: {readings: 0}\n"), is_no_error());
}

TEST(MappingFile, refuses_a_filter_whose_window_has_too_few_pixels_for_any_value) {
    EXPECT_THAT(error_of("base: fast\ndepth_filter: {window_px: 1}\n"),
                AllOf(code_is(ErrorCode::conflict), line_is(2), key_is("depth_filter.min_support"),
                      what_is(HasSubstr("at most 0 with window_px 1")), value_is("5")));
    EXPECT_THAT(error_of("base: fast\ndepth_filter:\n  window_px: 3\n  min_support: 9\n"),
                AllOf(code_is(ErrorCode::conflict), line_is(4), key_is("depth_filter.min_support"),
                      what_is(HasSubstr("at most 8 with window_px 3")), value_is("9"),
                      remedy_is(AllOf(HasSubstr("window_px"), HasSubstr("is_enabled: false")))));
    EXPECT_THAT(error_of("base: fast\ndepth_filter: {min_support: 25}\n"),
                AllOf(what_is(HasSubstr("its window has 25")), value_is("25")));
    EXPECT_THAT(error_of("base: fast\ndepth_filter: {window_px: 1, min_support: 0}\n"), is_no_error());
    EXPECT_THAT(error_of("base: fast\ndepth_filter: {window_px: 3, min_support: 8}\n"), is_no_error());
    EXPECT_THAT(error_of("base: fast\ndepth_filter: {is_enabled: false, window_px: 1}\n"), is_no_error());
    EXPECT_THAT(error_of("depth_filter: {window_px: 1}\n"), is_no_error()) << "the default has no filter";
}

TEST(MappingFile, knows_a_number_in_quotes_one_with_a_comma_and_a_key_of_another_table) {
    for (const auto& [text, value] : {std::pair("map: {resolution_m: \"0.02\"}\n", "'0.02'"),
                                      std::pair("map: {memory_max_mib: '20'}\n", "'20'"),
                                      std::pair("depth_filter: {is_enabled: 'true'}\n", "'true'")})
        EXPECT_THAT(error_of(text), AllOf(code_is(ErrorCode::wrong_type), value_is(value),
                                          remedy_is(HasSubstr("leave out the quotes"))));
    EXPECT_THAT(error_of("map: {resolution_m: \"fine\"}\n"),
                AllOf(code_is(ErrorCode::wrong_type), what_is(HasSubstr("from 0.001 to 10")),
                      value_is("'fine'"), remedy_is("")));
    EXPECT_THAT(error_of("map:\n  resolution_m: 0,02\n"),
                AllOf(code_is(ErrorCode::wrong_type), value_is("'0,02'"), remedy_is(HasSubstr("0.02"))));
    EXPECT_THAT(error_of("map: {resolution_m: 0,02}\n"),
                AllOf(code_is(ErrorCode::unknown_key), line_is(1), key_is("map.02"),
                      remedy_is(AllOf(HasSubstr("a decimal point: 0.02"), HasSubstr("0,02")))));
    EXPECT_THAT(error_of("resolution_m: 0.02\n"),
                AllOf(code_is(ErrorCode::unknown_key), line_is(1), key_is("resolution_m"),
                      remedy_is(HasSubstr("did you mean map.resolution_m?"))));
    EXPECT_THAT(error_of("window_px: 3\n"), remedy_is(HasSubstr("did you mean depth_filter.window_px?")));
    EXPECT_THAT(error_of("range_min_m: 3\n"),
                remedy_is(HasSubstr("did you mean proximity_hit.range_min_m or depth_hit.range_min_m?")));
}

/// "map.resolution_m" and its value, of text as `mapping_text` writes it.
std::map<std::string, std::string> values_by_path(const std::string& text) {
    std::map<std::string, std::string> values;
    std::istringstream lines(text);
    std::string table;
    for (std::string line; std::getline(lines, line);) {
        const auto colon = line.find(':');
        const std::string key = line.substr(0, colon);
        if (colon + 1 == line.size()) {
            table = key + ".";
        } else {
            values[key.starts_with("  ") ? table + key.substr(2) : key] = line.substr(colon + 2);
        }
    }
    return values;
}

/// What the reader says that it expects of a key, given what no key takes.
std::string expected_of(const std::string& path) {
    const auto dot = path.find('.');
    const std::string text = dot == std::string::npos
                                 ? path + ": 1e30\n"
                                 : path.substr(0, dot) + ": {" + path.substr(dot + 1) + ": 1e30}\n";
    const Error error = error_of(text);
    constexpr std::string_view kBegin = "expected ";
    if (error.key != path || !error.what.starts_with(kBegin)) return error.message();
    return error.what.substr(kBegin.size());
}

TEST(MappingFile, expects_of_each_key_what_the_table_of_keys_declares) {
    for (const MappingKey& key : mapping_keys())
        EXPECT_EQ(expected_of(std::string(key.path)), expected_text(key)) << key.path;
    EXPECT_EQ(expected_of("base"), "paper or robust or fast or denoised");
}

TEST(MappingFile, writes_each_key_of_the_table_once_and_no_other) {
    const auto values = values_by_path(mapping_text(denoised_mapping()));
    EXPECT_EQ(values.size(), 79U);
    EXPECT_EQ(mapping_keys().size(), 79U);
    for (const MappingKey& key : mapping_keys()) {
        ASSERT_TRUE(values.contains(std::string(key.path))) << key.path;
        EXPECT_EQ(values.at(std::string(key.path)), value_text(key, denoised_mapping())) << key.path;
    }
}

/// Another value than `text` that the key takes.
std::string other_value(const MappingKey& key, const std::string& text) {
    if (text == "true") return "false";
    if (text == "false") return "true";
    if (key.path == "range_update") return text == "ray" ? "cone" : "ray";
    if (key.path == "depth_update") return text == "robust" ? "fast" : "robust";
    if (key.path == "depth_filter.window_px") return "3";
    return fmt::format("{}", text == fmt::format("{}", key.range.max) ? key.range.min : key.range.max);
}

TEST(MappingFile, puts_the_value_of_each_key_into_the_place_that_is_written_under_it_and_no_other) {
    const auto before = values_by_path(mapping_text(denoised_mapping()));
    std::size_t checked = 0;
    for (const MappingKey& key : mapping_keys()) {
        const std::string path(key.path);
        const std::string value = other_value(key, before.at(path));
        const auto dot = path.find('.');
        const std::string text = dot == std::string::npos ? path + ": " + value + "\n"
                                                          : path.substr(0, dot) + ": {" +
                                                                path.substr(dot + 1) + ": " + value + "}\n";
        const auto read = read_text(text);
        if (!read) continue;  // a rule between keys
        auto expected = before;
        expected[path] = value;
        EXPECT_EQ(values_by_path(mapping_text(*read)), expected) << path;
        ++checked;
    }
    EXPECT_GE(checked, 60U);
}

}  // namespace
}  // namespace octoskin
