#include "host/bridge/view/page_files.hpp"

#include <array>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

namespace octoskin::view {
namespace {

struct PageFile {
    const char* path;  ///< in a URL
    const char* name;
    const char* type;
};
constexpr std::array kFiles = {
    PageFile{"/", "index.html", "text/html; charset=utf-8"},
    PageFile{"/page.js", "page.js", "text/javascript; charset=utf-8"},
    PageFile{"/worker.js", "worker.js", "text/javascript; charset=utf-8"},
    PageFile{"/page.css", "page.css", "text/css; charset=utf-8"},
    PageFile{"/licences.txt", "licences.txt", "text/plain; charset=utf-8"},
};
constexpr std::uintmax_t kBytesMax = std::uintmax_t{16} << 20U;

std::optional<std::string> content_of(const std::filesystem::path& file) {
    std::error_code error;
    const auto size = std::filesystem::file_size(file, error);
    if (error || size > kBytesMax) return std::nullopt;
    std::ifstream stream(file, std::ios::binary);
    std::string content((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    return stream.bad() || content.size() != size ? std::nullopt : std::optional(std::move(content));
}

}  // namespace

std::filesystem::path page_folder() {
    std::error_code error;
    const auto here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    const auto above = here.parent_path();
    const auto root = above.filename() == "libexec" ? above.parent_path() : above;
    return root / "share" / "octoskin" / "view";
}

WebFiles read_page(const std::filesystem::path& folder) {
    WebFiles files;
    for (const PageFile& file : kFiles)
        if (auto content = content_of(folder / file.name))
            files.emplace(file.path, WebFile{file.type, std::move(*content)});
    return files.contains("/") ? files : WebFiles{};
}

}  // namespace octoskin::view
