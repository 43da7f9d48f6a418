#include "hw/sim/world/world_copy.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "hw/mesh/mesh_kinds.hpp"
#include "hw/sim/world/model_folders.hpp"

namespace octoskin::sim {
namespace {

constexpr std::string_view kMeshName = "mesh_";
constexpr const char* kLeftOut = "left_out";  ///< in place of a mesh's uri

Result<std::string, std::string> read_all(const FilePlace& file, std::size_t bytes_max) {
    const auto opened = file.open();
    if (!opened) return unexpected(opened.error().message());
    auto bytes = opened->read(bytes_max);
    if (!bytes) return unexpected(bytes.error().message());
    if (bytes->size() > bytes_max)
        return unexpected(fmt::format("{}: has more than {} MiB", file.shown().string(), bytes_max >> 20U));
    return std::move(*bytes);
}

/// The file name in a uri, as the reader of the world takes it.
std::string trimmed(std::string uri) {
    constexpr std::string_view kFileScheme = "file://";
    const auto begin = uri.find_first_not_of(" \t\r\n");
    uri = begin == std::string::npos ? "" : uri.substr(begin, uri.find_last_not_of(" \t\r\n") + 1 - begin);
    if (uri.starts_with(kFileScheme)) uri.erase(0, kFileScheme.size());
    return uri;
}

/// The next element in the order of the file, without recursion.
tinyxml2::XMLElement* after(tinyxml2::XMLElement* element) {
    if (auto* const child = element->FirstChildElement()) return child;
    for (tinyxml2::XMLNode* at = element; at != nullptr; at = at->Parent()) {
        if (auto* const next = at->NextSiblingElement()) return next;
    }
    return nullptr;
}

class Copier {
  public:
    Copier(const FilePlace& sdf, const std::vector<std::string>& meshes) : sdf_(sdf) {
        for (const std::string& mesh : meshes) read_.insert(trimmed(mesh));
    }

    Result<WorldCopy, std::string> copy(const std::string& written_out) {
        auto text = written_out.empty() ? read_all(sdf_, kWorldBytesMax) : written_out;
        if (!text) return unexpected(text.error());
        if (text->size() > kWorldBytesMax) {
            return unexpected(fmt::format("{}: has more than {} MiB with what it includes",
                                          sdf_.shown().string(), kWorldBytesMax >> 20U));
        }
        tinyxml2::XMLDocument document;
        if (document.Parse(text->data(), text->size()) != tinyxml2::XML_SUCCESS)
            return unexpected(sdf_.shown().string() + ": is not XML");
        for (auto* at = document.FirstChildElement(); at != nullptr; at = after(at)) {
            const std::string_view name = at->Name();
            if (name == "include")
                return unexpected(sdf_.shown().string() + ": includes other models, which lie elsewhere");
            const auto* const parent = at->Parent()->ToElement();
            const bool is_mesh =
                name == "uri" && parent != nullptr && std::string_view(parent->Name()) == "mesh";
            if (!is_mesh) continue;
            const auto copied = copy_mesh(at->GetText() == nullptr ? "" : at->GetText());
            if (!copied) return unexpected(copied.error());
            at->SetText(copied->c_str());
        }
        copy_.left_out.assign(left_out_.begin(), left_out_.end());
        if (copy_.meshes.empty() && left_out_.empty()) {
            copy_.sdf = *text;
        } else {
            tinyxml2::XMLPrinter printer;
            document.Print(&printer);
            copy_.sdf = printer.CStr();
        }
        return std::move(copy_);
    }

  private:
    /// Its new name.
    Result<std::string, std::string> copy_mesh(const std::string& written) {
        const std::string uri = trimmed(written);
        if (!read_.contains(uri)) {
            left_out_.insert(uri);
            return std::string(kLeftOut);
        }
        if (const auto known = names_.find(uri); known != names_.end()) return known->second;
        // A world in a recording refers only to files of the recording.
        const auto of_model = sdf_.folder() == nullptr ? find_model_file(uri) : std::nullopt;
        const FilePlace mesh = of_model ? FilePlace(*of_model) : sdf_.beside(uri);
        std::string ending = mesh.name().extension().string();
        std::transform(ending.begin(), ending.end(), ending.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        const std::string name = fmt::format("{}{:02}{}", kMeshName, copy_.meshes.size() + 1, ending);
        if (copy_.meshes.size() == kMeshesMax)
            return unexpected(fmt::format("{}: has more than {} meshes", sdf_.shown().string(), kMeshesMax));
        if (!has_mesh_kind(name))
            return unexpected(mesh.shown().string() + ": does not have the ending of a mesh file");
        auto bytes = read_all(mesh, kMeshBytesMax);
        if (!bytes) return unexpected(bytes.error());
        bytes_ += bytes->size();
        if (bytes_ > kMeshesBytesMax)
            return unexpected(fmt::format("{}: its meshes have more than {} MiB", sdf_.shown().string(),
                                          kMeshesBytesMax >> 20U));
        copy_.meshes.push_back({name, std::move(*bytes)});
        names_[uri] = name;
        return name;
    }

    const FilePlace& sdf_;
    std::set<std::string> read_;
    std::set<std::string> left_out_;
    std::map<std::string, std::string> names_;
    std::size_t bytes_ = 0;
    WorldCopy copy_;
};

}  // namespace

Result<WorldCopy, std::string> copy_of_world(const FilePlace& sdf, const std::vector<std::string>& meshes,
                                             const std::string& written_out) {
    return Copier(sdf, meshes).copy(written_out);
}

}  // namespace octoskin::sim
