#include "host/errors/error.hpp"

namespace octoskin {
namespace {

/// Appends a part and the separator before it; nothing if the part is empty.
void append(std::string& text, const char* between, const std::string& part) {
    if (part.empty()) return;
    if (!text.empty()) text.append(between);
    text.append(part);
}

}  // namespace

std::string Error::reason() const {
    std::string text = what;
    append(text, ", found ", value);
    append(text, ": ", remedy);
    append(text, ". ", others);
    return text;
}

std::string Error::message() const {
    std::string text = file.string();
    if (line > 0) append(text, ":", std::to_string(line));
    if (line > 0 && column > 0) append(text, ":", std::to_string(column));
    append(text, ": ", key);
    append(text, ": ", reason());
    return text;
}

Error in_file(Error error, const std::filesystem::path& file, int line) {
    error.file = file;
    error.line = line;
    return error;
}

}  // namespace octoskin
