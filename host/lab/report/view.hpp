// From where a picture is taken.
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

/// Metres, in the frame of what is drawn; z is up.
struct View {
    Eigen::Vector3d eye = Eigen::Vector3d::Zero();
    Eigen::Vector3d target = Eigen::Vector3d::UnitX();
    double vertical_fov_rad = 0.5;
    PictureSize size;
};

/// Two pictures of one thing: from the robot's side (low x), above and a little to one side, and from the
/// camera's (high x).
struct ViewPair {
    View front;
    View back;
};
/// Both just hold all the points.
[[nodiscard]] ViewPair views_of(std::span<const Eigen::Vector3d> points, PictureSize size = {});
/// Whether a point lies within the picture, whatever may stand before it.
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
    /// Towards the sun, which stands behind the viewer's left shoulder.
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
