#include "hw/sim/world/sdf/written_out.hpp"

#include <filesystem>
#include <sdf/Element.hh>
#include <string_view>
#include <vector>

namespace octoskin::sim {
namespace {

/// Makes a mesh's path absolute: it is relative to the file that names it, not to the written file.
void make_absolute(sdf::Element& uri) {
    constexpr std::string_view kFileScheme = "file://";
    std::string text = uri.Get<std::string>();
    if (text.starts_with(kFileScheme)) text.erase(0, kFileScheme.size());
    if (text.find("://") != std::string::npos) return;
    uri.Set(std::filesystem::absolute(std::filesystem::path(uri.FilePath()).parent_path() / text).string());
}

}  // namespace

std::string written_out(sdf::Root& root) {
    bool includes = false;
    std::vector<sdf::ElementPtr> left{root.Element()};
    while (!left.empty()) {
        const sdf::ElementPtr element = left.back();
        left.pop_back();
        includes |= element->GetIncludeElement() != nullptr;
        if (element->GetName() == "mesh" && element->HasElement("uri"))
            make_absolute(*element->GetElement("uri"));
        for (auto child = element->GetFirstElement(); child; child = child->GetNextElement())
            left.push_back(child);
    }
    return includes ? root.Element()->ToString("") : "";
}

}  // namespace octoskin::sim
