#include "host/lab/world_reader/sdf_module_load.hpp"

#include <dlfcn.h>
#include <tinyxml2.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/lab/world_reader/ordinary_files.hpp"
#include "hw/rigfile/file_kind.hpp"
#include "hw/sim/world/model_folders.hpp"
#include "hw/sim/world/sdf/sdf_module.hpp"

namespace octoskin::sim {
namespace {

struct Include {
    int line = 0;
    std::string uri;
};

class Includes final : public tinyxml2::XMLVisitor {
  public:
    bool VisitEnter(const tinyxml2::XMLElement& element, const tinyxml2::XMLAttribute* /*first*/) override {
        if (std::string_view(element.Name()) != "include") return true;
        const tinyxml2::XMLElement* const uri = element.FirstChildElement("uri");
        const char* const text = uri == nullptr ? nullptr : uri->GetText();
        found_.push_back({element.GetLineNum(), text == nullptr ? "" : text});
        return true;
    }
    [[nodiscard]] const std::vector<Include>& found() const noexcept { return found_; }

  private:
    std::vector<Include> found_;
};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\r\n";
    const auto first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

/// The path of an included file, as far as it can be found without sdformat. sdformat's own error does not
/// say why a path is not readable as a file.
std::filesystem::path place_of(std::string_view uri, const std::filesystem::path& world) {
    constexpr std::string_view kFileScheme = "file://";
    uri = trimmed(uri);
    if (uri.starts_with(kModelScheme)) return find_model_file(uri).value_or("");
    if (uri.starts_with(kFileScheme)) uri.remove_prefix(kFileScheme.size());
    return world.parent_path() / uri;
}

/// Why a file is not SDF at all; empty if it may be. sdformat would only report that it cannot read the file,
/// after trying to read it as a robot description.
/// The key has the line: the reader's answer has no other place for it.
std::optional<Error> xml_error_of(const std::filesystem::path& file, bool may_include) {
    tinyxml2::XMLDocument document;
    if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) {
        return Error{.code = ErrorCode::bad_syntax,
                     .what = "not well-formed XML (" + std::string(document.ErrorName()) + ")",
                     .key = "line " + std::to_string(document.ErrorLineNum())};
    }
    const std::string root = document.RootElement() == nullptr ? "" : document.RootElement()->Name();
    if (root != "sdf")
        return Error{ErrorCode::foreign_format, "not an SDF file: expected the root element 'sdf'",
                     "'" + root + "'"};
    Includes includes;
    document.Accept(&includes);
    for (const Include& include : includes.found()) {
        const std::string line = "line " + std::to_string(include.line);
        // sdformat also searches included files in folders of its own choice.
        if (!may_include)
            return Error{.code = ErrorCode::unsupported,
                         .what = "<include> is not read in a world inside a recording",
                         .remedy = "give the world by its own option, or write the model out",
                         .key = line};
        const auto place = place_of(include.uri, file);
        std::error_code error;
        const bool is_model = std::filesystem::is_directory(place, error);
        const auto kind = rig::other_than_a_file(is_model ? place / "model.config" : place);
        if (!kind.empty())
            return Error{.code = ErrorCode::wrong_kind_of_file,
                         .what = "<include> expects an ordinary file or a model's folder",
                         .value = "'" + include.uri + "', which is " + std::string(kind),
                         .key = line};
    }
    return std::nullopt;
}

struct SdfModule {
    ReadSolids read_solids = nullptr;
};

Result<SdfModule, Error> sdf_module() {
    void* const module = ::dlopen(kSdfModule, RTLD_NOW | RTLD_LOCAL);
    void* const symbol = module == nullptr ? nullptr : ::dlsym(module, kReadSolidsSymbol);
    if (symbol == nullptr) {
        const char* const reason = ::dlerror();
        return unexpected(Error{.code = ErrorCode::no_program,
                                .what = "the reader of SDF files cannot be loaded (" +
                                        std::string(reason == nullptr ? kReadSolidsSymbol : reason) + ")",
                                .remedy = "build octoskin_programs, or install octoskin anew"});
    }
    return SdfModule{reinterpret_cast<ReadSolids>(symbol)};
}

}  // namespace

SolidsOrError load_solids(const std::filesystem::path& sdf, const AllowedFiles* files) {
    const auto failed = [](ErrorCode code, const std::string& what) { return unexpected(Error{code, what}); };
    std::filesystem::path path = sdf;
    if (files != nullptr) {
        auto checked = files->openable(sdf);
        if (!checked) return failed(ErrorCode::outside_folder, checked.error());
        path = std::move(*checked);
    }
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return failed(ErrorCode::not_found, "no such file");
    if (const auto kind = rig::other_than_a_file(path); !kind.empty())
        return failed(ErrorCode::wrong_kind_of_file, "is " + std::string(kind) + ", not an ordinary file");
    if (auto xml_error = xml_error_of(path, files == nullptr)) return unexpected(std::move(*xml_error));
    const auto module = sdf_module();
    if (!module) return unexpected(module.error());
    SolidsOrError solids = SolidsOfFile{};
    module->read_solids({.file = sdf, .path = path, .files = files}, &solids);
    if (const std::string refused = refused_file(); !refused.empty()) {
        if (!solids) return unexpected(Error{ErrorCode::wrong_kind_of_file, "needs ordinary files", refused});
        solids->warnings.push_back("needs " + refused + ", not an ordinary file; it is left out");
    }
    return solids;
}

}  // namespace octoskin::sim
