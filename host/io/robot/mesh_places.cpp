#include "host/io/robot/mesh_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPackage = "package://";
constexpr std::string_view kFile = "file://";
constexpr int kFoldersAbove = 12;

std::vector<fs::path> split(std::string_view paths) {
    std::vector<fs::path> found;
    while (!paths.empty()) {
        const std::string_view path = paths.substr(0, paths.find(':'));
        if (!path.empty()) found.emplace_back(path);
        paths.remove_prefix(std::min(path.size() + 1, paths.size()));
    }
    return found;
}

/// The folders above a file, the nearest first, without the root of the file system.
std::vector<fs::path> folders_above(const fs::path& folder) {
    std::vector<fs::path> above;
    for (fs::path at = folder; at.has_relative_path() && above.size() < kFoldersAbove; at = at.parent_path())
        above.push_back(at);
    return above;
}

std::string environment(const char* name) {
    const char* const text = std::getenv(name);
    return text == nullptr ? "" : text;
}

/// Whether `file`, both absolute and normal, is below `folder`, and its name there.
bool is_below(const fs::path& file, const fs::path& folder, fs::path& name) {
    name = file.lexically_relative(folder);
    return !name.empty() && *name.begin() != ".." && name != ".";
}

/// The <name> in the folder's package.xml; nullopt without such a file, empty without a name in it.
std::optional<std::string> package_name_in(const fs::path& folder) {
    constexpr std::size_t kPackageFileMax = 1U << 20U;
    const auto text = FilePlace(folder / "package.xml").read(kPackageFileMax);
    if (!text) return std::nullopt;
    const auto begin = text->find("<name>");
    const auto end = text->find("</name>");
    if (begin == std::string::npos || end == std::string::npos || end < begin + 6) return std::string();
    const std::string name = text->substr(begin + 6, end - begin - 6);
    const auto first = name.find_first_not_of(" \t\r\n");
    return first == std::string::npos ? std::string()
                                      : name.substr(first, name.find_last_not_of(" \t\r\n") + 1 - first);
}

Error not_found(const std::string& uri, const std::vector<fs::path>& tried, std::string remedy) {
    std::string folders;
    for (const fs::path& folder : tried) folders += (folders.empty() ? "" : ", ") + folder.string();
    return {.code = ErrorCode::not_found,
            .what = "expected this mesh file" +
                    (folders.empty() ? std::string(" in a known package") : " below " + folders),
            .value = "none for " + uri,
            .remedy = std::move(remedy)};
}

/// Links in the path that the user typed are followed; those of a recording's folder are not.
fs::path folder_of_urdf(const FilePlace& urdf) {
    const fs::path folder = fs::absolute(urdf.shown()).lexically_normal().parent_path();
    std::error_code error;
    const fs::path real = urdf.folder() == nullptr ? fs::canonical(folder, error) : folder;
    return error ? folder : real;
}

}  // namespace

Result<PackagePath, Error> package_path_of(std::string_view text) {
    const auto equals = text.find('=');
    if (equals == std::string_view::npos || equals == 0 || equals + 1 == text.size()) {
        return unexpected(Error{.code = ErrorCode::bad_argument,
                                .what = "expected NAME=DIR",
                                .value = fmt::format("'{}'", text),
                                .remedy = "write for example ur_description=/opt/ur_description",
                                .key = "--package-path"});
    }
    return PackagePath{std::string(text.substr(0, equals)), fs::path(text.substr(equals + 1))};
}

MeshSearch mesh_search(std::vector<PackagePath> packages) {
    return {std::move(packages), environment("ROS_PACKAGE_PATH"), environment("AMENT_PREFIX_PATH")};
}

MeshPlaces::MeshPlaces(const FilePlace& urdf, MeshSearch search)
    : urdf_folder_(folder_of_urdf(urdf)), root_(urdf_folder_.parent_path()), search_(std::move(search)) {
    if (urdf.folder() != nullptr) recording_ = *urdf.folder();
    std::error_code ignored;
    for (const fs::path& folder : folders_above(urdf_folder_)) {
        if (!fs::exists(folder / "package.xml", ignored)) continue;
        root_ = folder;
        break;
    }
    if (!root_.has_relative_path()) root_ = urdf_folder_;
}

/// The one that counts, as in ROS: another package of the same name may have other files of the same names.
Result<std::optional<MeshPlaces::PackageFolder>, Error> MeshPlaces::folder_of(
    const std::string& package) const {
    std::error_code ignored;
    std::optional<PackageFolder> first;
    const auto add = [&](const fs::path& folder, const fs::path& below = {}) {
        const PackageFolder found{fs::absolute(folder).lexically_normal(), below};
        if (!first && fs::is_directory(found.folder / below, ignored)) first = found;
    };
    for (const PackagePath& given : search_.packages) {
        if (given.name != package) continue;
        add(given.folder);
        if (first) return first;
        return unexpected(Error{ErrorCode::not_found, "expected a folder", given.folder.string(),
                                "correct --package-path " + package + "=DIR"});
    }
    // The user names these folders; links to packages are usual in them.
    for (fs::path folder : split(search_.ros_package_path)) {
        if (!folder.has_filename()) folder = folder.parent_path();
        add(folder / package);
        if (folder.filename() == package) add(folder);
    }
    for (const fs::path& prefix : split(search_.ament_prefix_path)) add(prefix / "share" / package);
    const auto above = folders_above(urdf_folder_);
    for (const fs::path& folder : above) {
        const fs::path named = folder / package;
        // The URDF is below many folders, of which few are packages.
        const bool is_above = std::ranges::find(above, named) != above.end();
        if (!is_above || named == root_ || fs::exists(named / "package.xml", ignored)) add(folder, package);
    }
    return first;
}

