// How thick things are that the camera sees from one side and range sensors from the other, as sensors agree.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace octoskin {

/// By places, up to 1.2 m about where a surface was first met. A sensor is never told its own word, nor that
/// of only one other. 50 kB, whatever comes.
class ThicknessMemory {
  public:
    ThicknessMemory();

    /// What a sensor found, along the surface's normal: what it ranged lies so far before the camera's side.
    /// About 0.5 us, as the next.
    void add(std::uint16_t sensor, const Eigen::Vector3d& p_map, double thickness_m);

    struct Known {
        double thickness_m = 0.0;
        double sigma_m = 0.0;
    };
    /// The mean of the two others that found it thinnest, if they agree: what stands before a surface, where
    /// the camera does not see it, makes it seem thicker, and nothing makes it seem thinner.
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
        std::uint8_t next = 0;  ///< to be overwritten
        std::array<Word, kWords> words{};
    };

    /// The nearest one's index; empty: none is near.
    [[nodiscard]] std::optional<std::size_t> find(const Eigen::Vector3d& p_map) const;

    std::vector<Place> places_;
    std::size_t next_ = 0;  ///< to be overwritten, once all are in use
};

}  // namespace octoskin
