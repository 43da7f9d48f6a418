// The mesh files of the robot that is shown.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "host/io/robot/mesh_places.hpp"

namespace octoskin::view {

class RobotMeshes {
  public:
    static constexpr std::size_t kBytesMax = std::size_t{32} << 20U;

    explicit RobotMeshes(MeshSearch search) : places_(std::move(search)) {}

    /// The robot is another one.
    void on_urdf(const std::string& text) { urdf_ = text; }
    /// The bytes of a file (.stl, .dae, .obj) that the URDF names as package://NAME/FILE, below the folder of
    /// that package (MeshPlaces); or a sentence why there are none. Reads the whole file: a file system that
    /// does not answer blocks the view.
    [[nodiscard]] Result<std::string, std::string> read(const std::string& uri) const;

  private:
    MeshPlaces places_;
    std::string urdf_;
};

}  // namespace octoskin::view
