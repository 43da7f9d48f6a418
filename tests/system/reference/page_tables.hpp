// Tables of the reference pages, as Markdown.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace octoskin {

/// Name -> table.
using Tables = std::map<std::string, std::string, std::less<>>;

/// The table with a further row; the first row brings the head.
void add_row(Tables& tables, const std::string& name, std::string_view head, const std::string& row);

/// A cell of a table: identifiers and options as code, no bar and no tag.
[[nodiscard]] std::string cell(std::string_view text);

}  // namespace octoskin
