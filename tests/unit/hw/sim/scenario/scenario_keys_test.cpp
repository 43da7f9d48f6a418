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
#include "tests/support/scratch_folder.hpp"

namespace octoskin::sim {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::refusal_of;
using testing_support::scalar;
using testing_support::ScratchFolder;
using testing_support::value_at;

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

    std::string message_with(std::string_view path, const std::string& text) {
        return message_of_change(path, [&](rig::Value& value) { value = scalar(value.key, text); });
    }
    std::string message_with_numbers(const rig::NumbersKey& key, double number) {
        return message_of_change(key.path, [&](rig::Value& value) {
            value.kind = rig::Value::Kind::list;
            value.items.assign(key.count, scalar("", fmt::format("{}", number)));
        });
    }
    std::string message_without(std::string_view path) {
        if (path.ends_with("[]")) path.remove_suffix(2);
        return message_of_change(path, [](rig::Value& value) {
            value.kind = rig::Value::Kind::null;
            value.items.clear();
        });
    }

  private:
    std::string message_of_change(std::string_view path, const auto& change) {
        const bool is_motion = path.starts_with("models");
        rig::Value top = is_motion
                             ? rig::load_document(folder_ / "a.motion.yaml")
                             : rig::load_with_extends(folder_.write("wide.scenario.yaml", kWideScenario));
        change(value_at(top, path));
        const auto file = folder_.write("changed.yaml", rig::document_text(top));
        if (is_motion) {
            const auto motion = read_motion(file, {{"ball/l/v", "ball", {}, {}, true}});
            return motion ? "no error" : motion.error().message();
        }
        const auto scenario = read_scenario(file);
        return scenario ? "no error" : scenario.error().message();
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
        const std::string refusal = refusal_of(any) + ", found";
        for (const double outside : {std::nextafter(min, -kInfinity), std::nextafter(max, kInfinity)})
            EXPECT_THAT(message_with((*key)->path, fmt::format("{}", outside)), HasSubstr(refusal))
                << (*key)->path;
        for (const double end : {min, max})
            EXPECT_THAT(message_with((*key)->path, fmt::format("{}", end)), Not(HasSubstr(refusal)))
                << (*key)->path;
        ++checked;
    }
    EXPECT_EQ(checked, 14);
}

TEST_F(ScenarioKeys, whole_numbers_are_refused_just_outside_of_the_declared_range_and_not_at_its_ends) {
    int checked = 0;
    for (const rig::AnyKey& any : all_keys()) {
        const auto* const* key = std::get_if<const rig::IntegerKey*>(&any);
        if (key == nullptr) continue;
        const auto [min, max] = (*key)->range;
        const std::string refusal = refusal_of(any) + ", found";
        for (const std::int64_t outside : {min - 1, max + 1})
            EXPECT_THAT(message_with((*key)->path, fmt::format("{}", outside)), HasSubstr(refusal))
                << (*key)->path;
        for (const std::int64_t end : {min, max})
            EXPECT_EQ(message_with((*key)->path, fmt::format("{}", end)), "no error") << (*key)->path;
        ++checked;
    }
    EXPECT_EQ(checked, 10);
}

TEST_F(ScenarioKeys, lists_of_numbers_are_refused_outside_of_the_declared_range) {
    int checked = 0;
    for (const rig::AnyKey& any : all_keys()) {
        const auto* const* key = std::get_if<const rig::NumbersKey*>(&any);
        if (key == nullptr) continue;
        const std::string refusal =
            fmt::format("expected metres from {} to {}, found", (*key)->range.min, (*key)->range.max);
        for (const double end : {(*key)->range.min, (*key)->range.max}) {
            EXPECT_THAT(message_with_numbers(**key, 1.001 * end), HasSubstr(refusal)) << (*key)->path;
            EXPECT_THAT(message_with_numbers(**key, end), Not(HasSubstr(refusal))) << (*key)->path;
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
        EXPECT_THAT(message_without(path),
                    is_required ? HasSubstr("expected this key, found none") : HasSubstr("no error"))
            << path;
    }
}

}  // namespace
}  // namespace octoskin::sim
