// The declarations of the keys of a rig against the reader: ranges, words, defaults, and what is in a node's
// configuration block.
#include "hw/rigfile/rig_keys.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "common/config/node_config.hpp"
#include "hw/rigfile/document.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/support/declared_keys.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::is_no_error;
using testing_support::refusal_of;
using testing_support::scalar;
using testing_support::ScratchFolder;
using testing_support::value_at;
using testing_support::value_is;
using testing_support::what_is;

/// Its board, image and period are the greatest ones, so that no limit is narrower than its declaration.
const std::string kWideRig = R"(name: wide
robot:
  urdf: two-links.urdf
  base_link: base
  link_padding_m: {arm: 0.01}
  attached_capsules: [{name: tool, link: arm, from_m: [0, 0, 0.1], radius_m: 0.03}]
bus: {protocol: can_fd, nominal_bitrate_bps: 1000000, data_bitrate_bps: 5000000}
joints: {node_id: 9, rate_hz: 100, names: [elbow]}
camera:
  width_px: 4096
  height_px: 4096
  fx_px: 60000
  fy_px: 60000
  cx_px: 2000
  cy_px: 2000
  rate_hz: 15
  pose: {xyz_m: [2.7, 0, 1.8], rpy_deg: [0, 0, 0]}
nodes:
  - name: board
    node_id: 1
    board: {name: odd, board_type: 7, i2c_bus_count: 4, xshut_line_count: 48, sensors_max: 34,
            sensors_per_bus_max: 34, supports_can_fd: true, has_data_ready_lines: true}
    sensors:
      - name: front
        link: arm
        bus: 0
        xshut_line: 3
        address: 0x30
        pose: {xyz_m: [0.05, 0.01, 0.02], rpy_deg: [0, 89, 1]}
        distance_mode: short
        timing_budget_ms: 33
        inter_measurement_ms: 1000
        device_offset_mm: 1
        zones: [{centre_spad: 199, width_spads: 8, height_spads: 8}]
        cone: {}
)";

/// The keys of a pose are declared once for several places.
std::string full_path(std::string_view path) {
    return path.starts_with("pose.") ? fmt::format("camera.{}", path) : std::string(path);
}

class RigKeys : public testing::Test {
  protected:
    RigKeys() {
        std::filesystem::copy_file(OCTOSKIN_SOURCE_DIR "/tests/data/rigs/two-links.urdf",
                                   folder_ / "two-links.urdf");
    }

    /// The wide rig with one value changed.
    Result<Rig, Error> read_with(std::string_view path, const std::string& text) {
        Value top = wide_rig();
        Value& value = value_at(top, full_path(path));
        value = scalar(value.key, text);
        return read(top);
    }
    Result<Rig, Error> read_with_numbers(const NumbersKey& key, double number) {
        Value top = wide_rig();
        Value& value = value_at(top, full_path(key.path));
        value.kind = Value::Kind::list;
        value.items.assign(key.count, scalar("", fmt::format("{}", number)));
        return read(top);
    }
    Result<Rig, Error> read_without(std::string_view path) {
        Value top = wide_rig();
        if (path.ends_with("[]") || path.ends_with("{}")) path.remove_suffix(2);
        Value& value = value_at(top, full_path(path));
        value.kind = Value::Kind::null;
        value.items.clear();
        return read(top);
    }

  private:
    Value wide_rig() { return load_document(folder_.write("wide.yaml", kWideRig)); }
    Result<Rig, Error> read(const Value& top) {
        return read_rig(folder_.write("rig.yaml", document_text(top)));
    }

    ScratchFolder folder_;
};

std::vector<AnyKey> all_keys() {
    std::vector<AnyKey> keys;
    for (const KeyTable& table : rig_key_tables())
        keys.insert(keys.end(), table.keys.begin(), table.keys.end());
    return keys;
}

TEST_F(RigKeys, numbers_are_refused_just_outside_of_the_declared_range_and_not_at_its_ends) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    int checked = 0;
    for (const AnyKey& any : all_keys()) {
        const auto* const* key = std::get_if<const NumberKey*>(&any);
        if (key == nullptr) continue;
        const auto [min, max] = (*key)->range;
        for (const double outside : {std::nextafter(min, -kInfinity), std::nextafter(max, kInfinity)}) {
            const std::string value = fmt::format("{}", outside);
            EXPECT_THAT(error_in(read_with((*key)->path, value)),
                        AllOf(code_is(ErrorCode::out_of_range), what_is(refusal_of(any)),
                              value_is("'" + value + "'")))
                << (*key)->path;
        }
        for (const double end : {min, max})
            EXPECT_THAT(error_in(read_with((*key)->path, fmt::format("{}", end))),
                        Not(what_is(refusal_of(any))))
                << (*key)->path;
        ++checked;
    }
    EXPECT_GT(checked, 30);
}

