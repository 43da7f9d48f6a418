#include "hw/mesh/mesh_text.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>
#include <vector>

namespace octoskin {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

Unexpected<std::string> fault(std::size_t line, const std::string& what) {
    return unexpected("line " + std::to_string(line) + ": " + what);
}

/// The next word of `line`, which is removed from it; empty at its end.
std::string_view next_word(std::string_view& line) {
    line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
    line.remove_prefix(word.size());
    return word;
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

/// A number as all readers take it: a sign, then a digit.
bool is_plain_number(std::string_view word) {
    if (!word.empty() && (word.front() == '-' || word.front() == '+')) word.remove_prefix(1);
    if (word.empty() || word.front() < '0' || word.front() > '9') return false;
    double value = 0.0;
    const auto parsed = std::from_chars(word.data(), word.data() + word.size(), value);
    return parsed.ec == std::errc{} && parsed.ptr == word.data() + word.size();
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

/// The words of an STL text in the order in which they have to come.
class StlGrammar {
  public:
    Status<std::string> take(std::size_t number, std::string_view line) {
        const std::string word = lower(next_word(line));
        if (word.empty()) return Done{};
        if (word == "solid" && state_ == State::outside) {
            state_ = State::solid;
        } else if (word == "facet" && state_ == State::solid) {
            state_ = State::facet;
        } else if (word == "outer" && state_ == State::facet) {
            state_ = State::loop;
            corners_ = 0;
        } else if (word == "vertex" && state_ == State::loop && corners_ < 3) {
            if (count_words(line) != 3) return fault(number, "expected three numbers of a vertex");
            ++corners_;
        } else if (word == "endloop" && state_ == State::loop && corners_ == 3) {
            state_ = State::closed;
        } else if (word == "endfacet" && state_ == State::closed) {
            state_ = State::solid;
            ++triangles_;
        } else if (word == "endsolid" && state_ == State::solid) {
            state_ = State::outside;
        } else {
            return fault(number, "no STL text of triangles goes on with '" + word.substr(0, 20) + "'");
        }
        return Done{};
    }
    [[nodiscard]] bool is_over() const { return state_ == State::outside; }
    [[nodiscard]] std::size_t triangles() const { return triangles_; }

  private:
    enum class State : std::uint8_t { outside, solid, facet, loop, closed };
    State state_ = State::outside;
    int corners_ = 0;
    std::size_t triangles_ = 0;
};

Result<MeshText, std::string> check_stl(std::string_view bytes) {
    if (is_binary_stl(bytes)) {
        std::uint32_t count = 0;
        std::memcpy(&count, bytes.data() + 80, sizeof count);
        return MeshText{count};
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
    return MeshText{grammar.triangles()};
}

Result<MeshText, std::string> check_obj(std::string_view bytes) {
    constexpr std::array<std::size_t, 3> kNumbers{3, 4, 6};
    if (bytes.find('\0') != std::string_view::npos) return unexpected(std::string("has a zero byte"));
    if (bytes.find("\\\n") != std::string_view::npos || bytes.find("\\\r") != std::string_view::npos)
        return unexpected(std::string("has lines that go on with a backslash; export it with whole lines"));
    std::size_t triangles = 0;
    const auto read =
        for_each_line(bytes, [&](std::size_t number, std::string_view line) -> Status<std::string> {
            line = line.substr(0, line.find('#'));
            const std::string_view word = next_word(line);
            if (word == "V" || word == "F") return fault(number, "expected 'v' and 'f' in small letters");
            if (word == "f") {
                const std::size_t corners = count_words(line);
                if (corners < 3) return fault(number, "a face has fewer than three corners");
                triangles += corners - 2;
            }
            if (word != "v") return Done{};
            const std::size_t numbers = count_words(line);
            if (std::ranges::find(kNumbers, numbers) == kNumbers.end())
                return fault(number, "a vertex has " + std::to_string(numbers) + " numbers, expected 3");
            while (!line.empty()) {
                const std::string_view value = next_word(line);
                if (!value.empty() && !is_plain_number(value))
                    return fault(number, "expected a number that begins with a digit");
            }
            return Done{};
        });
    if (!read) return unexpected(read.error());
    return MeshText{triangles};
}

/// Walks through all elements of a COLLADA file.
class ColladaCheck {
  public:
    std::optional<std::string> fault_in(const tinyxml2::XMLElement& root) {
        walk(root, [this](const tinyxml2::XMLElement& element) {
            if (const char* id = element.Attribute("id")) ids_.insert(id);
        });
        walk(root, [this](const tinyxml2::XMLElement& element) {
            if (!fault_) check(element);
        });
        return fault_;
    }

  private:
    /// Without recursion: the depth is the file's.
    template <class Use>
    static void walk(const tinyxml2::XMLElement& root, Use&& use) {
        std::vector<const tinyxml2::XMLElement*> open{&root};
        while (!open.empty()) {
            const tinyxml2::XMLElement& element = *open.back();
            open.pop_back();
            use(element);
            for (const auto* child = element.FirstChildElement(); child != nullptr;
                 child = child->NextSiblingElement())
                open.push_back(child);
        }
    }

    void fail(const tinyxml2::XMLElement& element, const std::string& what) {
        fault_ = "line " + std::to_string(element.GetLineNum()) + ": " + what;
    }

    static std::vector<double> numbers_of(const tinyxml2::XMLElement& element) {
        std::string_view text = element.GetText() == nullptr ? "" : element.GetText();
        std::vector<double> numbers;
        for (;;) {
            text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
            if (text.empty()) return numbers;
            double value = std::nan("");
            const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
            numbers.push_back(value);
            text.remove_prefix(std::max<std::size_t>(1, static_cast<std::size_t>(parsed.ptr - text.data())));
        }
    }

    void check(const tinyxml2::XMLElement& element) {
        const std::string_view name = element.Name();
        const bool is_instance =
            name == "instance_node" || name == "instance_geometry" || name == "instance_controller";
        if (is_instance) {
            const std::string_view url = element.Attribute("url") == nullptr ? "" : element.Attribute("url");
            if (!url.starts_with('#') || !ids_.contains(std::string(url.substr(1))))
                fail(element, "an instance of what is not in this file: part of the shape would be missing");
        } else if (name == "unit") {
            double meter = 1.0;
            const auto read = element.QueryDoubleAttribute("meter", &meter);
            const bool is_number = read == tinyxml2::XML_SUCCESS || read == tinyxml2::XML_NO_ATTRIBUTE;
            if (!is_number || !(meter > 0.0) || !std::isfinite(meter))
                fail(element, "expected a <unit> with a positive number of metres");
        } else if (name == "matrix") {
            const auto numbers = numbers_of(element);
            const bool is_affine = numbers.size() == 16 && numbers[12] == 0.0 && numbers[13] == 0.0 &&
                                   numbers[14] == 0.0 && numbers[15] == 1.0;
            if (!is_affine) fail(element, "expected a <matrix> of 16 numbers that ends with 0 0 0 1");
        } else if (name == "p" || name == "vcount") {
            const char* const text = element.GetText();
            if (text != nullptr && std::strchr(text, '-') != nullptr) fail(element, "a negative index");
        }
    }

    std::set<std::string, std::less<>> ids_;
    std::optional<std::string> fault_;
};

Result<MeshText, std::string> check_collada(std::string_view bytes) {
    tinyxml2::XMLDocument document;
    if (document.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS)
        return unexpected("is no XML: " + std::string(document.ErrorStr()));
    const auto* const root = document.RootElement();
    if (root == nullptr) return unexpected(std::string("has no element"));
    if (auto fault = ColladaCheck().fault_in(*root)) return unexpected(*std::move(fault));
    return MeshText{};
}

}  // namespace

Result<MeshText, std::string> check_mesh_text(std::string_view ending, std::string_view bytes) {
    const std::string kind = lower(ending);
    if (kind == ".stl") return check_stl(bytes);
    if (kind == ".obj") return check_obj(bytes);
    return check_collada(bytes);
}

}  // namespace octoskin
