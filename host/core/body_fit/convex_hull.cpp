#include "host/core/body_fit/convex_hull.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace octoskin {
namespace {

constexpr double kFlat_m = 1e-5;
constexpr std::uint64_t kComparisonsOfStep = 8;  ///< a comparison takes about 5 ns

/// The same number from -1 to 1 in each run for the same index.
double scatter(std::uint64_t index) {
    std::uint64_t bits = index + 0x9E3779B97F4A7C15U;  // splitmix64 (Steele 2014)
    bits = (bits ^ (bits >> 30U)) * 0xBF58476D1CE4E5B9U;
    bits = (bits ^ (bits >> 27U)) * 0x94D049BB133111EBU;
    bits ^= bits >> 31U;
    return static_cast<double>(bits >> 11U) * 0x1.0p-52 - 1.0;
}

}  // namespace

/// The faces while points are added, each with the points beyond it.
class HullBuilder {
  public:
    HullBuilder(std::span<const Eigen::Vector3d> points, double flat_m, FitWork* work)
        : beyond_m_(std::max(flat_m, 1e-12)), work_(work) {
        points_.reserve(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Eigen::Vector3d shift(scatter(3 * i), scatter(3 * i + 1), scatter(3 * i + 2));
            points_.push_back(points[i] + ConvexHull::kTolerance_m * shift);
        }
    }

    [[nodiscard]] bool build() {
        if (!start()) return false;
        // Each round makes one point a corner of the hull.
        for (std::size_t next = 0; next < faces_.size(); ++next) {
            if (work_ != nullptr && work_->is_spent()) return false;
            if (faces_[next].is_alive && !faces_[next].beyond.empty()) extend(next);
        }
        return work_ == nullptr || !work_->is_spent();
    }

    [[nodiscard]] ConvexHull result() const {
        ConvexHull hull;
        const Eigen::Vector3d& origin = points_[first_];
        for (const Face& face : faces_) {
            if (!face.is_alive) continue;
            hull.planes_.push_back({face.normal, face.offset_m});
            const auto at = [&](std::size_t i) { return Eigen::Vector3d(points_[face.corners[i]] - origin); };
            hull.volume_m3_ += at(0).dot(at(1).cross(at(2))) / 6.0;
        }
        return hull;
    }

  private:
    using Corners = std::array<std::size_t, 3>;
    struct Face {
        Corners corners{};
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        double offset_m = 0.0;
        std::vector<std::size_t> beyond;  ///< the farthest first
        bool is_alive = true;
    };

    [[nodiscard]] double height(const Face& face, std::size_t point) const {
        return face.normal.dot(points_[point]) - face.offset_m;
    }

    std::size_t add_face(Corners corners) {
        Face face;
        face.corners = corners;
        face.normal = (points_[corners[1]] - points_[corners[0]])
                          .cross(points_[corners[2]] - points_[corners[0]])
                          .normalized();
        face.offset_m = face.normal.dot(points_[corners[0]]);
        for (std::size_t i = 0; i < 3; ++i)
            face_of_edge_[key(corners[i], corners[(i + 1) % 3])] = faces_.size();
        faces_.push_back(std::move(face));
        return faces_.size() - 1;
    }

    [[nodiscard]] static std::uint64_t key(std::size_t from, std::size_t to) {
        return (static_cast<std::uint64_t>(from) << 32U) | static_cast<std::uint64_t>(to);
    }

