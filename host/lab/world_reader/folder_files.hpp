// Opens files beneath the descriptor of a folder, for libraries that need a path.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/open_folder.hpp"
#include "hw/mesh/allowed_files.hpp"

namespace octoskin::sim {

class FolderFiles final : public AllowedFiles {
  public:
    [[nodiscard]] static Result<std::unique_ptr<FolderFiles>, Error> open(
        const std::filesystem::path& folder);

    /// `file`: relative to the folder. Opened files stay open.
    [[nodiscard]] Result<std::filesystem::path, std::string> openable(
        const std::filesystem::path& file) const override;

  private:
    explicit FolderFiles(OpenFolder folder) : folder_(std::move(folder)) {}

    OpenFolder folder_;
    mutable std::map<std::filesystem::path, OpenFile> opened_;
};

}  // namespace octoskin::sim
