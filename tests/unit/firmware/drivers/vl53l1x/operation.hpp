// Runs one operation of the driver to its end.
#pragma once

#include "firmware/drivers/vl53l1x/device.hpp"

namespace octoskin::vl53l1x {

/// Polls every 100 us from `now` on, which moves along, until the operation begun is done or has failed, and
/// for 10 s at most: then `Progress::busy` comes back.
[[nodiscard]] inline Progress finish(Device& device, NodeTime& now) {
    for (int polls = 0; polls < 100'000; ++polls) {
        const Progress progress = device.poll(now);
        if (progress != Progress::busy) return progress;
        now = now + Microseconds{100};
    }
    return Progress::busy;
}
[[nodiscard]] inline Progress finish(Device& device) {
    NodeTime now{};
    return finish(device, now);
}

}  // namespace octoskin::vl53l1x
