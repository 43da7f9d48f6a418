// Where the mesh files are that a URDF names.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// A ROS package that the user placed: --package-path NAME=DIR.
struct PackagePath {
    std::string name;
    std::filesystem::path folder;
};

/// The value of the option. Error (bad_argument): no name or no folder.
[[nodiscard]] Result<PackagePath, Error> package_path_of(std::string_view text);

/// Folders to look in.
struct MeshSearch {
    std::vector<PackagePath> packages;
    std::string ros_package_path;   ///< of the environment: folders, separated by ':'
    std::string ament_prefix_path;  ///< likewise: prefixes, with packages in share/
};

/// The search of this process: its environment, and `packages`.
[[nodiscard]] MeshSearch mesh_search(std::vector<PackagePath> packages);

class MeshPlaces {
  public:
    /// `urdf`: if it is below a named folder (confined_to_recording()), all meshes are below that folder.
    MeshPlaces(const FilePlace& urdf, MeshSearch search);
    /// Of a URDF whose place is not known: only package:// below the folders of `search`.
    explicit MeshPlaces(MeshSearch search) : search_(std::move(search)) {}

    /// The file of a <mesh filename="...">:
    /// - package://NAME/FILE: below the folder of that package, the first of these that exists: the one given
    ///   with --package-path; NAME in, or at the end of, a folder of ROS_PACKAGE_PATH; share/NAME in a prefix
    ///   of AMENT_PREFIX_PATH; NAME in a folder above the URDF, or the name of such a folder that has a
    ///   package.xml or is that of relative paths. If there is none: the folders from that of the URDF up to
    ///   that of relative paths, as a copy of the package, unless the package.xml there has another name.
    /// - file://FILE, and an absolute path: below one of these folders, or below that of relative paths.
    /// - a relative path: beside the URDF, below the nearest folder above it that has a package.xml, else
    ///   below the parent of its folder.
    /// Symbolic links below these folders are not followed; a package may be a link in ROS_PACKAGE_PATH or
    /// AMENT_PREFIX_PATH. Errors: not_found, with the folder that was looked in, or for a given folder that
    /// does not exist; outside_folder; unsupported (another scheme).
    [[nodiscard]] Result<FilePlace, Error> find(const std::string& uri) const;

  private:
    /// A folder, and the name of the package below it; empty if it is the package. Names below `folder` are
    /// opened without links.
    struct PackageFolder {
        std::filesystem::path folder;
        std::filesystem::path package;
        bool operator==(const PackageFolder&) const = default;
    };
    [[nodiscard]] Result<FilePlace, Error> find_in_package(const std::string& uri) const;
    [[nodiscard]] Result<FilePlace, Error> find_below_roots(const std::filesystem::path& file,
                                                            const std::string& uri) const;
    [[nodiscard]] Result<std::optional<PackageFolder>, Error> folder_of(const std::string& package) const;
    [[nodiscard]] std::vector<std::filesystem::path> copies_of(const std::string& package) const;
    [[nodiscard]] Result<FilePlace, Error> find_in_recording(const std::string& uri) const;

    std::filesystem::path urdf_folder_;  ///< absolute; empty: not known
    std::filesystem::path root_;         ///< of relative paths
    MeshSearch search_;
    std::optional<NamedFolder> recording_;
};

}  // namespace octoskin
