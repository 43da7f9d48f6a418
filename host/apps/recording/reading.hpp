// One lock for everything that reads rigs, robots and worlds: the libraries beneath log through global state.
#pragma once

#include <mutex>

namespace octoskin {

/// Hold it while calling read_rig, make_host_setup, Arm::read, real_body or World::read, if other threads
/// may.
[[nodiscard]] inline std::unique_lock<std::mutex> lock_reading() {
    static std::mutex mutex;
    return std::unique_lock(mutex);
}

}  // namespace octoskin
