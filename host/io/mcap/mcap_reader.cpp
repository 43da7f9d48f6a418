#include "host/io/mcap/mcap_reader.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "host/io/mapfile/file_checksum.hpp"
#include "host/io/mcap/compression.hpp"
#include "host/io/mcap/types.hpp"

namespace octoskin::mcap {
namespace {

/// The stretches by the time of their first message. Without a summary the channels are described in the
/// order of the file, which is then kept.
std::vector<std::size_t> order_of(const Layout& layout) {
    std::vector<std::size_t> order(layout.stretches.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (layout.channels.empty()) return order;
    std::ranges::stable_sort(order, [&layout](std::size_t a, std::size_t b) {
        return layout.stretches[a].first < layout.stretches[b].first;
    });
    return order;
}

/// Bytes that count as held while any message refers to them.
std::shared_ptr<const std::string> held(std::string bytes, const std::shared_ptr<std::size_t>& total) {
    const std::size_t size = bytes.size();
    *total += size;
    return {new std::string(std::move(bytes)), [total, size](const std::string* owned) {
                *total -= size;
                delete owned;
            }};
}

}  // namespace

Result<McapReader, Error> McapReader::open(const FilePlace& file) {
    auto opened = file.open();
    if (!opened) return unexpected(to_error(opened.error()));
    auto layout = survey(*opened);
    if (!layout) return unexpected(layout.error());
    const auto is_right = has_right_crc(*opened, *layout);
    if (!is_right) return unexpected(is_right.error());
    McapReader reader(std::move(*opened), std::move(*layout));
    if (!*is_right) reader.note(Fault::data_crc);
    return reader;
}

McapReader::McapReader(OpenFile file, Layout layout)
    : file_(std::move(file)),
      layout_(std::move(layout)),
      schemas_(layout_.schemas),
      channels_(layout_.channels),
      order_(order_of(layout_)) {
    counts_[static_cast<std::size_t>(Fault::cut)] = layout_.is_cut ? 1 : 0;
    counts_[static_cast<std::size_t>(Fault::oversized)] = layout_.oversized;
}

bool McapReader::must_load() const {
    if (next_ >= order_.size()) return false;
    if (waiting_.empty()) return true;
    const Stretch& stretch = layout_.stretches[order_[next_]];
    return stretch.first <= waiting_.top().head.logged && *bytes_held_ <= kWaitingBytesMax;
}

Result<std::optional<Message>, Error> McapReader::next() {
    for (;;) {
        while (must_load())
            if (const auto loaded = load(layout_.stretches[order_[next_++]]); !loaded)
                return unexpected(loaded.error());
        if (waiting_.empty()) return std::optional<Message>{};
        Waiting waiting = waiting_.top();
        waiting_.pop();
        if (auto message = described(std::move(waiting))) return message;
    }
}

std::optional<Message> McapReader::described(Waiting waiting) {
    if (waiting.head.logged < newest_) note(Fault::out_of_order);
    newest_ = std::max(newest_, waiting.head.logged);
    const auto channel = channels_.find(waiting.head.channel_id);
    if (channel == channels_.end()) {
        note(Fault::unknown_channel);
        return std::nullopt;
    }
    const auto schema = schemas_.find(channel->second.schema_id);
    return Message{.head = waiting.head,
                   .channel = &channel->second,
                   .schema = schema == schemas_.end() ? nullptr : &schema->second,
                   .data = {reinterpret_cast<const std::uint8_t*>(waiting.data.data()), waiting.data.size()},
                   .owner = std::move(waiting.owner)};
}

Status<Error> McapReader::load(const Stretch& stretch) {
    auto bytes = read_at(file_, stretch.at, stretch.bytes);
    if (!bytes) return unexpected(bytes.error());
    bytes_read_ += stretch.bytes;
    if (stretch.is_chunk)
        take_chunk(std::string_view(*bytes).substr(kRecordHeadBytes));
    else
        take_records(std::move(bytes).value());
    return Done{};
}

void McapReader::take_chunk(std::string_view fields) {
    FieldReader reader(fields);
    (void)reader.take(2 * sizeof(std::uint64_t));  // its times
    const auto size = reader.get<std::uint64_t>();
    const auto crc = reader.get<std::uint32_t>();
    const auto compression = compression_of(reader.get_text());
    const std::string_view packed = reader.take(reader.get<std::uint64_t>());
    if (!reader.is_sound()) return note(Fault::bad_record);
    if (size > kRecordBytesMax) return note(Fault::oversized);
    if (!compression) return note(Fault::compression);
    std::string bytes;
    const bool is_right = decompress(*compression, packed, static_cast<std::size_t>(size), bytes) &&
                          (crc == 0 || file_checksum(bytes) == crc);
    if (!is_right) return note(Fault::damaged_chunk);
    take_records(std::move(bytes));
}

void McapReader::take_records(std::string bytes) {
    const auto owner = held(std::move(bytes), bytes_held_);
    FieldReader reader(*owner);
    while (!reader.rest().empty()) {
        const Op op{reader.get<std::uint8_t>()};
        const std::string_view fields = reader.take(reader.get<std::uint64_t>());
        if (!reader.is_sound()) return note(Fault::bad_record);
        op == Op::message ? take_message(fields, owner) : take_type(op, fields);
    }
}

/// Of an id that is described again, the first description holds.
void McapReader::take_type(Op op, std::string_view fields) {
    const bool is_schema = op == Op::schema;
    if (!is_schema && op != Op::channel) return;
    const auto id = FieldReader(fields).get<std::uint16_t>();
    if (is_schema ? schemas_.contains(id) : channels_.contains(id)) return;
    if (type_bytes_ + fields.size() > kTypesBytesMax) return note(Fault::oversized);
    type_bytes_ += fields.size();
    if (is_schema) {
        auto schema = parse_schema(fields);
        schema ? void(schemas_.insert(std::move(*schema))) : note(Fault::bad_record);
    } else {
        auto channel = parse_channel(fields);
        channel ? void(channels_.insert(std::move(*channel))) : note(Fault::bad_record);
    }
}

void McapReader::take_message(std::string_view fields, const std::shared_ptr<const std::string>& owner) {
    FieldReader reader(fields);
    const MessageHead head = get_message_head(reader);
    if (!reader.is_sound()) return note(Fault::bad_record);
    waiting_.push({head, number_++, reader.rest(), owner});
}

}  // namespace octoskin::mcap
