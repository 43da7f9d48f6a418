#include "hw/rigfile/document.hpp"

#include <fmt/format.h>
#include <yaml-cpp/emitter.h>
#include <yaml-cpp/emittermanip.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <unordered_map>
#include <utility>

#include "host/io/folder/confined.hpp"
#include "hw/rigfile/nesting.hpp"
#include "hw/rigfile/rig_keys.hpp"
#include "hw/rigfile/syntax_hint.hpp"
#include "hw/rigfile/unopened_file.hpp"

namespace octoskin::rig {
namespace {

constexpr std::size_t kFileBytesMax = 256U << 10U;  ///< thirty times the largest rig
constexpr std::size_t kKeysMax = 1000;              ///< of one table
constexpr std::size_t kDepthMax = 16;
constexpr std::size_t kExtendsMax = 8;

/// A description of the kind of XML; empty: not XML.
std::string_view xml_kind(std::string_view text) {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
    const auto begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos || text[begin] != '<') return {};
    // "<<:" is YAML's merge key, which is no XML.
    const char next = begin + 1 < text.size() ? text[begin + 1] : ' ';
    if (next != '?' && next != '!' && std::isalpha(static_cast<unsigned char>(next)) == 0) return {};
    if (text.find("<robot") != std::string_view::npos) return "XML that looks like a robot (URDF)";
    if (text.find("<sdf") != std::string_view::npos) return "XML that looks like a world (SDF)";
    return "XML";
}

std::string read_text(const FilePlace& place) {
    const std::filesystem::path file = place.shown();
    const auto opened = place.open();
    if (!opened) throw unopened_file(opened.error(), "YAML");
    auto bytes = opened->read(kFileBytesMax);
    if (!bytes) throw to_error(bytes.error(), "cannot be read: ");
    std::string text = std::move(*bytes);
    if (const std::string_view what = xml_kind(text); !what.empty()) {
        throw Error{ErrorCode::foreign_format, "expected YAML", std::string(what),
                    "is it the path of another file?", file};
    }
    if (text.size() > kFileBytesMax) {
        throw Error{.code = ErrorCode::too_large,
                    .what = fmt::format("expected a file of at most {} bytes", kFileBytesMax),
                    .value = "more",
                    .file = file};
    }
    return text;
}

/// Builds the tree from yaml-cpp's events instead of its nodes: nodes drop a repeated key, do not keep the
/// file of a value, and expand aliases without a bound.
class TreeBuilder final : public YAML::EventHandler {
  public:
    TreeBuilder(std::shared_ptr<const FilePlace> file, Quotes quotes)
        : file_(std::move(file)), quotes_(quotes) {}

