#include "hw/sim/world/sdf_solids.hpp"

#include <dlfcn.h>
#include <tinyxml2.h>

#include <optional>
#include <string>

#include "hw/rigfile/file_kind.hpp"
#include "hw/sim/world/sdf/sdf_module.hpp"

namespace octoskin::sim {
namespace {

/// What keeps a file from being SDF at all, or nothing. sdformat would only say that it cannot read it, after
/// trying it as a robot description.
std::optional<std::string> xml_error_of(const std::filesystem::path& file) {
    if (const auto kind = rig::other_than_a_file(file); !kind.empty())
        return "is " + std::string(kind) + ", not an ordinary file";
    tinyxml2::XMLDocument document;
    if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) {
        return "line " + std::to_string(document.ErrorLineNum()) + ": not well-formed XML (" +
               document.ErrorName() + ")";
    }
    const std::string root = document.RootElement() == nullptr ? "" : document.RootElement()->Name();
    return root == "sdf"
               ? std::nullopt
               : std::optional("not an SDF file: expected the root element 'sdf', found '" + root + "'");
}

struct SdfModule {
    ReadSolids read_solids = nullptr;
};

/// Loads the module at the first call; it stays. The message says why it cannot be had.
Result<SdfModule, std::string> sdf_module() {
    void* const module = ::dlopen(kSdfModule, RTLD_NOW | RTLD_LOCAL);
    void* const symbol = module == nullptr ? nullptr : ::dlsym(module, kReadSolidsSymbol);
    if (symbol == nullptr) {
        const char* const reason = ::dlerror();
        return unexpected("what reads SDF files cannot be loaded: " +
                          std::string(reason == nullptr ? kReadSolidsSymbol : reason) +
                          "; build octoskin_programs, or install octoskin anew");
    }
    return SdfModule{reinterpret_cast<ReadSolids>(symbol)};
}

}  // namespace

Result<std::vector<Solid>, WorldError> read_solids(const std::filesystem::path& sdf) {
    const auto failed = [&](const std::string& what) { return unexpected(WorldError{sdf, "", what}); };
    if (!std::filesystem::is_regular_file(sdf)) return failed("no such file");
    if (const auto xml_error = xml_error_of(sdf)) return failed(*xml_error);
    const auto module = sdf_module();
    if (!module) return failed(module.error());
    SolidsOrError solids = std::vector<Solid>();
    module->read_solids(sdf, &solids);
    return solids;
}

}  // namespace octoskin::sim
