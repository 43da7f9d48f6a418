#include "hw/mesh/mesh_file.hpp"

#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "hw/mesh/mesh_kinds.hpp"
#include "hw/mesh/mesh_text.hpp"
#include "hw/rigfile/file_kind.hpp"

namespace octoskin {
namespace {

/// The reader's file endings are separated by blanks.
bool reads_a_kind(const Assimp::BaseImporter& reader) {
    std::string_view endings = reader.GetInfo()->mFileExtensions;
    while (!endings.empty()) {
        const std::string_view ending = endings.substr(0, endings.find(' '));
        if (is_mesh_kind(ending)) return true;
        endings.remove_prefix(std::min(ending.size() + 1, endings.size()));
    }
    return false;
}

/// assimp has about forty readers and selects one by a file's content, independent of its name.
void keep_readers_of_our_kinds(Assimp::Importer& importer) {
    for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
        Assimp::BaseImporter* const reader = importer.GetImporter(i);
        if (reads_a_kind(*reader)) continue;
        importer.UnregisterLoader(reader);
        const std::unique_ptr<Assimp::BaseImporter> ours(reader);  // owned here from now on
    }
}

Eigen::Affine3d transform_of(const aiNode& node) {
    const aiMatrix4x4& from = node.mTransformation;
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            transform(row, column) =
                static_cast<double>(from[static_cast<unsigned>(row)][static_cast<unsigned>(column)]);
    return transform;
}

/// Calls `use(part, transform)` for each mesh of each node. assimp's own step for this,
/// aiProcess_PreTransformVertices, leaves out a transform whose entries differ by less than 0.01 from the
/// identity's, that is, up to 10 mm. Without recursion: the depth is the file's.
template <class Use>
void for_each_part(const aiScene& scene, Use&& use) {
    std::vector<std::pair<const aiNode*, Eigen::Affine3d>> open{
        {scene.mRootNode, Eigen::Affine3d::Identity()}};
    while (!open.empty()) {
        const aiNode& node = *open.back().first;
        const Eigen::Affine3d transform = open.back().second * transform_of(node);
        open.pop_back();
        for (unsigned i = 0; i < node.mNumMeshes; ++i) use(*scene.mMeshes[node.mMeshes[i]], transform);
        for (unsigned i = node.mNumChildren; i-- > 0;) open.emplace_back(node.mChildren[i], transform);
    }
}

/// The triangles and their corners: points and lines have no surface, and no part in the mesh's size.
/// Triangles of a mirrored part have their corners in the other order, to run anticlockwise.
void append(const aiMesh& part, const Eigen::Affine3d& transform, TriangleMesh& mesh) {
    constexpr int kUnused = -1;
    const bool is_mirrored = transform.linear().determinant() < 0.0;
    std::vector<int> number_of(part.mNumVertices, kUnused);
    const auto number = [&](unsigned corner) {
        int& known = number_of[corner];
        if (known != kUnused) return known;
        const aiVector3D& vertex = part.mVertices[corner];
        known = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(transform * Eigen::Vector3d(static_cast<double>(vertex.x),
                                                            static_cast<double>(vertex.y),
                                                            static_cast<double>(vertex.z)));
        return known;
    };
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
        const aiFace& face = part.mFaces[i];
        if (face.mNumIndices != 3) continue;
        const int a = number(face.mIndices[0]);
        const int b = number(face.mIndices[is_mirrored ? 2 : 1]);
        mesh.triangles.emplace_back(a, b, number(face.mIndices[is_mirrored ? 1 : 2]));
    }
}

/// The triangles that all polygons of a part are, whether or not they are cut yet; points and lines have
/// none.
std::size_t triangles_in(const aiMesh& part) {
    std::size_t count = 0;
    for (unsigned k = 0; k < part.mNumFaces; ++k) {
        const unsigned corners = part.mFaces[k].mNumIndices;
        if (corners > 2) count += corners - 2;
    }
    return count;
}

/// Those of a part that several nodes show count several times.
std::size_t triangles_in(const aiScene& scene) {
    std::map<const aiMesh*, std::size_t> counts;
    for (unsigned i = 0; i < scene.mNumMeshes; ++i)
        counts[scene.mMeshes[i]] = triangles_in(*scene.mMeshes[i]);
    std::size_t count = 0;
    for_each_part(scene, [&](const aiMesh& part, const Eigen::Affine3d&) { count += counts[&part]; });
    return count;
}