    [[nodiscard]] Value take_root() { return std::move(root_); }

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        refuse_anchor(mark, anchor);
        if (is_key_next()) fail(mark, {ErrorCode::bad_syntax, "expected a key", "nothing"});
        add(make(mark, Value::Kind::null));
    }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
        fail(mark, {.code = ErrorCode::unsupported,
                    .what = "aliases (*name) are not supported",
                    .remedy = "write the value out, or use sensor_defaults"});
    }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& text) override {
        refuse_anchor(mark, anchor);
        refuse_tag(mark, tag);
        if (is_key_next()) return start_entry(mark, text);
        Value value = make(mark, Value::Kind::scalar);
        value.text = text;
        value.is_quoted = tag == "!";
        add(std::move(value));
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        open(mark, tag, anchor, Value::Kind::list);
    }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        open(mark, tag, anchor, Value::Kind::table);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapEnd() override { close(); }

  private:
    [[noreturn]] void fail(const YAML::Mark& mark, Error error) const {
        error.file = file_->shown();
        error.line = mark.line + 1;
        throw error;
    }
    void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) const {
        if (anchor == YAML::NullAnchor) return;
        fail(mark, {.code = ErrorCode::unsupported,
                    .what = "anchors (&name) are not supported",
                    .remedy = "remove it"});
    }
    void refuse_tag(const YAML::Mark& mark, const std::string& tag) const {
        // yaml-cpp's own marks: "?" for a plain value, "!" for a quoted one.
        if (!tag.empty() && tag != "?" && tag != "!") {
            fail(mark, {.code = ErrorCode::unsupported,
                        .what = "tags are not supported",
                        .remedy = quotes_ == Quotes::shown ? fmt::format("remove '{}'", tag)
                                                           : std::string("remove it")});
        }
    }
    [[nodiscard]] Value make(const YAML::Mark& mark, Value::Kind kind) const {
        Value value;
        value.kind = kind;
        value.file = file_;
        value.line = mark.line + 1;
        value.is_quotable = quotes_ == Quotes::shown;
        return value;
    }
    [[nodiscard]] bool is_key_next() const {
        return !open_.empty() && open_.back().kind == Value::Kind::table && !has_key_;
    }
    void start_entry(const YAML::Mark& mark, const std::string& key) {
        const auto [first, is_new] = keys_.back().try_emplace(key, mark.line + 1);
        if (!is_new) {
            throw Error{.code = ErrorCode::duplicate,
                        .what = "expected each key once",
                        .value = fmt::format("it again (first at line {})", first->second),
                        .remedy = "remove one",
                        .file = file_->shown(),
                        .line = mark.line + 1,
                        .key = quotes_ == Quotes::shown ? key : std::string()};
        }
        if (keys_.back().size() > kKeysMax)
            fail(mark, {ErrorCode::limit_exceeded,
                        fmt::format("expected at most {} keys in a table", kKeysMax), "more"});
        pending_key_ = key;
        pending_key_line_ = mark.line + 1;
        has_key_ = true;
    }
    void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, Value::Kind kind) {
        refuse_anchor(mark, anchor);
        refuse_tag(mark, tag);
        if (is_key_next()) fail(mark, {ErrorCode::bad_syntax, "expected a key", "a list or table"});
        if (open_.size() >= kDepthMax)
            fail(mark, {ErrorCode::limit_exceeded,
                        fmt::format("expected at most {} levels of lists and tables", kDepthMax)});
        Value value = make(mark, kind);
        take_key(value);
        open_.push_back(std::move(value));
        keys_.emplace_back();
    }
    void close() {
        Value value = std::move(open_.back());
        open_.pop_back();
        keys_.pop_back();
        (open_.empty() ? root_ : open_.back().items.emplace_back()) = std::move(value);
    }
    /// An entry has its key's line: a table or list below it begins one line later.
    void take_key(Value& value) {
        if (has_key_) value.line = pending_key_line_;
        value.key = std::exchange(pending_key_, {});
        has_key_ = false;
    }
    void add(Value value) {
        take_key(value);
        (open_.empty() ? root_ : open_.back().items.emplace_back()) = std::move(value);
    }

    std::shared_ptr<const FilePlace> file_;
    Quotes quotes_;
    std::vector<Value> open_;                                 ///< open tables and lists, outermost first
    std::vector<std::unordered_map<std::string, int>> keys_;  ///< keys of each open table, with their lines
    std::string pending_key_;
    int pending_key_line_ = 0;
    bool has_key_ = false;
    Value root_;
};

constexpr std::array<std::string_view, 4> kOrientationKeys = {
    name_of(keys::pose::kRollPitchYaw), name_of(keys::pose::kQuaternion), name_of(keys::pose::kRotationRows),
    name_of(keys::pose::kLookingAt)};

bool is_orientation(const Value& item) {
    return std::find(kOrientationKeys.begin(), kOrientationKeys.end(), item.key) != kOrientationKeys.end();
}

void mark_replacing(Value& value) {  // recursion is at most kDepthMax deep, the limit for files
    value.replaces_inherited = true;
    for (Value& item : value.items) mark_replacing(item);
}

void merge_item(Value& base, const Value& item) {
    std::erase_if(base.items, [&](const Value& old) {
        return old.key != item.key && is_orientation(old) && is_orientation(item);
    });
    const auto old = std::find_if(base.items.begin(), base.items.end(),
                                  [&](const Value& candidate) { return candidate.key == item.key; });
    if (item.kind == Value::Kind::null) {
        if (old != base.items.end()) base.items.erase(old);
    } else if (old == base.items.end()) {
        base.items.push_back(item);
    } else if (old->kind == Value::Kind::table && item.kind == Value::Kind::table) {
        *old = merge(std::move(*old), item);
    } else {
        const bool is_list_for_list = old->kind == Value::Kind::list && item.kind == Value::Kind::list;
        *old = item;
        if (is_list_for_list) mark_replacing(*old);
    }
}

/// The file that `extends:` names, or none. Removes the key.
FilePlace take_extends(Value& document) {
    constexpr std::string_view kKey = name_of(keys::kExtends);
    const Value* extends = document.find(kKey);
    if (!extends) return {};
    auto path = existing_file(*extends, std::string(kKey));
    std::erase_if(document.items, [kKey](const Value& item) { return item.key == kKey; });
    return path;
}

void emit(YAML::Emitter& out, const Value& value) {  // recursion is at most kDepthMax deep
    switch (value.kind) {
        case Value::Kind::null:
            out << YAML::Null;
            break;
        case Value::Kind::scalar:
            if (value.is_quoted) out << YAML::DoubleQuoted;
            emit_text(out, value.text);
            break;
        case Value::Kind::list:
            out << YAML::BeginSeq;
            for (const Value& item : value.items) emit(out, item);
            out << YAML::EndSeq;
            break;
        case Value::Kind::table:
            out << YAML::BeginMap;
            for (const Value& item : value.items) {
                out << YAML::Key;
                emit_text(out, item.key);
                out << YAML::Value;
                emit(out, item);
            }
            out << YAML::EndMap;
            break;
    }
}

}  // namespace

