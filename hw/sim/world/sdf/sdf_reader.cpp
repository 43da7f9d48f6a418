#include "hw/sim/world/sdf/sdf_reader.hpp"

#include <console_bridge/console.h>

#include <algorithm>
#include <fstream>
#include <ignition/math/eigen3/Conversions.hh>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <sdf/sdf.hh>
#include <string_view>
#include <utility>

#include "common/cut_text.hpp"
#include "hw/sim/world/model_folders.hpp"
#include "hw/sim/world/sdf/sdf_shapes.hpp"
#include "hw/sim/world/sdf/written_out.hpp"

namespace octoskin::sim {
namespace {

using ignition::math::eigen3::convert;

/// Limit of nested models, so that reading is bounded for every file.
constexpr int kNestingMax = 16;

/// Up to here double precision resolves better than 0.1 mm.
constexpr double kCoordinateMax_m = 1e9;
constexpr const char* kCoordinateMax = "1e9 m";

bool is_near_enough(const Eigen::Vector3d& vertex) {
    return vertex.cwiseAbs().maxCoeff() <= kCoordinateMax_m;
}

/// The text of a file's line for a message, because the parser does not report the value. It is cut: the
/// whole file may be one line.
std::string line_of(const std::filesystem::path& file, int number) {
    std::ifstream input(file);
    std::string line;
    for (int i = 0; i < number && std::getline(input, line); ++i) {
    }
    const auto first = line.find_first_not_of(" \t");
    if (first == std::string::npos) return "";
    constexpr std::size_t kShown = 200;
    return cut_text(std::string_view(line).substr(first, line.find_last_not_of(" \t\r") + 1 - first), kShown);
}

/// "box" of ".../geometry/box" if `up` is 0, "geometry" if it is 1; without its number or name in brackets.
std::string name_in_path(const sdf::Error& error, std::size_t up) {
    const std::filesystem::path path = error.XmlPath().value_or("");
    auto at = path.end();
    for (std::size_t i = 0; i <= up; ++i) {
        if (at == path.begin()) return "";
        --at;
    }
    const std::string name = at->string();
    return name.substr(0, name.find('['));
}

bool is_unknown_element(const sdf::Error& error) {
    return error.Code() == sdf::ErrorCode::ELEMENT_INCORRECT_TYPE &&
           error.Message().find("not defined in SDF") != std::string::npos;
}

/// An unknown element in the shape of a visual may change the shape. Directly below <geometry> it is an
/// unsupported shape, which add_solid() reports.
bool is_in_seen_shape(const sdf::Error& error) {
    constexpr std::string_view kShapes[] = {"box",       "cylinder", "sphere", "capsule",
                                            "ellipsoid", "plane",    "mesh"};
    const bool is_seen = error.XmlPath().value_or("").find("/visual") != std::string::npos;
    return is_seen && std::ranges::find(kShapes, name_in_path(error, 1)) != std::end(kShapes);
}

/// Whether they differ in one character: added, missing or changed.
bool is_alike(std::string_view a, std::string_view b) {
    if (a.size() > b.size()) std::swap(a, b);
    if (b.size() - a.size() > 1) return false;
    const auto [in_a, in_b] = std::ranges::mismatch(a, b);
    const auto from_a = static_cast<std::size_t>(in_a - a.begin());
    const auto from_b = static_cast<std::size_t>(in_b - b.begin());
    const std::size_t skipped = a.size() == b.size() && in_a != a.end() ? 1 : 0;
    return a.substr(from_a + skipped) == b.substr(std::min(from_b + 1, b.size()));
}

/// A misspelt element that determines place or shape, such as "poze". If it were skipped, the world would
/// differ.
bool is_misspelt(const sdf::Error& error) {
    constexpr std::string_view kThatCount[] = {"model", "link",    "visual", "geometry",
                                               "pose",  "include", "frame"};
    constexpr std::string_view kThatHaveThem[] = {"world", "model", "link", "visual", "include", "frame"};
    const std::string name = name_in_path(error, 0);
    return std::ranges::find(kThatHaveThem, name_in_path(error, 1)) != std::end(kThatHaveThem) &&
           std::ranges::any_of(kThatCount, [&](std::string_view known) { return is_alike(name, known); });
}

/// A follow-up error, that an enclosing element could not be loaded: the original error is reported, too.
bool is_echo(const sdf::Error& error) {
    return error.Message().starts_with("Failed to load a ");
}

/// A sensor type that only a later sdformat knows.
bool is_unknown_sensor(const sdf::Error& error) {
    return error.Message().starts_with("Attempting to load a Sensor");
}

/// Whether the error makes the world unusable.
bool is_refusing(const sdf::Error& error) {
    if (is_unknown_element(error)) return is_in_seen_shape(error) || is_misspelt(error);
    return error.Code() != sdf::ErrorCode::LINK_INERTIA_INVALID && !is_unknown_sensor(error) &&
           !is_echo(error);
}

/// "<density> in <inertial>".
std::string element_of(const sdf::Error& error) {
    std::string text = "<";  // GCC 12 has a false warning for "<" + ...
    text += name_in_path(error, 0);
    text += "> in <";
    text += name_in_path(error, 1);
    return text + ">";
}

/// "line 7", of an included file "model.sdf, line 7"; empty if it is not known.
std::string place_of(const sdf::Error& error, const std::filesystem::path& file) {
    if (!error.LineNumber()) return "";
    const std::filesystem::path at = error.FilePath().value_or(file.string());
    return (at == file ? "" : at.string() + ", ") + "line " + std::to_string(*error.LineNumber());
}

std::string text_of(const sdf::Error& error, const std::filesystem::path& file) {
    std::string text = error.Message();
    text.erase(text.find_last_not_of(".\n ") + 1);
    if (error.Code() == sdf::ErrorCode::URI_LOOKUP) {
        const bool is_remote =
            text.find("://") != std::string::npos && text.find(kModelScheme) == std::string::npos;
        text += is_remote ? "; octoskin fetches nothing: put the model into a folder of "
                          : "; give the folder that the model's folder lies in by ";
        text += kModelFoldersHint;
    }
    if (!error.LineNumber()) return text;
    const std::filesystem::path at = error.FilePath().value_or(file.string());
    return place_of(error, file) + ": " + text + ", at '" + line_of(at, *error.LineNumber()) + "'";
}

/// Suppresses the libraries' output during its lifetime: errors are returned anyway, and for a file that
/// sdformat cannot read it tries to read a robot description and prints why that fails. Before that, sdformat
/// prints that it has no home directory for its log.
class Silence {
  public:
    Silence() : shown_(std::cerr.rdbuf(nullptr)) {
        sdf::Console::Instance()->SetQuiet(true);
        console_bridge::noOutputHandler();
    }
    ~Silence() {
        console_bridge::restorePreviousOutputHandler();
        std::cerr.rdbuf(shown_);
    }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;

