// How thick things are that the camera sees from one side and range sensors from the other, as sensors agree.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace octoskin {

/// By cells of 0.6 m where the camera's side of the surface is. A sensor is never told its own word, nor that
/// of only one other. 200 kB, whatever comes.
class ThicknessMemory {
  public:
    ThicknessMemory();

    /// What a sensor found, along the camera's axis: what it ranged lies so far before the camera's side.
    void add(std::uint16_t sensor, const Eigen::Vector3d& p_map, double thickness_m);

    struct Known {
        double thickness_m = 0.0;
        double sigma_m = 0.0;
    };
    /// What at least two others agree on, and no as many deny.
    [[nodiscard]] std::optional<Known> known_to_others(std::uint16_t sensor,
                                                       const Eigen::Vector3d& p_map) const;

  private:
    struct Word {
        std::uint16_t sensor = 0;
        std::uint16_t count = 0;
        float mean_m = 0.0F;
    };
    static constexpr std::size_t kWords = 8;
    struct Cell {
        std::array<std::int16_t, 3> place{};
        std::uint8_t next = 0;  ///< to be overwritten
        std::array<Word, kWords> words{};
    };
    using Place = std::array<std::int16_t, 3>;

    [[nodiscard]] static Place place_of(const Eigen::Vector3d& p_map);
    [[nodiscard]] std::size_t index_of(const Place& place) const;

    std::vector<Cell> cells_;
};

}  // namespace octoskin
