#include "hw/mesh/collada_text.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

#include "hw/mesh/text_words.hpp"

namespace octoskin {
namespace {

using tinyxml2::XMLElement;

constexpr std::string_view kXmlBlanks = " \t\r\n";
constexpr std::array<std::string_view, 4> kSurfaces{"triangles", "polylist", "polygons", "tristrips"};
constexpr std::array<std::string_view, 3> kInstances{"instance_geometry", "instance_controller",
                                                     "instance_node"};
constexpr std::array<std::string_view, 4> kTransforms{"matrix", "translate", "rotate", "scale"};

bool is_one_of(std::string_view word, const auto& words) {
    return std::ranges::find(words, word) != words.end();
}

std::string_view attribute(const XMLElement& element, const char* name) {
    const char* const value = element.Attribute(name);
    return value == nullptr ? std::string_view() : std::string_view(value);
}

std::string_view name_of_parent(const XMLElement& element) {
    const auto* const parent = element.Parent();
    const auto* const parent_element = parent == nullptr ? nullptr : parent->ToElement();
    return parent_element == nullptr ? std::string_view() : std::string_view(parent_element->Name());
}

std::string quoted(std::string_view word) {
    constexpr std::size_t kLength = 40;
    std::string out(1, '\'');
    out.append(word.substr(0, kLength));
    out.push_back('\'');
    return out;
}

/// In brackets; by `append`, since GCC 12 warns falsely of a sum that begins with a text of one character.
std::string tag(std::string_view name) {
    std::string out(1, '<');
    out.append(name);
    out.push_back('>');
    return out;
}

template <class Use>
void for_each_child(const XMLElement& element, const char* name, Use&& use) {
    for (const auto* child = element.FirstChildElement(name); child != nullptr;
         child = child->NextSiblingElement(name))
        use(*child);
}

/// A whole number that fits in 32 bits with its sign.
std::optional<std::size_t> index_of(std::string_view word) {
    constexpr std::size_t kDigits = 9;
    if (word.empty() || word.size() > kDigits || !std::ranges::all_of(word, is_digit)) return std::nullopt;
    std::size_t value = 0;
    for (const char digit : word) value = 10 * value + static_cast<std::size_t>(digit - '0');
    return value;
}

/// Missing: `otherwise`.
std::optional<std::size_t> index_attribute(const XMLElement& element, const char* name,
                                           std::size_t otherwise) {
    return element.Attribute(name) == nullptr ? otherwise : index_of(attribute(element, name));
}

/// Elements by their kind and id.
class Names {
  public:
    void add(const XMLElement& element) {
        if (const auto id = attribute(element, "id"); !id.empty())
            elements_[key(element.Name(), id)].push_back(&element);
    }

    [[nodiscard]] const std::vector<const XMLElement*>& all(std::string_view kind,
                                                            std::string_view id) const {
        static const std::vector<const XMLElement*> kNone;
        const auto found = elements_.find(key(kind, id));
        return found == elements_.end() ? kNone : found->second;
    }

    /// Null: none or several.
    [[nodiscard]] const XMLElement* only(std::string_view kind, std::string_view url) const {
        if (!url.starts_with('#')) return nullptr;
        const auto& found = all(kind, url.substr(1));
        return found.size() == 1 ? found.front() : nullptr;
    }

  private:
    static std::string key(std::string_view kind, std::string_view id) {
        return std::string(kind) + '#' + std::string(id);
    }

    std::map<std::string, std::vector<const XMLElement*>, std::less<>> elements_;
};

/// Walks through all elements of a COLLADA file, and then along the instances of its scene.
class ColladaCheck {
  public:
    explicit ColladaCheck(const XMLElement& root) : root_(root) {}

    Result<std::size_t, std::string> triangles() {
        walk([this](const XMLElement& element) {
            names_.add(element);
            if (is_one_of(element.Name(), kInstances)) mark_parents(element);
        });
        walk([this](const XMLElement& element) {
            if (!fault_) check(element);
        });
        const std::size_t count = fault_ ? 0 : triangles_of_scene();
        if (fault_) return unexpected(*fault_);
        return count;
    }

