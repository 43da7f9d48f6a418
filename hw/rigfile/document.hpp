// A YAML file as a plain tree that remembers where every value was written: the layer between yaml-cpp and
// the checks. It accepts the part of YAML that a rig needs (tables, lists, scalars) and refuses the rest by
// name.
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

/// Thrown inside hw/rigfile only; the public functions catch it and return its error.
struct Fault {
    RigError error;
};

/// One value, and where it was written. An item of a table carries its key.
struct Value {
    enum class Kind { null, scalar, list, table };
    Kind kind = Kind::null;
    std::string key;         ///< in the table above; empty in a list and at the top
    std::string text;        ///< of a scalar
    bool is_quoted = false;  ///< a quoted scalar is a string, whatever it looks like
    std::vector<Value> items;
    std::shared_ptr<const FilePlace> file;
    int line = 0;                     ///< 1-based
    bool is_quotable = true;          ///< false: of a file that another one names, see Quotes
    bool replaces_inherited = false;  ///< it is, or lies in, a list that took the place of an inherited one

    /// The item of a table with this key; nullptr if there is none.
    [[nodiscard]] const Value* find(std::string_view wanted) const noexcept;
};

/// Whether a message about a file's writing may show what is written: not of a file that another one names,
/// which may be no YAML of ours at all.
enum class Quotes : std::uint8_t { shown, withheld };

/// Reads one YAML file whose top is a table. Throws Fault: unreadable, over 256 KiB, not YAML, a key twice in
/// one table, over 1000 keys in one, an anchor, alias or tag, more than one document, nested deeper than 16.
[[nodiscard]] Value load_document(const FilePlace& file, Quotes quotes = Quotes::shown);

/// The file that a scalar names, relative to the file it is written in. Throws Fault, at the scalar, unless
/// that is an existing file; and, where the file it is written in lies below a folder that was named (a
/// recording), unless that is an ordinary file of this folder, behind no link.
[[nodiscard]] FilePlace existing_file(const Value& value, const std::string& key_path);

/// Lays `overlay` over `base`: tables are merged key by key, everything else replaces, and a null removes the
/// key. An orientation replaces the other file's orientation even if it is written another way.
[[nodiscard]] Value merge(Value base, const Value& overlay);

/// load_document(), then every file that `extends:` names, each relative to the file that names it, laid one
/// over the other. Throws Fault also for a circle and for more than 8 files. `extended` is told those files,
/// the nearest first.
[[nodiscard]] Value load_with_extends(const FilePlace& file, std::vector<FilePlace>* extended = nullptr);

/// Writes a text so that load_document() reads the same text. The emitter writes a carriage return without
/// quotes, and a reader drops it: a text with a control character is written in double quotes.
void emit_text(YAML::Emitter& out, const std::string& text);

/// YAML that load_document() reads as this tree again, but for its lines.
[[nodiscard]] std::string document_text(const Value& root);

}  // namespace octoskin::rig
