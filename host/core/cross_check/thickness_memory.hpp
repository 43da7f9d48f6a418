// Thickness of objects that the camera sees from one side and range sensors from the other, where sensors
// agree.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace octoskin {

/// Stored by place, up to 1.2 m around the point where a surface was first met. A sensor is never given its
/// own value, nor that of a single other sensor. 50 kB at most.
class ThicknessMemory {
  public:
    ThicknessMemory();

    /// Adds a sensor's value along the surface's normal: the distance of the measured point from the camera's
    /// side. About 0.5 us, as for `known_to_others`.
    void add(std::uint16_t sensor, const Eigen::Vector3d& p_map, double thickness_m);

    struct Known {
        double thickness_m = 0.0;
        double sigma_m = 0.0;
    };
    /// The mean of the two smallest values of other sensors, if they agree. An object before a surface that
    /// the camera does not see makes it seem thicker; nothing makes it seem thinner.
    [[nodiscard]] std::optional<Known> known_to_others(std::uint16_t sensor,
                                                       const Eigen::Vector3d& p_map) const;

  private:
    struct Word {
        std::uint16_t sensor = 0;
        std::uint16_t count = 0;
        float mean_m = 0.0F;
    };
    static constexpr std::size_t kWords = 8;
    struct Place {
        Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
        std::uint8_t next = 0;  ///< next to be overwritten
        std::array<Word, kWords> words{};
    };

    /// Index of the nearest place; empty if none is near.
    [[nodiscard]] std::optional<std::size_t> find(const Eigen::Vector3d& p_map) const;

    std::vector<Place> places_;
    std::size_t next_ = 0;  ///< next to be overwritten, once all are in use
};

}  // namespace octoskin
