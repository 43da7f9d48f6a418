#include "hw/mesh/mesh_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "hw/mesh/collada_text.hpp"
#include "hw/mesh/text_words.hpp"

namespace octoskin {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

Unexpected<std::string> fault(std::size_t line, const std::string& what) {
    return unexpected("line " + std::to_string(line) + ": " + what);
}

std::string_view next_word(std::string_view& line) {
    return take_word(line, kBlanks);
}

std::size_t count_words(std::string_view line) {
    std::size_t count = 0;
    while (!next_word(line).empty()) ++count;
    return count;
}

std::string lower(std::string_view text) {
    std::string out(text);
    std::ranges::transform(out, out.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return out;
}

/// Calls `use(number, line)` for each line, until it returns an error.
template <class Use>
Status<std::string> for_each_line(std::string_view bytes, Use&& use) {
    for (std::size_t number = 1; !bytes.empty(); ++number) {
        const std::string_view line = bytes.substr(0, bytes.find('\n'));
        bytes.remove_prefix(std::min(line.size() + 1, bytes.size()));
        if (auto used = use(number, line); !used) return used;
    }
    return Done{};
}

bool is_binary_stl(std::string_view bytes) {
    constexpr std::size_t kHead = 84, kTriangle = 50;
    if (bytes.size() < kHead) return false;
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, sizeof count);
    return bytes.size() == kHead + kTriangle * std::size_t{count};
}

bool are_plain_numbers(std::string_view line, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        if (!plain_number(next_word(line))) return false;
    return next_word(line).empty();
}

/// "normal" and three numbers. Their values have no use, and some programs write "nan"; but assimp goes on
/// behind what it takes as a number, and finds a corner in "0vertex".
bool is_normal(std::string_view line) {
    constexpr std::array<std::string_view, 4> kNoNumber{"nan", "inf", "nan(ind)", "infinity"};
    if (lower(next_word(line)) != "normal") return false;
    for (int i = 0; i < 3; ++i) {
        const std::string word = lower(next_word(line));
        const std::string_view unsigned_word =
            std::string_view(word).substr(word.starts_with('-') || word.starts_with('+') ? 1 : 0);
        if (!plain_number(word) && std::ranges::find(kNoNumber, unsigned_word) == kNoNumber.end())
            return false;
    }
    return next_word(line).empty();
}

/// assimp takes the first word as the name, and finds corners and ends among the further words.
bool is_solid_name(std::string_view line) {
    (void)next_word(line);
    for (;;) {
        const std::string_view word = next_word(line);
        if (word.empty()) return true;
        if (word == "facet" || word == "vertex" || word.starts_with("endsolid")) return false;
    }
}

/// The words of an STL text in the order in which they have to come.
class StlGrammar {
  public:
    Status<std::string> take(std::size_t number, std::string_view line) {
        const std::string word = lower(next_word(line));
        if (word.empty()) return Done{};
        if (!enter(word))
            return fault(number, "no STL text of triangles goes on with '" + word.substr(0, 20) + "'");
        if (!is_complete(word, line))
            return fault(number,
                         "no reader takes all that is behind '" + word +
                             "': expected plain numbers of at most 15 digits before the point, and no "
                             "further words; export it as binary STL");
        return Done{};
    }
    [[nodiscard]] bool is_over() const { return state_ == State::outside; }
    [[nodiscard]] std::size_t triangles() const { return triangles_; }

  private:
    enum class State : std::uint8_t { outside, solid, facet, loop, closed };

    /// False: the keyword has no place here.
    bool enter(std::string_view word) {
        if (word == "solid" && state_ == State::outside) {
            state_ = State::solid;
        } else if (word == "facet" && state_ == State::solid) {
            state_ = State::facet;
        } else if (word == "outer" && state_ == State::facet) {
            state_ = State::loop;
            corners_ = 0;
        } else if (word == "vertex" && state_ == State::loop && corners_ < 3) {
            ++corners_;
        } else if (word == "endloop" && state_ == State::loop && corners_ == 3) {
            state_ = State::closed;
        } else if (word == "endfacet" && state_ == State::closed) {
            state_ = State::solid;
            ++triangles_;
        } else if (word == "endsolid" && state_ == State::solid) {
            state_ = State::outside;
        } else {
            return false;
        }
        return true;
    }

