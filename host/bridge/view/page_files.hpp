// The files of the view's page, read once.
#pragma once

#include <filesystem>

#include "host/bridge/view/web_server.hpp"

namespace octoskin::view {

/// Where the page is: share/octoskin/view beside the folder of the running program, also if that is in
/// libexec.
[[nodiscard]] std::filesystem::path page_folder();
/// The files of a fixed list that are in the folder, with their types; index.html is "/". Without it there
/// are none. A file over 16 MiB or one that cannot be read is left out.
[[nodiscard]] WebFiles read_page(const std::filesystem::path& folder);

}  // namespace octoskin::view
