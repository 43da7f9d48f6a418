#include "host/io/mapfile/octomap_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <utility>

namespace octoskin {
namespace {

constexpr std::size_t kHeaderMax = std::size_t{1} << 20U;
constexpr std::size_t kDifferencesMax = 4;  ///< number of differences that a warning lists
constexpr std::string_view kTextMagic = "# Octomap OcTree file";
constexpr std::string_view kBinaryMagic = "# Octomap OcTree binary file";
constexpr std::string_view kOctoskinsComment = "# saved by octoskin";
constexpr std::string_view kOccupiedComment = "# occupied from log-odds ";
constexpr std::string_view kWhiteSpace = " \t\n\v\f\r";

/// A .bt of OctoMap before 1.4, little-endian: type of tree in 32 bits, resolution as a double, number of
/// nodes in 32 bits.
constexpr std::string_view kBefore14Type("\x03\x00\x00\x00", 4);
constexpr std::size_t kBefore14Bytes = 16;

/// Printable and short, for a message: the file may contain any bytes.
std::string excerpt(std::string_view text) {
    std::string shown;
    for (const char c : text.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
    return shown;
}

Unexpected<MapReadError> fail(MapFault fault, std::string what) {
    return unexpected(MapReadError{fault, std::move(what)});
}

/// This form is false for a NaN.
bool is_resolution(double resolution_m) {
    return resolution_m >= 1e-6 && resolution_m <= 1e6;
}

class HeaderParser {
  public:
    HeaderParser(std::string_view bytes, std::uint64_t nodes_max)
        : bytes_(bytes.substr(0, kHeaderMax)), nodes_max_(nodes_max) {}

    Result<OctomapHeader, MapReadError> parse() {
        if (!take_first_line()) {
            return fail(MapFault::not_a_map,
                        fmt::format("the first line is neither \"{}\" nor \"{}\"", kTextMagic, kBinaryMagic));
        }
        for (std::string_view word = next_word(); !word.empty(); word = next_word()) {
            if (word == "data") return finish();
            if (auto error = take(word)) return unexpected(std::move(*error));
        }
        return fail(MapFault::header_malformed, "no line \"data\" ends the header");
    }

  private:
    bool take_first_line() {
        const std::string_view line = rest_of_line();
        header_.is_binary = line.starts_with(kBinaryMagic);
        if (!header_.is_binary && !line.starts_with(kTextMagic)) return false;
        const std::string_view behind =
            line.substr(header_.is_binary ? kBinaryMagic.size() : kTextMagic.size());
        has_carriage_returns_ = behind == "\r";
        if (has_carriage_returns_) {
            differ("its lines end with a carriage return");
        } else if (!behind.empty()) {
            differ(fmt::format("\"{}\" after the first line", excerpt(behind)));
        }
        return true;
    }

    std::optional<MapReadError> take(std::string_view key) {
        if (key.starts_with('#')) {
            return take_comment(key);
        }
        if (key == "id") return take_id(next_value(key, has_id_));
        if (key == "size") return take_size(next_value(key, has_size_));
        if (key == "res") return take_resolution(next_value(key, has_resolution_));
        differ(fmt::format("key \"{}\" is skipped", excerpt(key)));
        rest_of_line();
        return std::nullopt;
    }

    std::optional<MapReadError> take_comment(std::string_view first_word) {
        position_ -= first_word.size();
        std::string_view line = rest_of_line();
        if (line.ends_with('\r')) line.remove_suffix(1);
        header_.is_octoskins = header_.is_octoskins || line == kOctoskinsComment;
        if (!header_.is_octoskins || !line.starts_with(kOccupiedComment)) return std::nullopt;
        const std::string_view number = line.substr(kOccupiedComment.size());
        float from = 0.0F;
        const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), from);
        constexpr float kMost = 100.0F;  // the limit of a mapping file
        if (error != std::errc{} || end != number.data() + number.size() || !(std::fabs(from) <= kMost)) {
            return MapReadError{
                MapFault::header_malformed,
                fmt::format("\"{}\" is not a log-odds threshold for occupied voxels", excerpt(number))};
        }
        header_.occupied_from = from;
        return std::nullopt;
    }

    /// The word after a key. Expected is a line with only the two, separated by one blank.
    std::string_view next_value(std::string_view key, bool& is_known) {
        if (std::exchange(is_known, true)) differ(fmt::format("{} is repeated; the last one counts", key));
        const std::size_t begin = position_ - key.size();
        const std::string_view value = next_word();
        const std::string plain = fmt::format("{} {}{}", key, value, has_carriage_returns_ ? "\r\n" : "\n");
        if (bytes_.substr(begin, plain.size()) != plain)
            differ(fmt::format("the line of {} is not \"{} {}\"", key, key, excerpt(value)));
        return value;
    }

    std::optional<MapReadError> take_id(std::string_view value) {
        // In a .bt the nodes are the same for every type of occupancy tree.
        const bool has_same_nodes = value == "OcTree" || value == "OcTreeStamped";
        const bool has_colours = value == "ColorOcTree";
        header_.colour_bytes = !header_.is_binary && has_colours ? 3 : 0;
        if (value == "1") {
            differ("id is 1, as an early OctoMap wrote it for OcTree");
        } else if (header_.is_binary && !value.empty()) {
            if (!has_same_nodes && !has_colours)
                differ(fmt::format("id is \"{}\", read as OcTree", excerpt(value)));
        } else if (!has_same_nodes && !has_colours) {
            return MapReadError{
                MapFault::wrong_tree_type,
                fmt::format("id is \"{}\", but from an .ot only OcTree, ColorOcTree and OcTreeStamped can be "
                            "read (OctoMap's convert_octree may convert it to a .bt)",
                            excerpt(value))};
        }
        is_octree_ = value == "OcTree";
        return std::nullopt;
    }