  private:
    std::streambuf* shown_;
};

/// Reads one file; stops at the first error.
class Reader {
  public:
    explicit Reader(const SdfInput& input) : input_(input), file_(input.file) {}

    SolidsOrError read() {
        sdf::Root root;
        if (load(root) && add_root(root)) {
            if (!read_.solids.empty()) {
                if (input_.files == nullptr) read_.written_out = written_out(root);
                for (const auto& [uri, element] : meshes_)
                    read_.meshes.push_back(read_.written_out.empty() ? uri : element->Get<std::string>());
                return std::move(read_);
            }
            fail("", "no visual with a shape: the world is empty");
        }
        return unexpected(*error_);
    }

  private:
    bool load(sdf::Root& root) {
        const Silence silence;
        sdf::ParserConfig config;
        config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
        // Only for a world that may include others: for a world in a recording an <include> was refused
        // before.
        config.SetFindCallback([directory = file_.parent_path()](const std::string& uri) {
            const auto beside = directory / uri;
            return std::filesystem::exists(beside) ? beside.string() : std::string();
        });
        if (input_.files == nullptr) {
            for (const auto& folder : model_folders())
                config.AddURIPath(std::string(kModelScheme), folder.string());
        }
        try {
            const sdf::Errors errors = root.Load(input_.path.string(), config);
            const auto first = std::ranges::find_if(errors, is_refusing);
            if (first != errors.end()) return fail("", text_of(*first, input_.path));
            warn_of(errors);
            return true;
        } catch (const std::exception& exception) {
            return fail("", std::string("the SDF parser gave up: ") + exception.what());
        }
    }

    /// One warning for each kind of element, with its count.
    void warn_of(const sdf::Errors& errors) {
        std::map<std::string, std::pair<std::string, int>> unknown;
        for (const sdf::Error& error : errors) {
            if (!is_unknown_element(error)) continue;
            auto& [first, count] = unknown[element_of(error)];
            if (count++ == 0) first = place_of(error, input_.path) + ", " + error.XmlPath().value_or("");
        }
        if (std::ranges::any_of(errors, is_unknown_sensor))
            read_.warnings.emplace_back("a sensor without a type or of unknown type is ignored");
        for (const auto& [element, found] : unknown) {
            read_.warnings.push_back(found.first + ": " + element +
                                     " is not known to the installed sdformat, and is ignored (" +
                                     std::to_string(found.second) + " in all)");
        }
    }