    /// `line`: what is behind the keyword.
    static bool is_complete(std::string_view word, std::string_view line) {
        if (word == "solid") return is_solid_name(line);
        if (word == "facet") return is_normal(line);
        if (word == "outer") return lower(next_word(line)) == "loop" && next_word(line).empty();
        if (word == "vertex") return are_plain_numbers(line, 3);
        return word == "endsolid" || next_word(line).empty();
    }

    State state_ = State::outside;
    int corners_ = 0;
    std::size_t triangles_ = 0;
};

Result<MeshText, std::string> check_stl(std::string_view bytes) {
    if (is_binary_stl(bytes)) {
        std::uint32_t count = 0;
        std::memcpy(&count, bytes.data() + 80, sizeof count);
        return MeshText{count, {}};
    }
    const std::string_view begin = bytes.substr(0, 200);
    const bool is_text = lower(begin.substr(0, 5)) == "solid" && begin.find('\0') == std::string_view::npos;
    if (!is_text)
        return unexpected(std::string("is neither an STL text nor as long as its number of triangles says"));
    if (bytes.find('\0') != std::string_view::npos)
        return unexpected(std::string("is an STL text with a zero byte"));
    StlGrammar grammar;
    const auto read = for_each_line(
        bytes, [&](std::size_t number, std::string_view line) { return grammar.take(number, line); });
    if (!read) return unexpected(read.error());
    if (!grammar.is_over()) return unexpected(std::string("is cut off: an STL text ends with 'endsolid'"));
    return MeshText{grammar.triangles(), {}};
}

/// Readers without curved surfaces leave these out.
bool is_curved(std::string_view word) {
    constexpr std::array<std::string_view, 7> kCurved{"cstype", "curv", "curv2", "surf",
                                                      "parm",   "trim", "hole"};
    return std::ranges::find(kCurved, word) != kCurved.end();
}

/// assimp counts the words behind a vertex that begin like a number, also in a comment.
bool is_counted(std::string_view word) {
    if (word.empty()) return false;
    const std::string begin = lower(word.substr(0, 3));
    return is_digit(word.front()) || word.front() == '-' || word.front() == '+' || begin == "nan" ||
           begin == "inf";
}

bool begins_with_digit(std::string_view word) {
    if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
    return !word.empty() && is_digit(word.front());
}

bool has_counted_word(std::string_view comment) {
    for (;;) {
        const std::string_view word = next_word(comment);
        if (word.empty()) return false;
        if (is_counted(word)) return true;
    }
}

/// Each vertex has a number by its order: with one left out, all faces behind it are wrong.
class ObjLines {
  public:
    Status<std::string> take(std::size_t number, std::string_view line) {
        const std::string_view comment = line.substr(std::min(line.find('#'), line.size()));
        const bool is_indented = !line.empty() && kBlanks.find(line.front()) != std::string_view::npos;
        line.remove_suffix(comment.size());
        const std::string_view word = next_word(line);
        if (word == "V" || word == "F") return fault(number, "expected 'v' and 'f' in small letters");
        if (is_curved(word))
            return fault(number, "a curved surface ('" + std::string(word) + "'); export it as triangles");
        if (word != "v" && word != "f") return Done{};
        if (is_indented) return fault(number, "blanks before '" + std::string(word) + "'; remove them");
        if (word == "f" ? !comment.empty() : has_counted_word(comment))
            return fault(number,
                         "a reader takes the comment as numbers; remove the comment behind the numbers");
        return word == "f" ? take_face(number, line) : take_vertex(number, line);
    }
    /// The error is a corner that no vertex is.
    Result<MeshText, std::string> text() const {
        Eigen::AlignedBox3d box;
        for (const auto& [vertex, line] : corners_) {
            if (vertex < 0 || vertex >= static_cast<std::int64_t>(vertices_.size()))
                return fault(line, "a face has a corner that is no vertex of this file; export it anew");
            box.extend(vertices_[static_cast<std::size_t>(vertex)]);
        }
        return MeshText{triangles_, box};
    }