  private:
    using Check = void (ColladaCheck::*)(const XMLElement&);

    /// Without recursion: the depth is the file's.
    template <class Use>
    void walk(Use&& use) const {
        std::vector<const XMLElement*> open{&root_};
        while (!open.empty()) {
            const XMLElement& element = *open.back();
            open.pop_back();
            use(element);
            const auto first = static_cast<std::ptrdiff_t>(open.size());
            for_each_child(element, nullptr, [&open](const XMLElement& child) {
                if (std::string_view(child.Name()) != "extra") open.push_back(&child);
            });
            std::reverse(open.begin() + first, open.end());
        }
    }

    /// The transforms of lights and cameras do not matter.
    void mark_parents(const XMLElement& instance) {
        for (const auto* parent = instance.Parent(); parent != nullptr; parent = parent->Parent())
            if (!parents_.insert(parent).second) return;
    }

    void fail(const XMLElement& element, const std::string& what) {
        if (!fault_) fault_ = "line " + std::to_string(element.GetLineNum()) + ": " + what;
    }

    void check(const XMLElement& element) {
        static const std::map<std::string_view, Check> kChecks{
            {"instance_geometry", &ColladaCheck::check_instance_geometry},
            {"instance_controller", &ColladaCheck::check_instance_controller},
            {"instance_node", &ColladaCheck::check_instance_node},
            {"instance_visual_scene", &ColladaCheck::check_instance_scene},
            {"unit", &ColladaCheck::check_unit},
        };
        const std::string_view name = element.Name();
        if (name.find(':') != std::string_view::npos)
            return fail(element, "the name <" + std::string(name) +
                                     "> has a prefix, and readers leave it out; export it without prefixes");
        if (const auto found = kChecks.find(name); found != kChecks.end())
            return (this->*found->second)(element);
        if (parents_.contains(element.Parent())) check_transform(element);
    }

    // --- References.

    void fail_instance(const XMLElement& element) {
        fail(element,
             "an instance of what is not in this file, or of what several elements are: part of "
             "the shape would be missing; export one file in which each id is unique");
    }

    void check_instance_geometry(const XMLElement& element) {
        const auto* const geometry = names_.only("geometry", attribute(element, "url"));
        if (geometry == nullptr) return fail_instance(element);
        instances_[geometry].push_back(&element);
    }

    void check_instance_controller(const XMLElement& element) {
        const auto url = attribute(element, "url");
        const bool is_clear =
            names_.only("controller", url) != nullptr && names_.all("geometry", url.substr(1)).empty();
        if (!is_clear) fail_instance(element);
    }

    /// assimp keeps the nodes of the libraries and the scenes in one table, and looks there first.
    void check_instance_node(const XMLElement& element) {
        const auto url = attribute(element, "url");
        const auto* const node = names_.only("node", url);
        const bool is_clear = node != nullptr && name_of_parent(*node) == "library_nodes" &&
                              names_.all("visual_scene", url.substr(1)).empty();
        if (!is_clear) fail_instance(element);
    }

    void check_instance_scene(const XMLElement& element) {
        const auto url = attribute(element, "url");
        if (names_.only("visual_scene", url) == nullptr) return fail_instance(element);
        for (const auto* const node : names_.all("node", url.substr(1)))
            if (name_of_parent(*node) == "library_nodes") fail_instance(element);
    }

    // --- Numbers.

    /// assimp takes an element's text up to the first comment or element.
    std::string_view text_of(const XMLElement& element) {
        const auto* const child = element.FirstChild();
        if (child == nullptr) return {};
        if (child->ToText() == nullptr || child->NextSibling() != nullptr) {
            fail(element, "a comment or an element among the numbers of <" + std::string(element.Name()) +
                              ">: a reader would leave out what is behind it; remove it");
            return {};
        }
        return child->Value();
    }

    /// The words of an element's text, converted; a word for which `convert` gives nothing is a fault.
    template <class Convert>
    auto words_of(const XMLElement& element, const Convert& convert, const std::string& complaint) {
        std::string_view text = text_of(element);
        std::vector<typename std::invoke_result_t<Convert, std::string_view>::value_type> values;
        while (!fault_) {
            const std::string_view word = take_word(text, kXmlBlanks);
            if (word.empty()) break;
            if (const auto value = convert(word)) {
                values.push_back(*value);
            } else {
                fail(element, quoted(word) + complaint);
            }
        }
        return values;
    }

