#include "host/io/mapfile/octomap_header.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string>

namespace octoskin {
namespace {

constexpr std::size_t kHeaderMax = 4096;
constexpr std::string_view kTextMagic = "# Octomap OcTree file";
constexpr std::string_view kBinaryMagic = "# Octomap OcTree binary file";

/// The value of a whole text as a number; empty if anything is left over.
template <class T>
std::optional<T> parse_number(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// Printable, short, for a message: the file may hold anything.
std::string excerpt(std::string_view text) {
    std::string shown;
    for (const char c : text.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
    return shown;
}

class HeaderParser {
  public:
    HeaderParser(std::string_view bytes, std::uint64_t nodes_max)
        : bytes_(bytes.substr(0, kHeaderMax)), nodes_max_(nodes_max) {}

    Result<OctomapHeader, MapReadError> parse() {
        const auto first_line = next_line();
        if (first_line != kTextMagic && first_line != kBinaryMagic) {
            return fail(MapFault::not_a_map,
                        fmt::format("the first line is not \"{}\" nor \"{}\"", kTextMagic, kBinaryMagic));
        }
        header_.is_binary = first_line == kBinaryMagic;
        while (const auto line = next_line()) {
            if (line->substr(0, 1) == "#") continue;
            if (*line == "data") return finish();
            if (const auto error = take(*line)) return unexpected(*error);
        }
        return fail(MapFault::header_malformed, "no line \"data\" ends the header");
    }

  private:
    static Unexpected<MapReadError> fail(MapFault fault, std::string what) {
        return unexpected(MapReadError{fault, std::move(what)});
    }

    /// The next complete line without its end; empty if there is none.
    std::optional<std::string_view> next_line() {
        const std::size_t end = bytes_.find('\n', position_);
        if (end == std::string_view::npos) return std::nullopt;
        const std::string_view line = bytes_.substr(position_, end - position_);
        position_ = end + 1;
        return line;
    }

    std::optional<MapReadError> take(std::string_view line) {
        const std::size_t space = line.find(' ');
        const std::string_view key = line.substr(0, space);
        const std::string_view value = space == std::string_view::npos ? "" : line.substr(space + 1);
        if (key == "id" && !has_id_) return take_id(value);
        if (key == "size" && !has_size_) return take_size(value);
        if (key == "res" && !has_resolution_) return take_resolution(value);
        return MapReadError{MapFault::header_malformed,
                            fmt::format("header line \"{}\" is unknown or comes twice", excerpt(line))};
    }

    std::optional<MapReadError> take_id(std::string_view value) {
        has_id_ = true;
        if (value == "OcTree") return std::nullopt;
        return MapReadError{MapFault::wrong_tree_type,
                            fmt::format("id is \"{}\", only OcTree can be read", excerpt(value))};
    }

    std::optional<MapReadError> take_size(std::string_view value) {
        has_size_ = true;
        const auto nodes = parse_number<std::uint64_t>(value);
        if (!nodes) {
            return MapReadError{MapFault::header_malformed,
                                fmt::format("size is \"{}\", not a number of nodes", excerpt(value))};
        }
        if (*nodes > nodes_max_) {
            return MapReadError{MapFault::too_many_nodes,
                                fmt::format("{} nodes, the limit is {}", *nodes, nodes_max_)};
        }
        header_.nodes = *nodes;
        return std::nullopt;
    }

    std::optional<MapReadError> take_resolution(std::string_view value) {
        has_resolution_ = true;
        const auto resolution_m = parse_number<double>(value);
        // Written so that a NaN fails it.
        if (!resolution_m || !(*resolution_m >= 1e-6 && *resolution_m <= 1e6)) {
            return MapReadError{MapFault::resolution_not_valid,
                                fmt::format("res is \"{}\", not between 1e-6 and 1e6 m", excerpt(value))};
        }
        header_.resolution_m = *resolution_m;
        return std::nullopt;
    }

    Result<OctomapHeader, MapReadError> finish() {
        if (!has_id_ || !has_size_ || !has_resolution_) {
            return fail(MapFault::header_malformed, "id, size or res is missing before \"data\"");
        }
        header_.data_begin = position_;
        return header_;
    }

    std::string_view bytes_;
    std::uint64_t nodes_max_;
    std::size_t position_ = 0;
    OctomapHeader header_;
    bool has_id_ = false;
    bool has_size_ = false;
    bool has_resolution_ = false;
};

}  // namespace

Result<OctomapHeader, MapReadError> parse_octomap_header(std::string_view bytes, std::uint64_t nodes_max) {
    return HeaderParser(bytes, nodes_max).parse();
}

}  // namespace octoskin
