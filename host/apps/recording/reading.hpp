// One lock for all readers of rigs, robots and worlds: the libraries they use log through global state.
#pragma once

#include <mutex>

namespace octoskin {

/// Hold it during read_rig, make_host_setup, Arm::read, real_body or World::read if other threads may call
/// them.
[[nodiscard]] inline std::unique_lock<std::mutex> lock_reading() {
    static std::mutex mutex;
    return std::unique_lock(mutex);
}

}  // namespace octoskin