    std::vector<double> numbers_of(const XMLElement& element) {
        return words_of(element, plain_number,
                        " is no plain number of at most 15 digits before the point; export it with plain "
                        "numbers, separated by blanks");
    }

    std::vector<std::size_t> indices_of(const XMLElement& element) {
        return words_of(element, index_of,
                        " is no index: expected whole numbers, separated by blanks; export it anew");
    }

    // --- Transforms.

    void check_unit(const XMLElement& element) {
        if (element.Attribute("meter") == nullptr) return;
        const auto meter = plain_number(attribute(element, "meter"));
        if (!meter || !(*meter > 0.0)) fail(element, "expected a <unit> with a positive number of metres");
    }

    void check_transform(const XMLElement& element) {
        constexpr std::array<std::size_t, kTransforms.size()> kNumbers{16, 3, 4, 3};
        const std::string_view name = element.Name();
        if (name == "skew" || name == "lookat")
            return fail(element, "readers do not agree on <" + std::string(name) +
                                     ">; export the transform as <matrix>");
        const auto* const kind = std::ranges::find(kTransforms, name);
        if (kind == kTransforms.end()) return;
        const auto numbers = numbers_of(element);
        const std::size_t expected = kNumbers[static_cast<std::size_t>(kind - kTransforms.begin())];
        if (numbers.size() != expected)
            return fail(element, "expected " + std::to_string(expected) + " numbers in <" +
                                     std::string(name) + ">, found " + std::to_string(numbers.size()));
        if (name == "matrix") check_matrix(element, numbers);
        if (name == "rotate") check_rotate(element, numbers);
    }

    void check_matrix(const XMLElement& element, const std::vector<double>& numbers) {
        const bool is_affine =
            numbers[12] == 0.0 && numbers[13] == 0.0 && numbers[14] == 0.0 && numbers[15] == 1.0;
        if (!is_affine) fail(element, "expected a <matrix> of 16 numbers that ends with 0 0 0 1");
    }

    /// assimp takes the axis as it is: a point is displaced by up to four times what the length differs by.
    void check_rotate(const XMLElement& element, const std::vector<double>& numbers) {
        constexpr double kLength = 1e-4;
        const double length = std::hypot(numbers[0], numbers[1], numbers[2]);
        if (numbers[3] != 0.0 && std::abs(length - 1.0) > kLength)
            fail(element,
                 "the axis of <rotate> has not the length 1, and readers would deform the part; "
                 "export the transform as <matrix>");
    }

    /// assimp does not apply it.
    void check_shape_matrix(const XMLElement& element) {
        const auto numbers = numbers_of(element);
        for (std::size_t i = 0; i < numbers.size(); ++i)
            if (numbers[i] != (i % 5 == 0 ? 1.0 : 0.0))
                return fail(
                    element,
                    "a <bind_shape_matrix> that readers do not apply; export the mesh without a skin");
    }

    // --- Surfaces.

    /// Only of a geometry in the scene: others, such as those of physics, have no part in the shape.
    std::size_t triangles_of_geometry(const XMLElement& geometry) {
        if (const auto known = triangles_.find(&geometry); known != triangles_.end()) return known->second;
        for (const char* const kind : {"convex_mesh", "brep"})
            if (const auto* const other = geometry.FirstChildElement(kind))
                fail(*other, tag(kind) + " is left out by readers; export it as triangles");
        std::size_t count = 0;
        for_each_child(geometry, "mesh", [&](const XMLElement& mesh) { count += triangles_of_mesh(mesh); });
        triangles_[&geometry] = count;
        return count;
    }

