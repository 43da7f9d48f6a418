// A part on a bench that looks at a wall, and when its ranges are ready.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/support/vl53l1x/sensor_bench.hpp"

namespace octoskin::sim {

class RangingPart : public testing::Test {
  protected:
    void use(const SensorPart& part) { part_ = &bench_.add_booted(test::wall_at(1.0), part); }
    /// Long mode, 20 ms budget, active-high interrupt, and a nominal period by ST's factor.
    void configure(std::uint32_t period_register) {
        bench_.play(
            "W 0030 01 | W 0060 0F | W 0063 0D | W 0069 B8 | W 005E 00 1E | W 0061 00 22 | W 0081 9B");
        bench_.write(0x006C, {static_cast<std::uint8_t>(period_register >> 24U),
                              static_cast<std::uint8_t>(period_register >> 16U),
                              static_cast<std::uint8_t>(period_register >> 8U),
                              static_cast<std::uint8_t>(period_register)});
    }
    /// Lets `count` results come, clearing each; when each was ready.
    std::vector<std::int64_t> ready_times(std::size_t count) {
        const std::size_t seen = part_->history().size();
        for (std::int64_t waited = 0; waited < 10'000'000 && part_->history().size() < seen + count;
             ++waited) {
            bench_.wait(Microseconds{500});
            part_->advance(bench_.time());
        }
        std::vector<std::int64_t> times;
        for (std::size_t i = seen; i < part_->history().size(); ++i) {
            times.push_back(part_->history()[i].ready.us);
        }
        return times;
    }

    test::SensorBench bench_;
    SensorModel* part_ = nullptr;
};

}  // namespace octoskin::sim