    bool add_root(const sdf::Root& root) {
        if (root.Model() != nullptr && !add_model(*root.Model(), Eigen::Isometry3d::Identity(), {}, 0)) {
            return false;
        }
        if (root.WorldCount() > 1) {
            return fail("", "expected one world, found " + std::to_string(root.WorldCount()));
        }
        const sdf::World* world = root.WorldCount() == 1 ? root.WorldByIndex(0) : nullptr;
        for (std::uint64_t i = 0; world != nullptr && i < world->ModelCount(); ++i) {
            if (!add_model(*world->ModelByIndex(i), Eigen::Isometry3d::Identity(), {}, 0)) {
                return false;
            }
        }
        return true;
    }

    bool add_model(const sdf::Model& model, const Eigen::Isometry3d& T_world_parent,
                   const std::string& parents, int depth) {
        const std::string path = parents + model.Name();
        const std::string element = "model '" + path + "'";
        if (depth > kNestingMax) {
            return fail(element, "models nested deeper than " + std::to_string(kNestingMax));
        }
        // A model that is the whole file has no parent frame: its pose is used as written.
        const auto T_parent_model = resolve(element, model.SemanticPose());
        if (!T_parent_model) {
            return false;
        }
        const Eigen::Isometry3d T_world_model = T_world_parent * *T_parent_model;
        for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
            if (!add_link(*model.LinkByIndex(i), T_world_model, path)) {
                return false;
            }
        }
        for (std::uint64_t i = 0; i < model.ModelCount(); ++i) {
            if (!add_model(*model.ModelByIndex(i), T_world_model, path + "::", depth + 1)) {
                return false;
            }
        }
        return true;
    }

    bool add_link(const sdf::Link& link, const Eigen::Isometry3d& T_world_model, const std::string& model) {
        const std::string element = "model '" + model + "', link '" + link.Name() + "'";
        // The simulation does not use inertias.
        if (!link.Inertial().MassMatrix().IsValid())
            read_.warnings.push_back(element + ": its inertia is not physically valid, and is ignored");
        const auto T_model_link = resolve(element, link.SemanticPose());
        for (std::uint64_t i = 0; T_model_link && i < link.VisualCount(); ++i) {
            const sdf::Visual& visual = *link.VisualByIndex(i);
            const std::string visual_element = element + ", visual '" + visual.Name() + "'";
            const auto T_link_visual = resolve(visual_element, visual.SemanticPose());
            if (!T_link_visual) {
                return false;
            }
            const std::string name = model + "/" + link.Name() + "/" + visual.Name();
            if (!add_solid(visual, T_world_model * *T_model_link * *T_link_visual, name, visual_element)) {
                return false;
            }
        }
        return T_model_link.has_value();
    }

    bool add_solid(const sdf::Visual& visual, const Eigen::Isometry3d& T_world_visual,
                   const std::string& name, const std::string& element) {
        const auto shape = mesh_of(*visual.Geom(), input_);
        if (!shape) {
            return fail(element, shape.error());
        }
        if (visual.Geom()->Type() == sdf::GeometryType::MESH) {
            const auto uri = visual.Geom()->MeshShape()->Element()->GetElement("uri");
            meshes_.emplace_back(uri->Get<std::string>(), uri);
        }
        TriangleMesh mesh = weld(transformed(*shape, T_world_visual));
        if (!std::ranges::all_of(mesh.vertices, is_near_enough))
            return fail(element, std::string("reaches further than ") + kCoordinateMax +
                                     " from the origin: give it a smaller size, scale or pose");
        const bool closed = is_closed(mesh);
        if (closed && signed_volume(mesh) < 0.0) {
            turn_inside_out(mesh);
        }
        const std::string model = name.substr(0, std::min(name.find("::"), name.find('/')));
        read_.solids.push_back({name, model, std::move(mesh.vertices), std::move(mesh.triangles), closed});
        return true;
    }

    std::optional<Eigen::Isometry3d> resolve(const std::string& element, const sdf::SemanticPose& pose) {
        ignition::math::Pose3d resolved;
        const sdf::Errors errors = pose.Resolve(resolved);
        if (!errors.empty()) {
            fail(element, text_of(errors.front(), input_.path));
            return std::nullopt;
        }
        if (!resolved.IsFinite()) {
            fail(element, "expected a pose of finite numbers");
            return std::nullopt;
        }
        return convert(resolved);
    }

    bool fail(const std::string& element, const std::string& what) {
        error_ = Error{.code = ErrorCode::bad_value, .what = what, .file = file_, .key = element};
        return false;
    }

    const SdfInput& input_;
    std::filesystem::path file_;
    SolidsOfFile read_;
    std::vector<std::pair<std::string, sdf::ElementPtr>> meshes_;  ///< the original uri, and its element
    std::optional<Error> error_;
};

}  // namespace

SolidsOrError parse_solids(const SdfInput& sdf) {
    return Reader(sdf).read();
}

}  // namespace octoskin::sim
