// Fitted robots that earlier runs of this user kept.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// The folder octoskin/robots of a cache, with a file for each fit, named by its key (FitIngredients::key).
/// What others could have written is not used: both folders and the files belong to this user, who alone may
/// write them; none is a link; a file has one name and contains a digest of itself and its key.
class FitStore {
  public:
    /// In $XDG_CACHE_HOME, or in ~/.cache; nowhere without either.
    [[nodiscard]] static FitStore of_this_user();
    /// `cache`: links in this path are followed; empty for nowhere, where nothing is found or kept.
    explicit FitStore(std::filesystem::path cache);

    [[nodiscard]] std::filesystem::path folder() const;

    /// The fitted URDF of this key; nullopt if there is none. Errors: foreign_owner (or others may write),
    /// link, wrong_kind_of_file, damaged, those of the system.
    [[nodiscard]] Result<std::optional<std::string>, Error> find(const std::string& key) const;

    /// Makes the folders if they do not exist, for this user alone, and replaces an older file of that key.
    /// Errors: not_found (nowhere), likewise.
    [[nodiscard]] Status<Error> keep(const std::string& key, const std::string& urdf) const;

  private:
    [[nodiscard]] Result<OpenFolder, Error> make_folder() const;

    std::filesystem::path cache_;
};

}  // namespace octoskin