    std::size_t triangles_of_mesh(const XMLElement& mesh) {
        std::size_t count = 0;
        bool has_surface = false;
        last_vertex_ = 0;
        for_each_child(mesh, nullptr, [&](const XMLElement& child) {
            const std::string_view name = child.Name();
            if (name == "trifans")
                fail(child, "<trifans> is taken as one polygon by readers; export it as triangles");
            if (fault_ || !is_one_of(name, kSurfaces)) return;
            const std::size_t triangles = triangles_of_surface(child);
            has_surface = has_surface || triangles > 0;
            count += triangles;
        });
        if (has_surface && !fault_) check_corners(mesh);
        return count;
    }

    /// The indices of one corner, and which of them is the corner's own.
    struct Layout {
        std::size_t stride = 1;
        std::size_t vertex = 0;
    };

    Layout layout_of(const XMLElement& surface) {
        Layout layout;
        for_each_child(surface, "input", [&](const XMLElement& input) {
            const auto offset = index_attribute(input, "offset", 0);
            const auto semantic = attribute(input, "semantic");
            if (!offset) fail(input, "expected an offset that is a whole number");
            if (semantic == "POSITION")
                fail(input, "corners outside <vertices>; export it with an input of VERTEX");
            if (semantic == "VERTEX") layout.vertex = offset.value_or(0);
            layout.stride = std::max(layout.stride, offset.value_or(0) + 1);
        });
        return layout;
    }

    /// The corners of one `<p>`.
    std::size_t corners_of(const XMLElement& p, const Layout& layout) {
        const auto indices = indices_of(p);
        if (indices.size() % layout.stride != 0) {
            fail(p, "has " + std::to_string(indices.size()) + " indices, " + std::to_string(layout.stride) +
                        " for each corner: part of the surface is missing; export it anew");
        }
        for (std::size_t i = layout.vertex; i < indices.size(); i += layout.stride)
            last_vertex_ = std::max(last_vertex_, indices[i]);
        return indices.size() / layout.stride;
    }

    std::size_t triangles_of_surface(const XMLElement& surface) {
        const std::string_view name = surface.Name();
        const Layout layout = layout_of(surface);
        std::vector<std::size_t> corners;
        const auto add = [&](const XMLElement& p) { corners.push_back(corners_of(p, layout)); };
        for_each_child(surface, "p", add);
        for_each_child(surface, "ph", [&](const XMLElement& ph) { for_each_child(ph, "p", add); });
        if (fault_) return 0;
        check_count(surface, std::ranges::any_of(corners, [](std::size_t count) { return count > 0; }));
        if (name == "polylist") return triangles_of_polygons(surface, corners);
        std::size_t triangles = 0;
        for (const std::size_t count : corners)
            triangles += name == "triangles" ? count / 3 : std::max<std::size_t>(count, 2) - 2;
        return triangles;
    }

    void check_count(const XMLElement& surface, bool has_indices) {
        const auto count = index_attribute(surface, "count", 0);
        if (!count || (has_indices && *count == 0))
            fail(surface,
                 tag(surface.Name()) +
                     " has indices, but no positive 'count', and readers leave it out; export it with "
                     "the number of its polygons");
    }

    std::size_t triangles_of_polygons(const XMLElement& surface, const std::vector<std::size_t>& corners) {
        std::size_t triangles = 0;
        std::size_t expected = 0;
        for_each_child(surface, "vcount", [&](const XMLElement& vcount) {
            for (const std::size_t count : indices_of(vcount)) {
                triangles += std::max<std::size_t>(count, 2) - 2;
                expected += count;
            }
        });
        std::size_t found = 0;
        for (const std::size_t count : corners) found += count;
        if (found != expected)
            fail(surface, "<vcount> has " + std::to_string(expected) + " corners, <p> has " +
                              std::to_string(found) + "; export it anew");
        return triangles;
    }

