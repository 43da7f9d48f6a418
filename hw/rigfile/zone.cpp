#include "hw/rigfile/zone.hpp"

#include <cmath>

namespace octoskin::rig {
namespace {

constexpr int kSide = 16;

/// The zone's first column (0 is left) and row (0 is the top).
struct Corner {
    int left;
    int top;
};

Corner corner_of(const Roi& roi) {
    // The upper half of the table counts up column by column from 128, the lower half down from 127.
    const int centre = roi.centre_spad;
    const int column = centre >= 128 ? (centre - 128) / 8 : (127 - centre) / 8;
    const int row = centre >= 128 ? (centre - 128) % 8 : 8 + (127 - centre) % 8;
    return {column - roi.width / 2, row - (roi.height - 1) / 2};
}

}  // namespace

bool fits_on_array(const Roi& roi) noexcept {
    const auto [left, top] = corner_of(roi);
    return left >= 0 && left + roi.width <= kSide && top >= 0 && top + roi.height <= kSide;
}

Eigen::Vector3d zone_direction(const Roi& roi) noexcept {
    const auto [left, top] = corner_of(roi);
    const double right_spads = left + roi.width / 2.0 - kSide / 2.0;
    const double down_spads = top + roi.height / 2.0 - kSide / 2.0;
    return Eigen::Vector3d(std::tan(-right_spads * kSpadPitch_rad), std::tan(down_spads * kSpadPitch_rad),
                           1.0)
        .normalized();
}

ZoneSpan zone_span_x(const Roi& roi) noexcept {
    // The lens inverts: the zone's right edge has the leftmost view.
    const double left_spads = corner_of(roi).left - kSide / 2.0;
    return {-(left_spads + roi.width) * kSpadPitch_rad, -left_spads * kSpadPitch_rad};
}

ZoneSpan zone_span_y(const Roi& roi) noexcept {
    const double top_spads = corner_of(roi).top - kSide / 2.0;
    return {top_spads * kSpadPitch_rad, (top_spads + roi.height) * kSpadPitch_rad};
}

}  // namespace octoskin::rig
