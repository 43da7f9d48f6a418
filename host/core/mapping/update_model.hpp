// Log-odds of one hit or miss by the paper's model: linear in the range, with configurable coefficients.
#pragma once

namespace octoskin {

/// log-odds of a hit = offset - slope * range from `range_min_m` on; 0 below it (and at it, if
/// `is_min_exclusive`).
struct HitModel {
    double offset = 1.0;
    double slope_per_m = 0.0;
    double range_min_m = 0.0;
    bool is_min_exclusive = false;
    /// `range_m`: along the ray, metres. Strong et al. 2021, eq. 7 (proximity) and 8 (depth).
    [[nodiscard]] constexpr float log_odds(double range_m) const noexcept {
        const bool is_below = is_min_exclusive ? range_m <= range_min_m : range_m < range_min_m;
        return is_below ? 0.0F : static_cast<float>(offset - slope_per_m * range_m);
    }
    friend constexpr bool operator==(const HitModel&, const HitModel&) = default;
};

struct UpdateModel {
    HitModel proximity{.offset = 1.0, .slope_per_m = 0.07, .range_min_m = 0.04, .is_min_exclusive = false};
    HitModel depth{.offset = 1.0, .slope_per_m = 0.1, .range_min_m = 0.5, .is_min_exclusive = true};
    float miss_log_odds = -0.4F;
    friend constexpr bool operator==(const UpdateModel&, const UpdateModel&) = default;
};

}  // namespace octoskin
