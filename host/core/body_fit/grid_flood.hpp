// Which cells of a grid are reached from its corner.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace octoskin {

/// The cells that a way across faces leads to from the first one, which it may begin in, without a cell for
/// which is_closed(cell) is true. Cells are numbered with x fastest, then y. O(cells).
template <typename IsClosed>
std::vector<bool> reached_from_corner(const Eigen::Vector3i& size, const IsClosed& is_closed) {
    const auto number_of = [&size](const Eigen::Vector3i& at) {
        return static_cast<std::size_t>((at.z() * size.y() + at.y()) * size.x() + at.x());
    };
    std::vector<bool> is_reached(static_cast<std::size_t>(size.prod()), false);
    std::vector<Eigen::Vector3i> open{Eigen::Vector3i::Zero()};
    is_reached[0] = true;
    while (!open.empty()) {
        const Eigen::Vector3i at = open.back();
        open.pop_back();
        for (int side = 0; side < 6; ++side) {
            Eigen::Vector3i next = at;
            next[side / 2] += side % 2 == 0 ? 1 : -1;
            if ((next.array() < 0).any() || (next.array() >= size.array()).any()) continue;
            const std::size_t cell = number_of(next);
            if (is_reached[cell] || is_closed(cell)) continue;
            is_reached[cell] = true;
            open.push_back(next);
        }
    }
    return is_reached;
}

}  // namespace octoskin
