#include "host/lab/evaluation/clean_view.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace octoskin::evaluation {
namespace {

constexpr std::size_t kBlock_px = 16;

std::size_t blocks_along(std::uint32_t pixels) {
    return (pixels + kBlock_px - 1) / kBlock_px;
}

std::vector<RaySlope> slopes_of(const rig::Camera& camera) {
    const LensInverse inverse(camera.lens);
    std::vector<RaySlope> slopes;
    slopes.reserve(std::size_t{camera.width} * camera.height);
    for (std::uint32_t v = 0; v < camera.height; ++v) {
        for (std::uint32_t u = 0; u < camera.width; ++u) {
            const auto slope = inverse.ray_of(picture_of(camera, u, v));
            assert(slope.has_value());  // checked where the rig was read
            slopes.push_back(*slope);
        }
    }
    return slopes;
}

}  // namespace

CleanView::CleanView(const sim::World& world, const rig::Camera& camera)
    : camera_(camera), slopes_(slopes_of(camera)) {
    const auto rays = rays_base();
    double length_max = 1.0;
    for (const RaySlope& slope : slopes_)
        length_max = std::max(length_max, std::sqrt(1.0 + slope.x * slope.x + slope.y * slope.y));
    std::vector<sim::RayHit> hits(rays.size());
    const Eigen::Vector3d p_base_camera = camera.T_link_camera.translation();
    world.cast_fan(p_base_camera, rays, camera.depth_max_m * length_max, hits);
    const Eigen::Vector3d axis_base = camera.T_link_camera.linear().col(2);
    depth_m_.resize(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const double depth_m = hits[i].range_m * rays[i].dot(axis_base);
        if (!(depth_m >= camera.depth_min_m && depth_m <= camera.depth_max_m)) continue;
        depth_m_[i] = depth_m;
        const bool is_front = hits[i].normal.dot(rays[i]) <= 0.0;  // not so on an open mesh's back
        points_.push_back({p_base_camera + hits[i].range_m * rays[i],
                           is_front ? hits[i].normal : Eigen::Vector3d(-hits[i].normal), hits[i].solid,
                           depth_m});
    }
    find_nearest_of_blocks();
}

void CleanView::find_nearest_of_blocks() {
    const std::size_t columns = blocks_along(camera_.width);
    block_depth_m_.assign(columns * blocks_along(camera_.height), std::numeric_limits<double>::infinity());
    for (std::size_t pixel = 0; pixel < depth_m_.size(); ++pixel) {
        const std::size_t column = pixel % camera_.width / kBlock_px;
        double& nearest = block_depth_m_[pixel / camera_.width / kBlock_px * columns + column];
        nearest = std::min(nearest, depth_m_[pixel]);
    }
}

std::vector<Eigen::Vector3d> CleanView::rays_base() const {
    std::vector<Eigen::Vector3d> rays;
    rays.reserve(slopes_.size());
    for (const RaySlope& slope : slopes_) {
        const Eigen::Vector3d ray_camera = Eigen::Vector3d(slope.x, slope.y, 1.0).normalized();
        rays.emplace_back(camera_.T_link_camera.linear() * ray_camera);
    }
    return rays;
}

