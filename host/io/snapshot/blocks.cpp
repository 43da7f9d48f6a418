#include "host/io/snapshot/blocks.hpp"

#include <algorithm>
#include <array>

#include "host/io/mapfile/file_checksum.hpp"

namespace octoskin::snapshot {
namespace {

constexpr std::array<std::string_view, kBlockKinds> kTags{"HEAD", "LOGO", "PRIO", "MISS", "HITS",
                                                          "AGES", "CONF", "SEEN", "CAMR", "DONE"};
constexpr std::size_t kTagBytes = 4;
/// Kind, number and length.
constexpr std::size_t kHeadBytes = kTagBytes + 2 * sizeof(std::uint32_t);

}  // namespace

std::string_view tag_of(BlockKind kind) noexcept {
    return kTags[static_cast<std::size_t>(kind)];
}

void BlockWriter::end_block() {
    if (payload_.empty()) return;
    std::string head(tag_of(kind_));
    ByteWriter(head).put(number_++);
    ByteWriter(head).put(static_cast<std::uint32_t>(payload_.size()));
    ByteWriter(payload_).put(file_checksum(payload_, file_checksum(head)));
    is_taken_ = is_taken_ && sink_(head) && sink_(payload_);
    payload_.clear();
}

std::optional<Block> BlockReader::next() noexcept {
    const std::string_view rest = bytes_.substr(std::min(at_, bytes_.size()));
    const auto tag = std::ranges::find(kTags, rest.substr(0, kTagBytes));
    if (tag == kTags.end() || rest.size() < kHeadBytes) return std::nullopt;
    ByteReader head(rest.substr(kTagBytes));
    const auto number = head.get<std::uint32_t>();
    const std::size_t length = head.get<std::uint32_t>();
    const auto kind = static_cast<BlockKind>(tag - kTags.begin());
    const bool is_next = number == number_ && kind >= kind_ && length > 0 && length <= kPayloadMax;
    if (!is_next || rest.size() - kHeadBytes < length + sizeof(std::uint32_t)) return std::nullopt;
    const auto crc = ByteReader(rest.substr(kHeadBytes + length)).get<std::uint32_t>();
    if (crc != file_checksum(rest.substr(0, kHeadBytes + length))) return std::nullopt;
    const Block block{kind, rest.substr(kHeadBytes, length), at_};
    ++number_;
    kind_ = kind;
    at_ += kHeadBytes + length + sizeof(std::uint32_t);
    return block;
}

}  // namespace octoskin::snapshot
