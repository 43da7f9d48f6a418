// A YAML file as a plain tree with the line of every value: the layer between yaml-cpp and the checks. It
// accepts tables, lists and scalars, and refuses other YAML constructs by name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/folder/file_place.hpp"
#include "hw/rigfile/rig.hpp"

namespace YAML {
class Emitter;
}

namespace octoskin::rig {

/// One value with its file and line. An item of a table has its key.
struct Value {
    enum class Kind { null, scalar, list, table };
    Kind kind = Kind::null;
    std::string key;         ///< in the table above; empty in a list and at the top
    std::string text;        ///< of a scalar
    bool is_quoted = false;  ///< a quoted scalar is a string, also if it looks like a number
    std::vector<Value> items;
    std::shared_ptr<const FilePlace> file;
    int line = 0;                     ///< 1-based
    bool is_quotable = true;          ///< false: of a file that another one names, see Quotes
    bool replaces_inherited = false;  ///< it is, or is in, a list that replaced an inherited one

    /// The item of a table with this key; nullptr if there is none.
    [[nodiscard]] const Value* find(std::string_view wanted) const noexcept;
};

/// Whether a message about the syntax of a file may quote its text. Withheld for a file that another file
/// names: it may be any file of this machine.
enum class Quotes : std::uint8_t { shown, withheld };

/// Reads one YAML file whose top is a table. Throws Error: unreadable, over 256 KiB, not YAML, a key twice in
/// one table, over 1000 keys in one, an anchor, alias or tag, more than one document, nested deeper than 16.
[[nodiscard]] Value load_document(const FilePlace& file, Quotes quotes = Quotes::shown);

/// The file that a scalar names, relative to the file that contains the scalar. Throws Error at the scalar if
/// it does not exist. If the containing file is below a named folder (a recording), the file must also be an
/// ordinary file of this folder, reached without a link.
[[nodiscard]] FilePlace existing_file(const Value& value, const std::string& key_path);

/// Lays `overlay` over `base`: tables are merged key by key, everything else replaces, and a null removes the
/// key. An orientation replaces the other file's orientation also if it has another notation.
[[nodiscard]] Value merge(Value base, const Value& overlay);

/// load_document(), then every file that `extends:` names, each relative to the file that names it, laid one
/// over the other. Throws Error also for a circle and for more than 8 files. `extended` receives those files,
/// the nearest first.
[[nodiscard]] Value load_with_extends(const FilePlace& file, std::vector<FilePlace>* extended = nullptr);

/// Writes a text so that load_document() reads the same text. The emitter writes a carriage return without
/// quotes, and a reader drops it: therefore a text with a control character is written in double quotes.
void emit_text(YAML::Emitter& out, const std::string& text);

/// YAML that load_document() reads back as this tree, except for the lines.
[[nodiscard]] std::string document_text(const Value& root);

}  // namespace octoskin::rig