const Value* Value::find(std::string_view wanted) const noexcept {
    const auto found =
        std::find_if(items.begin(), items.end(), [&](const Value& item) { return item.key == wanted; });
    return kind == Kind::table && found != items.end() ? &*found : nullptr;
}

Value load_document(const FilePlace& place, Quotes quotes) {
    const std::string text = read_text(place);
    const std::filesystem::path file = place.shown();
    if (auto error = deep_brackets(text)) {
        error->file = file;
        throw *std::move(error);
    }
    std::istringstream stream(text);
    TreeBuilder builder(std::make_shared<const FilePlace>(place), quotes);
    try {
        YAML::Parser parser(stream);
        parser.HandleNextDocument(builder);
        Value root = builder.take_root();
        if (root.kind != Value::Kind::table) {
            throw Error{.code = ErrorCode::wrong_type,
                        .what = "expected a table of keys at the top, found none",
                        .file = file,
                        .line = std::max(root.line, 1)};
        }
        if (parser.HandleNextDocument(builder)) {
            throw Error{.code = ErrorCode::unsupported,
                        .what = "expected one YAML document",
                        .value = "a second",
                        .file = file,
                        .line = builder.take_root().line};
        }
        return root;
    } catch (const YAML::Exception& exception) {
        const int line = exception.mark.line + 1;
        throw Error{.code = ErrorCode::bad_syntax,
                    .what = "not YAML: " + yaml_syntax_hint(exception.msg, text, line),
                    .file = file,
                    .line = line,
                    .column = exception.mark.column + 1};
    }
}

FilePlace existing_file(const Value& value, const std::string& key_path) {
    // A recording from an untrusted source cannot name a file outside its folder, even if a trusted rig
    // extends its rig.
    FilePlace place = confined_to_recording(value.file->beside(value.text));
    const auto opened = place.open();
    const bool is_scalar = value.kind == Value::Kind::scalar;
    if (opened && is_scalar) return place;
    if (!opened && opened.error().fault == FolderFault::not_permitted) {
        throw Error{.code = ErrorCode::no_permission,
                    .what = "cannot be opened (Permission denied)",
                    .file = place.shown()};
    }
    Error refused{.file = value.file->shown(), .line = value.line, .key = key_path};
    const NamedFolder* const folder = value.file->folder();
    if (folder != nullptr && !opened && is_scalar && opened.error().fault != FolderFault::absent) {
        refused.code = code_of(opened.error().fault);
        refused.what = fmt::format("expected a file in {}", folder->shown().string());
        refused.value = fmt::format("'{}', which {}", value.text, opened.error().reason());
        refused.remedy = "put the file itself there";
        throw refused;
    }
    std::error_code error;
    refused.code = ErrorCode::not_found;
    refused.what = "expected the path of a file, relative to this one";
    refused.value = fmt::format("none at '{}'",
                                std::filesystem::absolute(place.shown(), error).lexically_normal().string());
    throw refused;
}

Value merge(Value base, const Value& overlay) {
    for (const Value& item : overlay.items) merge_item(base, item);
    // Faults of the merged document as a whole are reported at the overlay's file.
    base.file = overlay.file;
    base.line = overlay.line;
    base.replaces_inherited = overlay.replaces_inherited;
    return base;
}

Value load_with_extends(const FilePlace& file, std::vector<FilePlace>* extended) {
    std::vector<Value> layers = {load_document(file)};
    for (auto next = take_extends(layers.back()); !next.empty(); next = take_extends(layers.back())) {
        if (extended != nullptr) extended->push_back(next);
        if (layers.size() == kExtendsMax) {
            throw Error{.code = ErrorCode::limit_exceeded,
                        .what = fmt::format("expected at most {} files that extend each other", kExtendsMax),
                        .value = "more",
                        .remedy = "is there a circle?",
                        .file = file.shown(),
                        .key = std::string(name_of(keys::kExtends))};
        }
        layers.push_back(load_document(next, Quotes::withheld));
    }
    Value merged = std::move(layers.back());
    for (std::size_t i = layers.size() - 1; i-- > 0;) merged = merge(std::move(merged), layers[i]);
    return merged;
}

void emit_text(YAML::Emitter& out, const std::string& text) {
    const auto is_control = [](unsigned char byte) { return byte < 0x20 || byte == 0x7f; };
    if (std::any_of(text.begin(), text.end(), is_control)) out << YAML::DoubleQuoted;
    out << text;
}

std::string document_text(const Value& root) {
    YAML::Emitter out;
    emit(out, root);
    return std::string(out.c_str()) + "\n";
}

}  // namespace octoskin::rig