/// Folders that may be a copy of the package under another name: none if their package.xml has another one.
std::vector<fs::path> MeshPlaces::copies_of(const std::string& package) const {
    if (urdf_folder_.empty()) return {};
    const auto name = package_name_in(root_);
    if (name && !name->empty() && *name != package) return {};
    std::vector<fs::path> copies;
    for (const fs::path& folder : folders_above(urdf_folder_)) {
        copies.push_back(folder);
        if (folder == root_) break;
    }
    return copies;
}

/// Below the folder of the recording only: as a path from the URDF's folder, or for package://NAME/FILE as
/// NAME/FILE, or FILE of a copy of the package.
Result<FilePlace, Error> MeshPlaces::find_in_recording(const std::string& uri) const {
    const fs::path base = fs::absolute(recording_->shown()).lexically_normal();
    const bool is_package = uri.starts_with(kPackage);
    const std::string rest = uri.substr(is_package               ? kPackage.size()
                                        : uri.starts_with(kFile) ? kFile.size()
                                                                 : 0);
    std::vector<fs::path> tried{is_package ? base / rest : urdf_folder_ / rest};
    if (is_package && rest.find('/') != std::string::npos)
        tried.push_back(base / fs::path(rest.substr(rest.find('/') + 1)).relative_path());
    for (const fs::path& file : tried) {
        fs::path name;
        if (!is_below(file.lexically_normal(), base, name)) {
            return unexpected(Error{ErrorCode::outside_folder,
                                    "expected a mesh in the folder of the recording", uri,
                                    "copy URDF and meshes out of the recording"});
        }
        FilePlace place(*recording_, name);
        if (place.is_there()) return place;
    }
    return unexpected(not_found(uri, {base}, "copy URDF and meshes out of the recording"));
}

Result<FilePlace, Error> MeshPlaces::find_in_package(const std::string& uri) const {
    const std::string rest = uri.substr(kPackage.size());
    const auto slash = rest.find('/');
    const std::string package = rest.substr(0, slash);
    const fs::path name =
        slash == std::string::npos ? fs::path() : fs::path(rest.substr(slash + 1)).lexically_normal();
    if (package.empty() || package == "." || package == ".." || name.empty())
        return unexpected(Error{ErrorCode::bad_value, "expected package://NAME/FILE", uri});
    if (name.is_absolute() || *name.begin() == "..")
        return unexpected(
            Error{ErrorCode::outside_folder, "expected a file below the folder of the package", uri});
    const auto folder = folder_of(package);
    if (!folder) return unexpected(folder.error());
    std::vector<fs::path> tried;
    if (*folder) {
        FilePlace place(NamedFolder((*folder)->folder), (*folder)->package / name);
        if (place.is_there()) return place;
        tried.push_back((*folder)->folder / (*folder)->package);
    } else {
        for (const fs::path& copy : copies_of(package)) {
            FilePlace place(NamedFolder(copy), name);
            if (place.is_there()) return place;
            tried.push_back(copy);
        }
    }
    const std::string remedy =
        *folder ? fmt::format("add the file there, or give another --package-path {}=DIR", package)
                : fmt::format("give --package-path {}=DIR", package);
    return unexpected(not_found(uri, tried, remedy));
}

Result<FilePlace, Error> MeshPlaces::find_below_roots(const fs::path& file, const std::string& uri) const {
    const fs::path absolute = (urdf_folder_ / file).lexically_normal();
    std::vector<fs::path> roots{root_};
    for (const PackagePath& given : search_.packages)
        roots.push_back(fs::absolute(given.folder).lexically_normal());
    for (const fs::path& folder : split(search_.ros_package_path))
        roots.push_back(fs::absolute(folder).lexically_normal());
    for (const fs::path& prefix : split(search_.ament_prefix_path))
        roots.push_back(fs::absolute(prefix / "share").lexically_normal());
    for (fs::path& root : roots) {
        if (!root.has_filename()) root = root.parent_path();
        fs::path name;
        if (!is_below(absolute, root, name)) continue;
        FilePlace place(NamedFolder(root), name);
        if (place.is_there()) return place;
        return unexpected(not_found(uri, {root}, "put it there"));
    }
    return unexpected(
        Error{ErrorCode::outside_folder,
              fmt::format("expected a mesh below {}, or in a ROS package", root_.string()), uri,
              fmt::format("allow its folder with --package-path NAME={}", absolute.parent_path().string())});
}

Result<FilePlace, Error> MeshPlaces::find(const std::string& uri) const {
    if (uri.find("${") != std::string::npos || uri.find("$(") != std::string::npos)
        return unexpected(Error{ErrorCode::unsupported,
                                "expected a file, because xacro expressions are not evaluated", uri,
                                "expand the xacro: `xacro FILE > EXPANDED.urdf`"});
    if (recording_ &&
        (uri.starts_with(kPackage) || uri.starts_with(kFile) || uri.find("://") == std::string::npos))
        return find_in_recording(uri);
    if (uri.starts_with(kPackage)) return find_in_package(uri);
    if (urdf_folder_.empty())
        return unexpected(Error{ErrorCode::unsupported,
                                "expected package://, because the folder of the URDF is not known", uri});
    if (uri.starts_with(kFile)) return find_below_roots(uri.substr(kFile.size()), uri);
    if (uri.find("://") == std::string::npos) return find_below_roots(uri, uri);
    return unexpected(Error{ErrorCode::unsupported, "expected package://, file:// or a path", uri,
                            "save the mesh in a file; octoskin fetches nothing"});
}

}  // namespace octoskin
