#include "hw/image/build_attributes.hpp"

#include <algorithm>
#include <string>

namespace octoskin::image {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Attributes = std::map<std::uint32_t, std::uint32_t>;

constexpr std::uint8_t kFormatVersion = 'A';
constexpr std::uint32_t kTagFile = 1;
constexpr std::uint32_t kTagCpuRawName = 4;
constexpr std::uint32_t kTagCpuName = 5;
constexpr std::uint32_t kTagCompatibility = 32;

/// Reads values from the front. A read past the end sets `has_failed`.
class Reader {
  public:
    explicit Reader(Bytes bytes) : bytes_(bytes) {}

    [[nodiscard]] std::uint32_t u32() {
        const Bytes four = take(4);
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < four.size(); ++i) value |= std::uint32_t{four[i]} << (8 * i);
        return value;
    }
    /// Unsigned LEB128 of at most 32 bits.
    [[nodiscard]] std::uint32_t uleb() {
        std::uint64_t value = 0;
        for (std::uint32_t shift = 0; shift < 35; shift += 7) {
            const Bytes one = take(1);
            if (one.empty()) return 0;
            value |= std::uint64_t{one[0] & 0x7FU} << shift;
            if ((one[0] & 0x80U) == 0)
                return value <= 0xFFFF'FFFF ? static_cast<std::uint32_t>(value) : fail();
        }
        return fail();
    }
    [[nodiscard]] std::string text() {
        const auto end = std::find(bytes_.begin(), bytes_.end(), 0);
        if (end == bytes_.end()) {
            (void)fail();
            return {};
        }
        const std::string text(bytes_.begin(), end);
        (void)take(text.size() + 1);
        return text;
    }
    [[nodiscard]] Bytes take(std::size_t count) {
        if (count > bytes_.size()) {
            (void)fail();
            return {};
        }
        const Bytes taken = bytes_.first(count);
        bytes_ = bytes_.subspan(count);
        return taken;
    }
    [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }
    [[nodiscard]] bool has_failed() const { return has_failed_; }

  private:
    std::uint32_t fail() {
        has_failed_ = true;
        bytes_ = {};
        return 0;
    }
    Bytes bytes_;
    bool has_failed_ = false;
};

/// The name tags have text values, and so do odd tags above 32.
bool is_text(std::uint32_t tag) {
    return tag == kTagCpuRawName || tag == kTagCpuName || (tag > kTagCompatibility && tag % 2 == 1);
}

bool read_file_attributes(Bytes bytes, Attributes& attributes) {
    Reader reader(bytes);
    while (!reader.is_at_end()) {
        const std::uint32_t tag = reader.uleb();
        if (is_text(tag)) {
            (void)reader.text();
            continue;
        }
        attributes[tag] = reader.uleb();
        if (tag == kTagCompatibility) (void)reader.text();
    }
    return !reader.has_failed();
}

/// One vendor's part: sub-subsections for the file, sections and symbols. Only those of the file are used.
bool read_vendor(Bytes bytes, Attributes& attributes) {
    Reader reader(bytes);
    while (!reader.is_at_end()) {
        const std::uint32_t tag = reader.uleb();
        const std::uint32_t size = reader.u32();  // includes tag and size
        constexpr std::uint32_t kHeaderBytes = 5;
        if (reader.has_failed() || size < kHeaderBytes) return false;
        const Bytes contents = reader.take(size - kHeaderBytes);
        if (reader.has_failed()) return false;
        if (tag == kTagFile && !read_file_attributes(contents, attributes)) return false;
    }
    return !reader.has_failed();
}

}  // namespace

std::optional<Attributes> build_attributes(Bytes section) {
    Reader reader(section);
    const Bytes version = reader.take(1);
    if (version.empty() || version[0] != kFormatVersion) return std::nullopt;
    Attributes attributes;
    while (!reader.is_at_end()) {
        const std::uint32_t size = reader.u32();  // includes its own four bytes
        if (reader.has_failed() || size < 4) return std::nullopt;
        Reader part(reader.take(size - 4));
        const std::string vendor = part.text();
        if (reader.has_failed() || part.has_failed()) return std::nullopt;
        if (vendor != "aeabi") continue;
        if (!read_vendor(part.take(size - 4 - (vendor.size() + 1)), attributes)) return std::nullopt;
    }
    if (attributes.empty()) return std::nullopt;
    return attributes;
}

}  // namespace octoskin::image