    std::optional<MapReadError> take_size(std::string_view value) {
        header_.nodes.reset();
        const bool is_negative = value.starts_with('-');
        std::uint32_t nodes = 0;
        if (!take_number(value.substr(is_negative ? 1 : 0), nodes)) {
            return MapReadError{MapFault::header_malformed,
                                fmt::format("size is \"{}\", not a number of nodes", excerpt(value))};
        }
        if (is_negative) {
            differ(fmt::format("size is \"{}\"", excerpt(value)));
        } else {
            header_.nodes = nodes;
        }
        return std::nullopt;
    }

    std::optional<MapReadError> take_resolution(std::string_view value) {
        double resolution_m = 0.0;
        if (!take_number(value, resolution_m) || !is_resolution(resolution_m)) {
            return MapReadError{MapFault::resolution_not_valid,
                                fmt::format("res is \"{}\", not between 1e-6 and 1e6 m", excerpt(value))};
        }
        header_.resolution_m = resolution_m;
        return std::nullopt;
    }

    /// The number at the beginning of the word; the rest of the word is then the next word.
    template <class T>
    bool take_number(std::string_view word, T& number) {
        const std::string_view digits = word.substr(word.starts_with('+') ? 1 : 0);
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        const auto left_over = static_cast<std::size_t>(digits.data() + digits.size() - end);
        if (left_over > 0 || digits.size() != word.size())
            differ(fmt::format("\"{}\" for a number", excerpt(word)));
        position_ -= left_over;
        return error == std::errc{};
    }

    Result<OctomapHeader, MapReadError> finish() {
        if (const std::string_view behind = rest_of_line(); !behind.empty() && behind != "\r")
            differ(fmt::format("\"{}\" after \"data\"", excerpt(behind)));
        header_.data_begin = position_;
        if (!has_id_ || !has_resolution_)
            return fail(MapFault::header_malformed, "id or res is missing before \"data\"");
        if (!has_size_) differ("size is missing");
        if (header_.is_octoskins && !is_octree_)
            return fail(MapFault::wrong_tree_type, "octoskin saved it, but its id is not OcTree");
        if (header_.is_octoskins && !header_.differences.empty()) {
            return fail(
                MapFault::header_malformed,
                "octoskin saved it, and its header was changed afterwards: " + header_.differences[0]);
        }
        if (header_.is_octoskins && *header_.nodes > nodes_max_) {
            return fail(MapFault::too_many_nodes,
                        fmt::format("{} nodes, the limit is {}", *header_.nodes, nodes_max_));
        }
        return std::move(header_);
    }

    void differ(std::string what) {
        if (header_.differences.size() < kDifferencesMax) header_.differences.push_back(std::move(what));
    }

    /// Empty at the end.
    std::string_view next_word() {
        const std::size_t begin = std::min(bytes_.find_first_not_of(kWhiteSpace, position_), bytes_.size());
        position_ = std::min(bytes_.find_first_of(kWhiteSpace, begin), bytes_.size());
        return bytes_.substr(begin, position_ - begin);
    }

    /// Without its line end, which is skipped.
    std::string_view rest_of_line() {
        const std::size_t begin = position_;
        const std::size_t end = std::min(bytes_.find('\n', begin), bytes_.size());
        position_ = std::min(end + 1, bytes_.size());
        return bytes_.substr(begin, end - begin);
    }

    std::string_view bytes_;
    std::uint64_t nodes_max_;
    std::size_t position_ = 0;
    OctomapHeader header_;
    bool has_carriage_returns_ = false;
    bool has_id_ = false;
    bool has_size_ = false;
    bool has_resolution_ = false;
    bool is_octree_ = false;
};

std::uint64_t little_endian(std::string_view bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i)
        value |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
    return value;
}

Result<OctomapHeader, MapReadError> parse_header_before_1_4(std::string_view bytes) {
    if (bytes.size() < kBefore14Bytes)
        return fail(MapFault::truncated, "the file ends within a header of the format before OctoMap 1.4");
    OctomapHeader header;
    header.is_binary = true;
    header.resolution_m = std::bit_cast<double>(little_endian(bytes.substr(4, 8)));
    header.nodes = little_endian(bytes.substr(12, 4));
    header.data_begin = kBefore14Bytes;
    header.differences = {"it has the format before OctoMap 1.4 (convert_octree converts it)"};
    if (!is_resolution(header.resolution_m)) {
        return fail(MapFault::resolution_not_valid,
                    fmt::format("the resolution is {}, not between 1e-6 and 1e6 m", header.resolution_m));
    }
    return header;
}

}  // namespace

std::string octomap_header(bool is_binary, std::uint64_t nodes, double resolution_m, SavedMark mark,
                           float occupied_from) {
    std::string comments;
    if (mark == SavedMark::present) comments = fmt::format("{}\n", kOctoskinsComment);
    if (mark == SavedMark::present && occupied_from != 0.0F)
        comments += fmt::format("{}{}\n", kOccupiedComment, occupied_from);
    return fmt::format(
        "{}\n# (feel free to add / change comments, but leave the first line as it is!)\n{}#\n"
        "id OcTree\nsize {}\nres {}\ndata\n",
        is_binary ? kBinaryMagic : kTextMagic, comments, nodes, resolution_m);
}

Result<OctomapHeader, MapReadError> parse_octomap_header(std::string_view bytes, std::uint64_t nodes_max) {
    if (bytes.starts_with(kBefore14Type)) return parse_header_before_1_4(bytes);
    return HeaderParser(bytes, nodes_max).parse();
}

}  // namespace octoskin
