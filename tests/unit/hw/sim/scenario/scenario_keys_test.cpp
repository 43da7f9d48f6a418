// The declarations of the keys of a scenario, and of the motion of a world, against their readers.
#include "hw/sim/scenario/scenario_keys.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "hw/rigfile/document.hpp"
#include "hw/sim/scenario/motion.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "tests/support/declared_keys.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::sim {
namespace {

using testing::AllOf;
using testing::Not;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::is_no_error;
using testing_support::no_error;
using testing_support::refusal_of;
using testing_support::scalar;
using testing_support::ScratchFolder;
using testing_support::value_at;
using testing_support::what_is;

/// Laid over the experiment, so that no limit is narrower than its declaration.
const std::string kWideScenario = "extends: " OCTOSKIN_SOURCE_DIR R"(/hw/worlds/experiment.scenario.yaml
world: world.sdf
world_motion: a.motion.yaml
ranges: {min_m: 0}
sensor_traits: [{register: 0x47, reads: 0}]
)";
const std::string kWorldMotion = "models: [{model: ball, places: [{at_s: 0}]}]\n";

class ScenarioKeys : public testing::Test {
  protected:
    ScenarioKeys() {
        folder_.write("world.sdf", "");
        folder_.write("a.motion.yaml", kWorldMotion);
    }

    Error error_with(std::string_view path, const std::string& text) {
        return error_of_change(path, [&](rig::Value& value) { value = scalar(value.key, text); });
    }
    Error error_with_numbers(const rig::NumbersKey& key, double number) {
        return error_of_change(key.path, [&](rig::Value& value) {
            value.kind = rig::Value::Kind::list;
            value.items.assign(key.count, scalar("", fmt::format("{}", number)));
        });
    }
    Error error_without(std::string_view path) {
        if (path.ends_with("[]")) path.remove_suffix(2);
        return error_of_change(path, [](rig::Value& value) {
            value.kind = rig::Value::Kind::null;
            value.items.clear();
        });
    }

  private:
    Error error_of_change(std::string_view path, const auto& change) {
        const bool is_motion = path.starts_with("models");
        rig::Value top = is_motion
                             ? rig::load_document(folder_ / "a.motion.yaml")
                             : rig::load_with_extends(folder_.write("wide.scenario.yaml", kWideScenario));
        if (path.starts_with("depth.kinect")) value_at(top, "depth.noise") = scalar("noise", "kinect");
        change(value_at(top, path));
        const auto file = folder_.write("changed.yaml", rig::document_text(top));
        if (is_motion) {
            return error_in(read_motion(file, {{"ball/l/v", "ball", {}, {}, true}}));
        }
        return error_in(read_scenario(file));
    }

    ScratchFolder folder_;
};

std::vector<rig::AnyKey> all_keys() {
    std::vector<rig::AnyKey> keys;
    for (const rig::KeyTable& table : scenario_key_tables())
        keys.insert(keys.end(), table.keys.begin(), table.keys.end());
    return keys;
}

TEST_F(ScenarioKeys, numbers_are_refused_just_outside_of_the_declared_range_and_not_at_its_ends) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    int checked = 0;
    for (const rig::AnyKey& any : all_keys()) {
        const auto* const* key = std::get_if<const rig::NumberKey*>(&any);
        if (key == nullptr) continue;
        const auto [min, max] = (*key)->range;
        const std::string refusal = refusal_of(any);
        for (const double outside : {std::nextafter(min, -kInfinity), std::nextafter(max, kInfinity)})
            EXPECT_THAT(error_with((*key)->path, fmt::format("{}", outside)),
                        AllOf(code_is(ErrorCode::out_of_range), what_is(refusal)))
                << (*key)->path;
        for (const double end : {min, max})
            EXPECT_THAT(error_with((*key)->path, fmt::format("{}", end)), Not(what_is(refusal)))
                << (*key)->path;
        ++checked;
    }
    EXPECT_EQ(checked, 24);
}

TEST_F(ScenarioKeys, whole_numbers_are_refused_just_outside_of_the_declared_range_and_not_at_its_ends) {
    int checked = 0;
    for (const rig::AnyKey& any : all_keys()) {
        const auto* const* key = std::get_if<const rig::IntegerKey*>(&any);
        if (key == nullptr) continue;
        const auto [min, max] = (*key)->range;
        const std::string refusal = refusal_of(any);
        for (const std::int64_t outside : {min - 1, max + 1})
            EXPECT_THAT(error_with((*key)->path, fmt::format("{}", outside)),
                        AllOf(code_is(ErrorCode::out_of_range), what_is(refusal)))
                << (*key)->path;
        for (const std::int64_t end : {min, max})
            EXPECT_THAT(error_with((*key)->path, fmt::format("{}", end)), is_no_error()) << (*key)->path;
        ++checked;
    }
    EXPECT_EQ(checked, 11);
}

TEST_F(ScenarioKeys, lists_of_numbers_are_refused_outside_of_the_declared_range) {
    int checked = 0;
    for (const rig::AnyKey& any : all_keys()) {
        const auto* const* key = std::get_if<const rig::NumbersKey*>(&any);
        if (key == nullptr) continue;
        const std::string refusal =
            fmt::format("expected metres from {} to {}", (*key)->range.min, (*key)->range.max);
        for (const double end : {(*key)->range.min, (*key)->range.max}) {
            EXPECT_THAT(error_with_numbers(**key, 1.001 * end),
                        AllOf(code_is(ErrorCode::out_of_range), what_is(refusal)))
                << (*key)->path;
            EXPECT_THAT(error_with_numbers(**key, end), Not(what_is(refusal))) << (*key)->path;
        }
        ++checked;
    }
    EXPECT_EQ(checked, 6);
}

TEST_F(ScenarioKeys, a_required_key_is_required_and_any_other_may_be_missing) {
    for (const rig::AnyKey& key : all_keys()) {
        const std::string path(rig::path_of(key));
        if (path == "sensor_traits[].register") continue;  // the others of the item need it
        const bool is_required = rig::default_text(key) == "required" || path == "sensor_traits[].reads";
        EXPECT_EQ(error_without(path).code, is_required ? ErrorCode::missing_key : no_error().code) << path;
    }
}

}  // namespace
}  // namespace octoskin::sim
