// Joints of lines of joint states, for tests.
#pragma once

#include <string>

#include "host/apps/daemon/joint_line.hpp"

namespace octoskin::testing_support {

/// One source with the joints q1, q2 ...
inline LineJoints one_source(std::size_t count, double rate_hz = 100.0) {
    LineJoints joints;
    LineJoints::Source& source = joints.sources.emplace_back();
    source.rate_hz = rate_hz;
    for (std::size_t i = 1; i <= count; ++i) source.names.push_back("q" + std::to_string(i));
    return joints;
}

}  // namespace octoskin::testing_support