/// Opens allowed files only, for reading, by the paths of checked descriptors.
class CheckedFiles final : public Assimp::DefaultIOSystem {
  public:
    explicit CheckedFiles(const AllowedFiles& files) : files_(files) {}

    bool Exists(const char* file) const override { return files_.openable(file).has_value(); }
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        const auto path = files_.openable(file);
        return path && std::string_view(mode).starts_with('r') ? DefaultIOSystem::Open(path->c_str(), mode)
                                                               : nullptr;
    }

  private:
    const AllowedFiles& files_;
};

Result<MeshText, std::string> checked_text(const std::filesystem::path& file, const AllowedFiles* files) {
    const auto path =
        files == nullptr ? Result<std::filesystem::path, std::string>(file) : files->openable(file);
    if (!path) return unexpected(std::string("cannot be opened"));
    std::ifstream stream(*path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    return check_mesh_text(file.extension().string(), bytes);
}

/// What the text's corners and those that are read may differ by: assimp has floats.
bool is_same_box(const Eigen::AlignedBox3d& text, const Eigen::AlignedBox3d& found) {
    constexpr double kRelative = 1e-5;
    const double largest = std::max(text.min().cwiseAbs().maxCoeff(), text.max().cwiseAbs().maxCoeff());
    const double difference = std::max((text.min() - found.min()).cwiseAbs().maxCoeff(),
                                       (text.max() - found.max()).cwiseAbs().maxCoeff());
    return difference <= kRelative * largest;
}

/// It goes on behind the mesh's name.
std::optional<std::string> fault_of(const TriangleMesh& mesh, const MeshText& text) {
    if (mesh.triangles.empty()) return " has no triangles";
    Eigen::AlignedBox3d box;
    for (const auto& vertex : mesh.vertices) {
        if (!vertex.allFinite()) return " has a coordinate that is not a finite number";
        box.extend(vertex);
    }
    if (text.box && !is_same_box(*text.box, box))
        return " has corners at other places than are read: it is of an unusual form; export it anew as "
               "binary STL";
    return std::nullopt;
}

}  // namespace

Result<TriangleMesh, std::string> read_mesh(const std::filesystem::path& file, const AllowedFiles* files) {
    if (!has_mesh_kind(file)) {
        return unexpected("mesh " + file.string() +
                          ": is neither .stl nor .obj nor .dae (COLLADA); convert it to one of them");
    }
    if (files != nullptr) {
        if (const auto path = files->openable(file); !path)
            return unexpected("mesh " + file.string() + ": " + path.error());
    }
    const auto kind = files == nullptr ? rig::other_than_a_file(file) : std::string_view();
    if (!kind.empty())
        return unexpected("mesh " + file.string() + " is " + std::string(kind) + ", not an ordinary file");
    Assimp::Importer importer;
    keep_readers_of_our_kinds(importer);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    const auto text = checked_text(file, files);
    if (!text) return unexpected("mesh " + file.string() + " " + text.error());
    if (files != nullptr) importer.SetIOHandler(new CheckedFiles(*files));  // the importer owns it
    const aiScene* scene = importer.ReadFile(file.string(), 0);
    const std::size_t expected = scene == nullptr ? 0 : triangles_in(*scene);
    if (scene != nullptr && (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0)
        return unexpected("mesh " + file.string() + " is not complete");
    if (scene != nullptr && text->triangles != expected) {
        return unexpected("mesh " + file.string() + " has " + std::to_string(text->triangles) +
                          " triangles in its text, and " + std::to_string(expected) +
                          " are read: it is damaged, or of an unusual form; export it anew as binary STL");
    }
    if (scene != nullptr) scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
    if (scene != nullptr && triangles_in(*scene) < expected) {
        return unexpected("mesh " + file.string() + " has polygons that cannot be cut into triangles: " +
                          std::to_string(expected - triangles_in(*scene)) + " of " +
                          std::to_string(expected) + " triangles are lost; export it as triangles");
    }
    if (scene == nullptr) {
        return unexpected("cannot read mesh " + file.string() + ": " + importer.GetErrorString());
    }
    TriangleMesh mesh;
    for_each_part(*scene, [&mesh](const aiMesh& part, const Eigen::Affine3d& transform) {
        append(part, transform, mesh);
    });
    if (auto fault = fault_of(mesh, *text)) return unexpected("mesh " + file.string() + *fault);
    return mesh;
}

}  // namespace octoskin