    /// assimp has one table of sources for the file: later ones replace earlier ones with the same id.
    void check_corners(const XMLElement& mesh) {
        std::map<std::string_view, const XMLElement*> sources;
        std::set<std::string_view> arrays;
        for_each_child(mesh, "source", [&](const XMLElement& source) {
            bool is_new = sources.emplace(attribute(source, "id"), &source).second;
            for_each_child(source, "float_array", [&](const XMLElement& array) {
                is_new = arrays.insert(attribute(array, "id")).second && is_new;
            });
            if (!is_new) fail(source, "two sources of a mesh have the same id; export it with unique ids");
        });
        const XMLElement* corners = nullptr;
        for_each_child(mesh, "vertices", [&](const XMLElement& vertices) {
            for_each_child(vertices, "input", [&](const XMLElement& input) {
                if (attribute(input, "semantic") != "POSITION") return;
                const auto url = attribute(input, "source");
                const auto found = url.starts_with('#') ? sources.find(url.substr(1)) : sources.end();
                if (found == sources.end() || corners != nullptr)
                    return fail(input, "expected one source of this mesh as the POSITION of its corners");
                corners = found->second;
            });
        });
        if (fault_) return;
        if (corners == nullptr) return fail(mesh, "no POSITION of the corners in <vertices>");
        check_source(*corners);
    }

    void check_source(const XMLElement& source) {
        const auto* const array = source.FirstChildElement("float_array");
        const auto* const common = source.FirstChildElement("technique_common");
        const auto* const accessor = common == nullptr ? nullptr : common->FirstChildElement("accessor");
        if (array == nullptr || accessor == nullptr ||
            source.FirstChildElement("float_array") != source.LastChildElement("float_array") ||
            attribute(*accessor, "source") != "#" + std::string(attribute(*array, "id")))
            return fail(source, "expected one <float_array> of the corners, and an <accessor> of it");
        check_params(*accessor);
        check_extent(*accessor, *array);
    }

    /// assimp takes coordinates by these names, and the first one in place of others.
    void check_params(const XMLElement& accessor) {
        std::string names;
        for_each_child(accessor, "param", [&names](const XMLElement& param) {
            names += std::string(attribute(param, "name")) + ' ';
        });
        if (names != "X Y Z ")
            fail(accessor, "expected the params X, Y and Z of the corners, found '" + names +
                               "'; name them so, in capital letters");
    }

    /// assimp reads behind the end of an array that is too short.
    void check_extent(const XMLElement& accessor, const XMLElement& array) {
        const auto stride = index_attribute(accessor, "stride", 1);
        const auto offset = index_attribute(accessor, "offset", 0);
        const auto count = index_attribute(array, "count", 0);
        if (!stride || !offset || !count)
            return fail(accessor,
                        "expected whole numbers as stride and offset of the corners, and as their count");
        const std::size_t found = numbers_of(array).size();
        if (found != *count)
            return fail(array, "has " + std::to_string(found) + " numbers, and 'count' is " +
                                   std::to_string(*count) + "; export it anew");
        if (*offset + last_vertex_ * *stride + 3 > *count)
            fail(accessor, "a surface has corners behind the end of this array; export it anew");
    }

    // --- The scene.

    struct Place {
        const XMLElement* node;
        std::size_t depth;
    };

    /// The nodes that are in `element`: its own, and those of an instance.
    void open_children(const Place& place, std::vector<Place>& open) {
        for_each_child(*place.node, nullptr, [&](const XMLElement& child) {
            ++steps_;
            const std::string_view name = child.Name();
            if (name == "node") open.push_back({&child, place.depth + 1});
            if (name == "instance_node")
                open.push_back({names_.only("node", attribute(child, "url")), place.depth + 1});
        });
    }

    std::size_t triangles_in_node(const XMLElement& node) {
        std::size_t count = 0;
        for_each_child(node, "instance_geometry", [&](const XMLElement& instance) {
            count += triangles_of_geometry(*names_.only("geometry", attribute(instance, "url")));
        });
        for_each_child(node, "instance_controller", [&](const XMLElement& instance) {
            count += triangles_of_controller(*names_.only("controller", attribute(instance, "url")));
        });
        return count;
    }

    std::size_t triangles_of_controller(const XMLElement& controller) {
        const auto* const skin = controller.FirstChildElement("skin");
        const auto* const geometry =
            skin == nullptr ? nullptr : names_.only("geometry", attribute(*skin, "source"));
        if (geometry != nullptr) {
            for_each_child(*skin, "bind_shape_matrix",
                           [this](const XMLElement& matrix) { check_shape_matrix(matrix); });
            return triangles_of_geometry(*geometry);
        }
        fail(controller, "a <controller> without a <skin> of one geometry; export the mesh without it");
        return 0;
    }

