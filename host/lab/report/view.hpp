// The viewpoint of a picture.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

namespace octoskin::report {

/// In pixels.
struct PictureSize {
    std::uint32_t width = 900;
    std::uint32_t height = 650;
};

/// Metres, in the frame of the drawn geometry; z is up.
struct View {
    Eigen::Vector3d eye = Eigen::Vector3d::Zero();
    Eigen::Vector3d target = Eigen::Vector3d::UnitX();
    double vertical_fov_rad = 0.5;
    PictureSize size;
};

/// Two views of the same content: from the robot's side (low x), from above and a little to one side, and
/// from the camera's side (high x).
struct ViewPair {
    View front;
    View back;
};
/// Views that just contain all the points.
[[nodiscard]] ViewPair views_of(std::span<const Eigen::Vector3d> points, PictureSize size = {});
/// Whether a point lies within the picture; occlusion is ignored.
[[nodiscard]] bool shows(const View& view, const Eigen::Vector3d& point);

[[nodiscard]] std::vector<Eigen::Vector3d> corners_of(const Eigen::AlignedBox3d& box);

/// The rays of a view.
class ViewRays {
  public:
    explicit ViewRays(const View& view);

    /// Unit direction through a point of the image, in pixels from its top left corner.
    [[nodiscard]] Eigen::Vector3f direction(double column, double row) const;
    /// Width of a pixel at a distance of 1 m, in metres.
    [[nodiscard]] double pixel_size() const noexcept { return pixel_size_; }
    /// Unit direction to the sun, which is behind the viewer on the left.
    [[nodiscard]] Eigen::Vector3f sun() const;

  private:
    Eigen::Vector3d forward_;
    Eigen::Vector3d right_;
    Eigen::Vector3d down_;
    double pixel_size_;
    double half_width_;
    double half_height_;
};

}  // namespace octoskin::report
