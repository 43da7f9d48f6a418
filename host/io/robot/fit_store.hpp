// Fitted robots that earlier runs of this user kept.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/errors/error.hpp"

namespace octoskin {

/// A folder with a file for each fit, named by its key (FitIngredients::key). What others could have written
/// is not used: folder and files belong to this user, and only this user may write them; a file has one name
/// and contains its own digest.
class FitStore {
  public:
    /// $XDG_CACHE_HOME/octoskin/robots, or ~/.cache/octoskin/robots; nowhere without either.
    [[nodiscard]] static FitStore of_this_user();
    /// `folder`: empty for nowhere, where nothing is found or kept.
    explicit FitStore(std::filesystem::path folder);

    [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }

    /// The fitted URDF of this key; nullopt if there is none. Errors: foreign_owner (or others may write),
    /// link, wrong_kind_of_file, damaged, those of the system.
    [[nodiscard]] Result<std::optional<std::string>, Error> find(const std::string& key) const;

    /// Makes the folder if it does not exist, and replaces an older file of that key. Errors: not_found
    /// (nowhere), likewise.
    [[nodiscard]] Status<Error> keep(const std::string& key, const std::string& urdf) const;

  private:
    std::filesystem::path folder_;
};

}  // namespace octoskin
