// A cloud of points with fields of 32-bit floats.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "ros_messages.hpp"

namespace octoskin::bridge {

template <std::size_t kFields>
class FloatCloud {
  public:
    FloatCloud(const ros::std_msgs::Header& header, const std::array<const char*, kFields>& names) {
        cloud_.header = header;
        cloud_.height = 1;
        for (std::uint32_t i = 0; i < kFields; ++i)
            cloud_.fields.push_back({names[i], 4 * i, ros::sensor_msgs::PointField::kFloat32, 1});
        cloud_.point_step = 4 * kFields;
        cloud_.is_dense = true;
    }

    void add(const std::array<float, kFields>& point) {
        const auto* const bytes = reinterpret_cast<const std::uint8_t*>(point.data());
        cloud_.data.insert(cloud_.data.end(), bytes, bytes + sizeof(point));
    }
    [[nodiscard]] ros::sensor_msgs::PointCloud2 take() && {
        cloud_.width = static_cast<std::uint32_t>(cloud_.data.size() / cloud_.point_step);
        cloud_.row_step = static_cast<std::uint32_t>(cloud_.data.size());
        return std::move(cloud_);
    }

  private:
    ros::sensor_msgs::PointCloud2 cloud_;
};

}  // namespace octoskin::bridge
