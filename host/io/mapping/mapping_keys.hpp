// The one table of the keys of a mapping file. The parser, the canonical writer, `octoskin mapping --keys`
// and the table of docs/mapping.md walk it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "host/core/mapping/mapping_config.hpp"

namespace octoskin {

/// Where the value of a key is in a configuration; its alternative is the type of the key.
using MappingValue = std::variant<double*, float*, std::uint32_t*, bool*, DepthUpdate*, RangeUpdate*>;

struct MappingKey {
    std::string_view path;  ///< "map.resolution_m"; at the top of the file without a dot
    std::string_view unit;  ///< empty: none
    struct {
        double min = 0.0;
        double max = 0.0;
    } range;  ///< of a number, both ends allowed
    MappingValue (*value)(MappingConfig& config);
    std::string_view meaning;  ///< Markdown; its links start from docs/
};

/// All keys in the order of the canonical text; the keys of one table are neighbours. `base`, the
/// configuration that a file starts from, has no value of its own and is not among them.
[[nodiscard]] std::span<const MappingKey> mapping_keys() noexcept;

/// "map" of "map.resolution_m"; empty for a key at the top.
[[nodiscard]] std::string_view table_of(const MappingKey& key) noexcept;
/// "resolution_m" of "map.resolution_m".
[[nodiscard]] std::string_view name_in_table(const MappingKey& key) noexcept;

/// The values that the parser accepts: "a number from 0.001 to 10", "true or false", "ray or cone".
[[nodiscard]] std::string expected_text(const MappingKey& key);
/// The value in a configuration, as the canonical text has it.
[[nodiscard]] std::string value_text(const MappingKey& key, const MappingConfig& config);

/// The words of a key that takes one of a few.
[[nodiscard]] std::span<const std::pair<std::string_view, DepthUpdate>> depth_update_words() noexcept;
[[nodiscard]] std::span<const std::pair<std::string_view, RangeUpdate>> range_update_words() noexcept;

}  // namespace octoskin
