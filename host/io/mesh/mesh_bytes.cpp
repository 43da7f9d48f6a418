#include "host/io/mesh/mesh_bytes.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace octoskin {
namespace {

struct Head {
    std::uint64_t mark = 0x3148'5345'4D4F'534BU;
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
};

constexpr std::size_t kVertexBytes = 3 * sizeof(double);
constexpr std::size_t kTriangleBytes = 3 * sizeof(int);

}  // namespace

std::string to_bytes(const TriangleMesh& mesh) {
    const Head head{.vertices = mesh.vertices.size(), .triangles = mesh.triangles.size()};
    std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
    for (const Eigen::Vector3d& vertex : mesh.vertices)
        bytes.append(reinterpret_cast<const char*>(vertex.data()), kVertexBytes);
    for (const Eigen::Vector3i& triangle : mesh.triangles)
        bytes.append(reinterpret_cast<const char*>(triangle.data()), kTriangleBytes);
    return bytes;
}

std::optional<TriangleMesh> mesh_of(std::string_view bytes) {
    Head head;
    if (bytes.size() < sizeof head) return std::nullopt;
    std::memcpy(&head, bytes.data(), sizeof head);
    if (head.mark != Head{}.mark || head.vertices > kMeshVerticesMax || head.triangles > kMeshTrianglesMax ||
        head.triangles == 0 ||
        bytes.size() != sizeof head + head.vertices * kVertexBytes + head.triangles * kTriangleBytes)
        return std::nullopt;
    TriangleMesh mesh;
    mesh.vertices.resize(head.vertices);
    mesh.triangles.resize(head.triangles);
    const char* from = bytes.data() + sizeof head;
    for (Eigen::Vector3d& vertex : mesh.vertices) {
        std::memcpy(vertex.data(), from, kVertexBytes);
        from += kVertexBytes;
        if (!vertex.allFinite()) return std::nullopt;
    }
    for (Eigen::Vector3i& triangle : mesh.triangles) {
        std::memcpy(triangle.data(), from, kTriangleBytes);
        from += kTriangleBytes;
        if (triangle.minCoeff() < 0 || static_cast<std::size_t>(triangle.maxCoeff()) >= head.vertices)
            return std::nullopt;
    }
    return mesh;
}

}  // namespace octoskin