  private:
    struct Corner {
        std::int64_t vertex;
        std::size_t line;
    };

    Status<std::string> take_face(std::size_t number, std::string_view line) {
        const std::size_t count = count_words(line);
        if (count < 3) return fault(number, "a face has fewer than three corners");
        triangles_ += count - 2;
        for (std::size_t i = 0; i < count; ++i) {
            const std::string_view corner = next_word(line);
            const std::string_view index = corner.substr(0, corner.find('/'));
            std::int64_t vertex = 0;
            const auto parsed = std::from_chars(index.data(), index.data() + index.size(), vertex);
            if (parsed.ec != std::errc{} || parsed.ptr != index.data() + index.size() || vertex == 0)
                return fault(number, "expected the number of a vertex as a corner of a face");
            corners_.push_back(
                {vertex > 0 ? vertex - 1 : static_cast<std::int64_t>(vertices_.size()) + vertex, number});
        }
        return Done{};
    }

    Status<std::string> take_vertex(std::size_t number, std::string_view line) {
        constexpr std::array<std::size_t, 3> kNumbers{3, 4, 6};
        const std::size_t count = count_words(line);
        if (std::ranges::find(kNumbers, count) == kNumbers.end())
            return fault(number, "a vertex has " + std::to_string(count) + " numbers, expected 3");
        std::array<double, 6> values{};
        for (std::size_t i = 0; i < count; ++i) {
            const std::string_view word = next_word(line);
            const auto value = begins_with_digit(word) ? plain_number(word) : std::nullopt;
            if (!value)
                return fault(number,
                             "expected a number that begins with a digit and has at most 15 digits before "
                             "the point");
            values[i] = *value;
        }
        const double weight = count == 4 ? values[3] : 1.0;
        vertices_.push_back(Eigen::Vector3d(values[0], values[1], values[2]) / weight);
        return Done{};
    }

    std::vector<Eigen::Vector3d> vertices_;
    std::vector<Corner> corners_;
    std::size_t triangles_ = 0;
};

/// A line ends with "\n" or "\r\n"; assimp ends one at these characters, too.
bool has_unusual_line_ends(std::string_view bytes) {
    for (auto at = bytes.find_first_of("\r\v\f"); at != std::string_view::npos;
         at = bytes.find_first_of("\r\v\f", at + 1))
        if (bytes.substr(at, 2) != "\r\n") return true;
    return false;
}

/// The fault of the bytes as a whole.
std::optional<std::string> obj_fault(std::string_view bytes) {
    if (bytes.find('\0') != std::string_view::npos) return "has a zero byte";
    if (bytes.starts_with("\xEF\xBB\xBF"))
        return "begins with a byte order mark, and its first line would be left out; save it as UTF-8 "
               "without one";
    if (bytes.find("\\\n") != std::string_view::npos || bytes.find("\\\r") != std::string_view::npos)
        return "has lines that go on with a backslash; export it with whole lines";
    if (has_unusual_line_ends(bytes))
        return "has a line that ends with neither a line feed nor both carriage return and line feed; save "
               "it "
               "with one of them";
    return std::nullopt;
}

Result<MeshText, std::string> check_obj(std::string_view bytes) {
    if (auto whole = obj_fault(bytes)) return unexpected(*std::move(whole));
    ObjLines lines;
    const auto read = for_each_line(
        bytes, [&](std::size_t number, std::string_view line) { return lines.take(number, line); });
    if (!read) return unexpected(read.error());
    return lines.text();
}

}  // namespace

Result<MeshText, std::string> check_mesh_text(std::string_view ending, std::string_view bytes) {
    const std::string kind = lower(ending);
    if (kind == ".stl") return check_stl(bytes);
    if (kind == ".obj") return check_obj(bytes);
    const auto triangles = check_collada_text(bytes);
    if (!triangles) return unexpected(triangles.error());
    return MeshText{*triangles, {}};
}

}  // namespace octoskin
