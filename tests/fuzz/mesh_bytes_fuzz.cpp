// What the process that reads a mesh sends: refused, or a mesh that is written again as the same bytes.
#include <cassert>

#include "host/io/mesh/mesh_bytes.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin;
    const std::string_view bytes = fuzz::text_of({data, size});
    const auto mesh = mesh_of(bytes);
    if (!mesh) return 0;
    assert(!mesh->triangles.empty() && mesh->triangles.size() <= kMeshTrianglesMax);
    for (const Eigen::Vector3d& vertex : mesh->vertices) assert(vertex.allFinite());
    for (const Eigen::Vector3i& triangle : mesh->triangles)
        assert(triangle.minCoeff() >= 0 &&
               static_cast<std::size_t>(triangle.maxCoeff()) < mesh->vertices.size());
    assert(to_bytes(*mesh) == bytes);
    return 0;
}