TEST_F(RigKeys, whole_numbers_are_refused_just_outside_of_the_declared_range_and_not_at_its_ends) {
    int checked = 0;
    for (const AnyKey& any : all_keys()) {
        const auto* const* key = std::get_if<const IntegerKey*>(&any);
        if (key == nullptr) continue;
        const auto [min, max] = (*key)->range;
        const std::string refusal = fmt::format("expected a whole number from {} to {}", min, max);
        for (const std::int64_t outside : {min - 1, max + 1}) {
            const std::string value = fmt::format("{}", outside);
            EXPECT_THAT(
                error_in(read_with((*key)->path, value)),
                AllOf(code_is(ErrorCode::out_of_range), what_is(refusal), value_is("'" + value + "'")))
                << (*key)->path;
        }
        for (const std::int64_t end : {min, max})
            EXPECT_THAT(error_in(read_with((*key)->path, fmt::format("{}", end))), Not(what_is(refusal)))
                << (*key)->path;
        ++checked;
        if ((*key)->values.empty()) {
            EXPECT_EQ(refusal, refusal_of(any));
            continue;
        }
        EXPECT_THAT(error_in(read_with((*key)->path, fmt::format("{}", min))),
                    what_is(HasSubstr("expected " + expected_text(any))))
            << (*key)->path;
        for (const std::int64_t value : (*key)->values)
            EXPECT_THAT(error_in(read_with((*key)->path, fmt::format("{}", value))), is_no_error())
                << (*key)->path;
    }
    EXPECT_GT(checked, 25);
}

TEST_F(RigKeys, lists_of_numbers_are_refused_outside_of_the_declared_range) {
    int checked = 0;
    for (const AnyKey& any : all_keys()) {
        const auto* const* key = std::get_if<const NumbersKey*>(&any);
        if (key == nullptr) continue;
        const auto [min, max] = (*key)->range;
        for (const double outside : {1.001 * min, 1.001 * max})
            EXPECT_THAT(error_in(read_with_numbers(**key, outside)),
                        AllOf(code_is(ErrorCode::out_of_range),
                              what_is(EndsWith(fmt::format(" from {} to {}", min, max)))))
                << (*key)->path;
        for (const double end : {min, max})
            EXPECT_THAT(error_in(read_with_numbers(**key, end)), Not(what_is(HasSubstr(" from "))))
                << (*key)->path;
        ++checked;
    }
    EXPECT_EQ(checked, 6);
}

TEST_F(RigKeys, flags_and_words_are_refused_with_the_declared_words) {
    int checked = 0;
    for (const AnyKey& key : all_keys()) {
        const bool is_word = std::holds_alternative<const FlagKey*>(key) ||
                             std::holds_alternative<const WordKey<bool>*>(key) ||
                             std::holds_alternative<const WordKey<DistanceMode>*>(key) ||
                             std::holds_alternative<const WordKey<StreamGate>*>(key);
        if (!is_word) continue;
        EXPECT_THAT(error_in(read_with(path_of(key), "perhaps")),
                    AllOf(code_is(std::holds_alternative<const FlagKey*>(key) ? ErrorCode::wrong_type
                                                                              : ErrorCode::unknown_word),
                          what_is("expected " + expected_text(key)), value_is("'perhaps'")))
            << path_of(key);
        ++checked;
    }
    EXPECT_EQ(checked, 12);
}

TEST_F(RigKeys, a_required_key_is_required_and_any_other_may_be_missing) {
    for (const AnyKey& key : all_keys()) {
        const std::string path(path_of(key));
        const bool is_conditional =
            path.starts_with("pose.") || path == "bus.data_bitrate_bps" || path == "extends";
        if (is_conditional) continue;
        const Error error = error_in(read_without(path));
        if (default_text(key) == "required") {
            EXPECT_THAT(error, code_is(ErrorCode::missing_key)) << path;
        } else {
            EXPECT_THAT(error, is_no_error()) << path;
        }
    }
}

TEST_F(RigKeys, a_missing_key_has_its_declared_default) {
    int checked = 0;
    for (const AnyKey& key : all_keys()) {
        const bool has_value =
            std::visit([](const auto* declared) { return declared->fallback.value.has_value(); }, key);
        if (!has_value) continue;
        const auto without = read_without(path_of(key));
        const auto with = read_with(path_of(key), default_text(key));
        ASSERT_TRUE(without && with) << path_of(key) << error_in(without).message()
                                     << error_in(with).message();
        EXPECT_EQ(canonical_text(*with, "r"), canonical_text(*without, "r")) << path_of(key);
        ++checked;
    }
    EXPECT_GT(checked, 35);
}

TEST_F(RigKeys, what_is_declared_to_be_in_the_block_of_a_node_changes_the_hash_of_the_node) {
    int checked = 0;
    for (const AnyKey& key : all_keys()) {
        std::vector<std::string> texts;
        if (const auto* const* number = std::get_if<const NumberKey*>(&key))
            texts = {fmt::format("{}", (*number)->range.min), fmt::format("{}", (*number)->range.max)};
        if (const auto* const* integer = std::get_if<const IntegerKey*>(&key)) {
            const auto values = (*integer)->values;
            const auto [min, max] = (*integer)->range;
            texts = {fmt::format("{}", values.empty() ? min : values.front()),
                     fmt::format("{}", values.empty() ? max : values.back())};
        }
        if (std::holds_alternative<const FlagKey*>(key)) texts = {"false", "true"};
        if (texts.empty()) continue;
        const auto one = read_with(path_of(key), texts.front());
        const auto other = read_with(path_of(key), texts.back());
        if (!one || !other) continue;  // a rule between keys
        EXPECT_EQ(node_hash(one->nodes.at(0).config) != node_hash(other->nodes.at(0).config),
                  is_in_node_block(key))
            << path_of(key);
        ++checked;
    }
    EXPECT_GT(checked, 40);
}

}  // namespace
}  // namespace octoskin::rig