    /// The tetrahedron of far points with which the hull begins.
    bool start() {
        if (points_.size() < 4) return false;
        const auto farthest = [&](auto&& distance) {
            std::size_t best = 0;
            for (std::size_t i = 1; i < points_.size(); ++i)
                if (distance(points_[i]) > distance(points_[best])) best = i;
            return best;
        };
        first_ = farthest([](const Eigen::Vector3d& p) { return p.x(); });
        const Eigen::Vector3d a = points_[first_];
        const std::size_t second = farthest([&](const Eigen::Vector3d& p) { return (p - a).squaredNorm(); });
        const Eigen::Vector3d along = points_[second] - a;
        const std::size_t third =
            farthest([&](const Eigen::Vector3d& p) { return along.cross(p - a).squaredNorm(); });
        const Eigen::Vector3d normal = along.cross(points_[third] - a);
        const auto height_of = [&](const Eigen::Vector3d& p) { return std::abs(normal.dot(p - a)); };
        const std::size_t fourth = farthest(height_of);
        if (!(height_of(points_[fourth]) > kFlat_m * normal.norm())) return false;
        Corners base{first_, second, third};
        if (normal.dot(points_[fourth] - a) > 0.0) std::swap(base[1], base[2]);
        add_face(base);
        for (std::size_t i = 0; i < 3; ++i) add_face({base[(i + 1) % 3], base[i], fourth});
        std::vector<std::size_t> all(points_.size());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
        distribute(all, 0);
        return true;
    }

    /// Gives each point to the first face from `from` on that it is beyond.
    void distribute(const std::vector<std::size_t>& points, std::size_t from) {
        std::uint64_t steps = 0;
        for (const std::size_t point : points) {
            for (std::size_t i = from; i < faces_.size(); ++i) {
                ++steps;
                const double height_m = height(faces_[i], point);
                if (!(height_m > beyond_m_)) continue;
                auto& beyond = faces_[i].beyond;
                beyond.push_back(point);
                if (height_m > height(faces_[i], beyond.front())) std::swap(beyond.front(), beyond.back());
                break;
            }
        }
        if (work_ != nullptr) (void)work_->spend(steps / kComparisonsOfStep + 1);
    }

    /// Replaces the faces that the point farthest beyond `seed` sees by faces from their border to it.
    void extend(std::size_t seed) {
        const std::size_t top = faces_[seed].beyond.front();
        std::vector<std::size_t> seen{seed};
        faces_[seed].is_alive = false;
        std::vector<std::pair<std::size_t, std::size_t>> border;
        std::vector<std::size_t> orphans;
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const Corners corners = faces_[seen[i]].corners;
            for (std::size_t edge = 0; edge < 3; ++edge) {
                const std::size_t from = corners[edge];
                const std::size_t to = corners[(edge + 1) % 3];
                const std::size_t neighbour = face_of_edge_.at(key(to, from));
                if (!faces_[neighbour].is_alive) continue;
                if (height(faces_[neighbour], top) > 0.0) {
                    faces_[neighbour].is_alive = false;
                    seen.push_back(neighbour);
                } else {
                    border.emplace_back(from, to);
                }
            }
        }
        for (const std::size_t face : seen) {
            for (const std::size_t point : faces_[face].beyond)
                if (point != top) orphans.push_back(point);
            faces_[face].beyond.clear();
        }
        const std::size_t first_new = faces_.size();
        for (const auto& [from, to] : border) add_face({from, to, top});
        distribute(orphans, first_new);
    }

    double beyond_m_;
    FitWork* work_;
    std::vector<Eigen::Vector3d> points_;
    std::vector<Face> faces_;
    std::unordered_map<std::uint64_t, std::size_t> face_of_edge_;
    std::size_t first_ = 0;
};

std::optional<ConvexHull> ConvexHull::around(std::span<const Eigen::Vector3d> points, double flat_m,
                                             FitWork* work) {
    HullBuilder builder(points, flat_m, work);
    if (!builder.build()) return std::nullopt;
    return builder.result();
}

bool ConvexHull::contains(const Eigen::Vector3d& point) const noexcept {
    return std::ranges::all_of(planes_, [&](const Plane& plane) {
        return plane.normal.dot(point) <= plane.offset_m + kTolerance_m;
    });
}

RowInterval ConvexHull::row(double y, double z) const noexcept {
    RowInterval row{-1e9, 1e9};
    for (const Plane& plane : planes_) {
        const double left = plane.offset_m - plane.normal.y() * y - plane.normal.z() * z;
        const double slope = plane.normal.x();
        if (slope > 1e-12) {
            row.to = std::min(row.to, left / slope);
        } else if (slope < -1e-12) {
            row.from = std::max(row.from, left / slope);
        } else if (left < -kTolerance_m) {
            return {};
        }
    }
    return row;
}

}  // namespace octoskin
