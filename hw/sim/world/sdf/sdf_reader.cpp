#include "hw/sim/world/sdf/sdf_reader.hpp"

#include <console_bridge/console.h>

#include <fstream>
#include <ignition/math/eigen3/Conversions.hh>
#include <optional>
#include <sdf/sdf.hh>

#include "hw/sim/world/sdf/sdf_shapes.hpp"

namespace octoskin::sim {
namespace {

using ignition::math::eigen3::convert;

/// Models within models deeper than this are refused, so that reading is bounded whatever the file says.
constexpr int kNestingMax = 16;

/// The text of a file's line, so that a message shows the value that the parser does not tell.
std::string line_of(const std::filesystem::path& file, int number) {
    std::ifstream input(file);
    std::string line;
    for (int i = 0; i < number && std::getline(input, line); ++i) {
    }
    const auto first = line.find_first_not_of(" \t");
    return first == std::string::npos ? "" : line.substr(first, line.find_last_not_of(" \t\r") + 1 - first);
}

/// The parser's first error; the others are the same one, told again for each element round it.
std::string text_of(const sdf::Errors& errors, const std::filesystem::path& file) {
    const sdf::Error& error = errors.front();
    std::string text = error.Message();
    text.erase(text.find_last_not_of(".\n ") + 1);
    if (error.LineNumber()) {
        text = "line " + std::to_string(*error.LineNumber()) + ": " + text + ", at '" +
               line_of(file, *error.LineNumber()) + "'";
    }
    // The parser knows the wrong element's name and line but not which shapes would be right.
    return text.find("child of element[geometry]") == std::string::npos
               ? text
               : text + "; supported shapes are " + kSdfShapes;
}

/// Silences the libraries while it lives: what they print comes back as errors, and when sdformat cannot read
/// a file it tries it as a robot description and prints why it is none.
class Silence {
  public:
    Silence() {
        sdf::Console::Instance()->SetQuiet(true);
        console_bridge::noOutputHandler();
    }
    ~Silence() { console_bridge::restorePreviousOutputHandler(); }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;
};

/// Walks one file; the first error stops it.
class Reader {
  public:
    explicit Reader(const SdfInput& input) : input_(input), file_(input.file) {}

    SolidsOrError read() {
        sdf::Root root;
        if (load(root) && add_root(root)) {
            if (!solids_.empty()) {
                return std::move(solids_);
            }
            fail("", "no visual with a shape in it: there is nothing to see");
        }
        return unexpected(*error_);
    }

  private:
    bool load(sdf::Root& root) {
        const Silence silence;
        sdf::ParserConfig config;
        config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
        // Only where a world may include others: who may not refer to any file is refused an <include>
        // before.
        config.SetFindCallback([directory = file_.parent_path()](const std::string& uri) {
            const auto beside = directory / uri;
            return std::filesystem::exists(beside) ? beside.string() : std::string();
        });
        try {
            const sdf::Errors errors = root.Load(input_.path.string(), config);
            return errors.empty() || fail("", text_of(errors, input_.path));
        } catch (const std::exception& exception) {
            return fail("", std::string("the SDF parser gave up: ") + exception.what());
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
        // A model that is the whole file has no frame to be relative to: its pose is taken as written.
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
        TriangleMesh mesh = weld(transformed(*shape, T_world_visual));
        const bool closed = is_closed(mesh);
        if (closed && signed_volume(mesh) < 0.0) {
            turn_inside_out(mesh);
        }
        const std::string model = name.substr(0, std::min(name.find("::"), name.find('/')));
        solids_.push_back({name, model, std::move(mesh.vertices), std::move(mesh.triangles), closed});
        return true;
    }

    std::optional<Eigen::Isometry3d> resolve(const std::string& element, const sdf::SemanticPose& pose) {
        ignition::math::Pose3d resolved;
        const sdf::Errors errors = pose.Resolve(resolved);
        if (!errors.empty()) {
            fail(element, text_of(errors, input_.path));
            return std::nullopt;
        }
        if (!resolved.IsFinite()) {
            fail(element, "expected a pose of finite numbers");
            return std::nullopt;
        }
        return convert(resolved);
    }

    bool fail(const std::string& element, const std::string& what) {
        error_ = WorldError{file_, element, what};
        return false;
    }

    const SdfInput& input_;
    std::filesystem::path file_;
    std::vector<Solid> solids_;
    std::optional<WorldError> error_;
};

}  // namespace

SolidsOrError parse_solids(const SdfInput& sdf) {
    return Reader(sdf).read();
}

}  // namespace octoskin::sim
