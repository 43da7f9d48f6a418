// Ray-casts a picture's geometry with Embree: sunlight with shadows, ambient occlusion, voxel edges.
#pragma once

#include <memory>

#include "host/lab/report/geometry.hpp"
#include "host/lab/report/image.hpp"
#include "host/lab/report/view.hpp"

namespace octoskin::report {

class Tracer {
  public:
    /// Computes the faces' ambient occlusion here, once for all pictures: about 100 rays a face.
    explicit Tracer(const Geometry& geometry);
    Tracer(Tracer&&) noexcept;
    Tracer& operator=(Tracer&&) noexcept;
    ~Tracer();

    /// 2 x 2 samples a pixel on up to two threads. The same geometry and view give the same bytes. About 0.3
    /// s for 900 x 650 pixels of voxels; triangles and rods have their ambient occlusion sampled and take
    /// three times as long.
    [[nodiscard]] Image render(const View& view) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace octoskin::report
