// The evidence for one fault of one sensor: log-likelihood ratios to a sound sensor, added up.
#pragma once

#include <Eigen/Core>
#include <array>

#include "common/time.hpp"
#include "host/core/beams/beam.hpp"

namespace octoskin {

struct FaultSum {
    double for_it = 0.0;      ///< from the last time that it was 0
    double against_it = 0.0;  ///< the same the other way round
    double shows = 0.0;       ///< how much against it a sound sensor would have by now
    float fors = 0.0F;        ///< of the newest comparisons that say much, about how many are for it
    float againsts = 0.0F;    ///< and against it
    HostTime since{};         ///< when the newest evidence for it began
    /// Where weak evidence for it came from, and how much.
    struct Place {
        Eigen::Vector3f p_map = Eigen::Vector3f::Zero();
        float for_it = 0.0F;
    };
    std::array<Place, 4> places{};

    /// `ratio`: what a comparison says; 0 is nothing. `expected`: what it says against the fault, were the
    /// range the predicted one.
    void add(double ratio, double expected, HostTime now);
    /// The same, of a range that may be of something else: limited for each place.
    void add_weak(double ratio, double expected, const Beam& beam);

    /// The sensor does not have it.
    [[nodiscard]] bool is_excluded() const noexcept { return against_it >= kExcludedFrom; }
    /// Comparisons have said something of it: it would have changed ranges, or there is evidence for it.
    [[nodiscard]] bool has_shown() const noexcept { return for_it > 0.0 || shows >= kShownFrom; }

    /// A fault that is there gets so much against it once in 400 times (e^6; Wald 1945).
    static constexpr double kExcludedFrom = 6.0;
    /// A sound sensor has excluded it by then.
    static constexpr double kShownFrom = 12.0;
};

}  // namespace octoskin
