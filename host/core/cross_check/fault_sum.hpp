// Accumulated evidence for one fault of one sensor: log-likelihood ratios to a healthy sensor.
#pragma once

#include <Eigen/Core>
#include <array>

#include "common/time.hpp"
#include "host/core/beams/beam.hpp"

namespace octoskin {

struct FaultSum {
    double for_it = 0.0;      ///< since it was last 0
    double against_it = 0.0;  ///< the same against the fault
    double shows = 0.0;       ///< evidence against the fault that a healthy sensor would have by now
    float fors = 0.0F;        ///< of the newest strong comparisons, about how many are for the fault
    float againsts = 0.0F;    ///< and against it
    HostTime since{};         ///< when the newest evidence for it began
    /// A place of weak evidence for the fault, and its amount.
    struct Place {
        Eigen::Vector3f p_map = Eigen::Vector3f::Zero();
        float for_it = 0.0F;
    };
    std::array<Place, 4> places{};

    /// `ratio`: evidence of a comparison; 0: none. `expected`: its evidence against the fault if the range
    /// were the predicted one.
    void add(double ratio, double expected, HostTime now);
    /// The same for a range that may come from another object: limited for each place.
    void add_weak(double ratio, double expected, const Beam& beam);

    /// The sensor does not have the fault.
    [[nodiscard]] bool is_excluded() const noexcept { return against_it >= kExcludedFrom; }
    /// Comparisons were informative about the fault: it would have changed ranges, or there is evidence for
    /// it.
    [[nodiscard]] bool has_shown() const noexcept { return for_it > 0.0 || shows >= kShownFrom; }

    /// A true fault reaches this evidence against it once in 400 times (e^6; Wald 1945).
    static constexpr double kExcludedFrom = 6.0;
    /// A healthy sensor has excluded the fault by then.
    static constexpr double kShownFrom = 12.0;
};

}  // namespace octoskin
