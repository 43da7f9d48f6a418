#include "host/bridge/view/robot_meshes.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "host/io/folder/folder_error.hpp"

namespace octoskin::view {
namespace {

bool is_mesh(std::string uri) {
    constexpr std::array<std::string_view, 3> kEndings = {".stl", ".dae", ".obj"};
    std::ranges::transform(uri, uri.begin(),
                           [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return std::ranges::any_of(kEndings, [&](std::string_view ending) { return uri.ends_with(ending); });
}

/// As an attribute. A name with characters that XML escapes is not found.
bool names(const std::string& urdf, const std::string& uri) {
    if (uri.find_first_of("\"'<>&") != std::string::npos) return false;
    return urdf.find('"' + uri + '"') != std::string::npos ||
           urdf.find('\'' + uri + '\'') != std::string::npos;
}

/// A client need not know the folders of this machine: they are in the log.
std::string refusal(const std::string& uri, const Error& error) {
    spdlog::warn("a mesh is not served: {}", error.message());
    const std::string why =
        error.code == ErrorCode::not_found ? "there is no file " + uri : "cannot read " + uri;
    return error.remedy.empty() ? why : why + ": " + error.remedy;
}

}  // namespace

Result<std::string, std::string> RobotMeshes::read(const std::string& uri) const {
    if (!is_mesh(uri) || !names(urdf_, uri))
        return unexpected(std::string("the robot has no mesh of this name"));
    const auto place = places_.find(uri);
    if (!place) return unexpected(refusal(uri, place.error()));
    auto bytes = place->read(kBytesMax);
    if (!bytes) return unexpected(refusal(uri, to_error(bytes.error())));
    if (bytes->size() > kBytesMax) return unexpected("the file has more than 32 MiB: " + uri);
    return std::move(bytes).value();
}

}  // namespace octoskin::view
