// The timing budgets that a rig may name are those that the driver can set, of which it has a table of its
// own.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>

#include "firmware/drivers/vl53l1x/timing.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

constexpr std::array<std::pair<const char*, DistanceMode>, 3> kModes = {
    {{"short", DistanceMode::short_range},
     {"medium", DistanceMode::medium_range},
     {"long", DistanceMode::long_range}}};
constexpr int kBudgetMaxMs = 200;  // the wire's time field spans 262 ms

class TimingOfARig : public testing::Test {
  protected:
    bool accepts(const std::string& mode, int budget_ms, int period_ms) {
        const std::string base = std::string(OCTOSKIN_SOURCE_DIR) + "/hw/rigs/bench_one_board.yaml";
        const auto file =
            folder_.write("rig.yaml", "extends: " + base + "\nsensor_defaults: {distance_mode: " + mode +
                                          ", timing_budget_ms: " + std::to_string(budget_ms) +
                                          ", inter_measurement_ms: " + std::to_string(period_ms) + "}\n");
        return read_rig(file).has_value();
    }
    testing_support::ScratchFolder folder_;
};

TEST_F(TimingOfARig, is_what_the_driver_can_set) {
    for (const auto& [name, mode] : kModes) {
        for (const int named : {15, 20, 33, 50, 100, 140, 200, 500}) {
            for (const int budget_ms : {named - 1, named, named + 1}) {
                const bool is_set =
                    vl53l1x::range_timeouts(mode, static_cast<std::uint16_t>(budget_ms)).has_value();
                EXPECT_EQ(accepts(name, budget_ms, budget_ms + 60), is_set && budget_ms <= kBudgetMaxMs)
                    << name << " " << budget_ms;
            }
        }
    }
}

TEST_F(TimingOfARig, leaves_the_pause_that_the_driver_asks_for) {
    for (int period_ms = 20; period_ms < 30; ++period_ms) {
        EXPECT_EQ(accepts("short", 20, period_ms),
                  vl53l1x::is_period_long_enough(20, static_cast<std::uint16_t>(period_ms)))
            << period_ms;
    }
}

}  // namespace
}  // namespace octoskin::rig