    /// Nodes that have instances of each other have no end, or more nodes than the file is long.
    std::size_t triangles_of_scene() {
        constexpr std::size_t kSteps = 5'000'000, kDepth = 1000, kTriangles = 10'000'000;
        check_materials();
        const auto* const scene = root_.FirstChildElement("scene");
        const auto* const instance =
            scene == nullptr ? nullptr : scene->FirstChildElement("instance_visual_scene");
        if (instance == nullptr || fault_) return 0;
        std::vector<Place> open{{names_.only("visual_scene", attribute(*instance, "url")), 0}};
        std::size_t count = 0;
        while (!open.empty() && !fault_) {
            const Place place = open.back();
            open.pop_back();
            count += triangles_in_node(*place.node);
            open_children(place, open);
            if (steps_ > kSteps || place.depth > kDepth || count > kTriangles)
                fail(*place.node,
                     "instances of nodes in each other, without an end or too many; export each "
                     "part once");
        }
        return count;
    }

    // --- Materials.

    /// The material of each surface of an instance, as assimp finds it.
    static std::vector<std::string_view> materials_of(const XMLElement& instance,
                                                      const XMLElement& geometry) {
        std::map<std::string_view, std::string_view> targets;
        for_each_child(instance, "bind_material", [&](const XMLElement& bind) {
            const auto* const common = bind.FirstChildElement("technique_common");
            if (common == nullptr) return;
            for_each_child(*common, "instance_material", [&](const XMLElement& material) {
                targets[attribute(material, "symbol")] = attribute(material, "target");
            });
        });
        std::vector<std::string_view> materials;
        const auto* const mesh = geometry.FirstChildElement("mesh");
        if (mesh == nullptr) return materials;
        for_each_child(*mesh, nullptr, [&](const XMLElement& surface) {
            if (surface.FirstChildElement("p") == nullptr) return;
            const auto found = targets.find(attribute(surface, "material"));
            if (found != targets.end()) return materials.push_back(found->second);
            materials.push_back(targets.empty() ? std::string_view() : targets.begin()->second);
        });
        return materials;
    }

    /// assimp uses a surface again that it has made for another instance with the same material, and then
    /// takes the next surface, of a new material, from the wrong place of the geometry.
    static bool are_mixed(const std::vector<std::string_view>& left,
                          const std::vector<std::string_view>& right) {
        bool has_same = false;
        for (std::size_t i = 0; i < left.size(); ++i) {
            if (left[i] != right[i] && has_same) return true;
            has_same = has_same || left[i] == right[i];
        }
        return false;
    }

    void check_materials() {
        for (const auto& [geometry, instances] : instances_) {
            std::map<std::vector<std::string_view>, const XMLElement*> kinds;
            for (const auto* const instance : instances)
                kinds.emplace(materials_of(*instance, *geometry), instance);
            constexpr std::size_t kKinds = 100;
            for (const auto& [left, one] : kinds)
                for (const auto& [right, other] : kinds)
                    if (kinds.size() > kKinds || are_mixed(left, right))
                        return fail(*other,
                                    "two instances of a geometry have the same material in one surface, and "
                                    "different ones in another, which readers mix up; export it with one "
                                    "material");
        }
    }

    const XMLElement& root_;
    Names names_;
    std::map<const XMLElement*, std::size_t> triangles_;
    std::map<const XMLElement*, std::vector<const XMLElement*>> instances_;
    std::set<const tinyxml2::XMLNode*> parents_;
    std::size_t last_vertex_ = 0;  ///< of the mesh that is being checked
    std::size_t steps_ = 0;
    std::optional<std::string> fault_;
};

}  // namespace

Result<std::size_t, std::string> check_collada_text(std::string_view bytes) {
    tinyxml2::XMLDocument document;
    if (document.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS)
        return unexpected("is no XML: " + std::string(document.ErrorStr()));
    const auto* const root = document.RootElement();
    if (root == nullptr) return unexpected(std::string("has no element"));
    return ColladaCheck(*root).triangles();
}

}  // namespace octoskin
