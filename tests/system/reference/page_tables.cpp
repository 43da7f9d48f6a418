#include "tests/system/reference/page_tables.hpp"

#include <fmt/format.h>

#include <regex>

namespace octoskin {

void add_row(Tables& tables, const std::string& name, std::string_view head, const std::string& row) {
    auto [table, is_new] = tables.try_emplace(name);
    if (is_new) table->second = fmt::format("{}\n", head);
    table->second += row + '\n';
}

std::string cell(std::string_view text) {
    static const std::regex code(
        R"((^|[\s(;:])(--[a-z][a-z-]*|[a-z][a-z0-9]*(?:[._][a-z0-9]+)+|null)(?=$|[\s,;:.)]))");
    std::string safe;
    for (const char character : text) {
        if (character == '|' || character == '<') safe += '\\';
        safe += character;
    }
    return std::regex_replace(safe, code, "$1`$2`");
}

}  // namespace octoskin