CleanView::Rectangle CleanView::rectangle_round(const Ball& ball) const {
    // Round the ball's cube, whose front looks largest unless the cube is beside the axis.
    const double near_m = ball.p_camera.z() - ball.radius_m;
    const double far_m = ball.p_camera.z() + ball.radius_m;
    const auto low = [&](double middle) {
        const double side = middle - ball.radius_m;
        return std::min(side / near_m, side / far_m);
    };
    const auto high = [&](double middle) {
        const double side = middle + ball.radius_m;
        return std::max(side / near_m, side / far_m);
    };
    Rectangle box{1e9, -1e9, 1e9, -1e9};
    const int steps = camera_.lens.is_none() ? 1 : 4;  // along an edge, which a lens bends
    for (int i = 0; i < (steps + 1) * (steps + 1); ++i) {
        const int column = i % (steps + 1);
        const int row = i / (steps + 1);
        const double along_x = static_cast<double>(column) / steps;
        const double along_y = static_cast<double>(row) / steps;
        const RaySlope seen =
            distorted(camera_.lens, {std::lerp(low(ball.p_camera.x()), high(ball.p_camera.x()), along_x),
                                     std::lerp(low(ball.p_camera.y()), high(ball.p_camera.y()), along_y)});
        const double u = seen.x * camera_.fx + camera_.cx;
        const double v = seen.y * camera_.fy + camera_.cy;
        box = {std::min(box.u_begin, std::floor(u - 1.0)), std::max(box.u_end, std::ceil(u + 1.0)),
               std::min(box.v_begin, std::floor(v - 1.0)), std::max(box.v_end, std::ceil(v + 1.0))};
    }
    return box;
}

bool CleanView::sees_behind_centre(const Ball& ball) const {
    const RaySlope seen = distorted(
        camera_.lens, {ball.p_camera.x() / ball.p_camera.z(), ball.p_camera.y() / ball.p_camera.z()});
    const double u = seen.x * camera_.fx + camera_.cx;
    const double v = seen.y * camera_.fy + camera_.cy;
    if (!(u >= 0.0 && v >= 0.0 && u < camera_.width && v < camera_.height)) return false;
    return depth_m_[static_cast<std::size_t>(v) * camera_.width + static_cast<std::size_t>(u)] >
           ball.p_camera.z();
}

bool CleanView::sees_behind(std::size_t pixel, const Ball& ball) const {
    const Eigen::Vector3d ray(slopes_[pixel].x, slopes_[pixel].y, 1.0);
    const double squared = ray.squaredNorm();
    const double middle = ray.dot(ball.p_camera) / squared;  // in depths, as the ray's z is 1
    const double gap_squared = (ball.p_camera - middle * ray).squaredNorm();
    const double half_squared = (ball.radius_m * ball.radius_m - gap_squared) / squared;
    return half_squared <= 0.0 || depth_m_[pixel] > middle + std::sqrt(half_squared);
}

bool CleanView::block_sees_behind(std::size_t column, std::size_t row, const Rectangle& rectangle,
                                  const Ball& ball) const {
    const double far_m = ball.p_camera.z() + ball.radius_m;
    if (block_depth_m_[row * blocks_along(camera_.width) + column] > far_m) return true;
    const auto from = [](std::size_t block, double begin) {
        return std::max(block * kBlock_px, static_cast<std::size_t>(begin));
    };
    const auto to = [](std::size_t block, double end) {
        return std::min((block + 1) * kBlock_px, static_cast<std::size_t>(end));
    };
    for (std::size_t v = from(row, rectangle.v_begin); v < to(row, rectangle.v_end); ++v) {
        for (std::size_t u = from(column, rectangle.u_begin); u < to(column, rectangle.u_end); ++u) {
            if (!sees_behind(v * camera_.width + u, ball)) return false;
        }
    }
    return true;
}

bool CleanView::is_clear(const Eigen::Vector3d& p_base, double radius_m) const {
    const Ball ball{camera_.T_link_camera.inverse() * p_base, radius_m};
    if (ball.p_camera.z() <= 2.0 * radius_m || !sees_behind_centre(ball)) return false;
    const Rectangle box = rectangle_round(ball);
    if (box.u_begin < 0.0 || box.v_begin < 0.0 || box.u_end > camera_.width || box.v_end > camera_.height)
        return false;
    const auto block_of = [](double pixel) { return static_cast<std::size_t>(pixel) / kBlock_px; };
    for (std::size_t row = block_of(box.v_begin); row <= block_of(box.v_end - 1.0); ++row) {
        for (std::size_t column = block_of(box.u_begin); column <= block_of(box.u_end - 1.0); ++column) {
            if (!block_sees_behind(column, row, box, ball)) return false;
        }
    }
    return true;
}

}  // namespace octoskin::evaluation
