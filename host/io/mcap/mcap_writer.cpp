#include "host/io/mcap/mcap_writer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "host/io/mapfile/file_checksum.hpp"
#include "host/io/mcap/compression.hpp"

namespace octoskin::mcap {
namespace {

constexpr std::size_t kIdsMax = std::numeric_limits<std::uint16_t>::max();

std::uint64_t bits_of(WallTime time) {
    return static_cast<std::uint64_t>(time.ns);
}

std::uint16_t id_of(std::size_t index) {
    return static_cast<std::uint16_t>(index + 1);
}

std::string schema_fields(std::uint16_t id, const Schema& schema) {
    std::string fields;
    FieldWriter writer(fields);
    writer.put(id);
    writer.put_text(schema.name);
    writer.put_text(schema.encoding);
    writer.put_text(schema.data);
    return fields;
}

std::string channel_fields(std::uint16_t id, const Channel& channel) {
    std::string fields;
    FieldWriter writer(fields);
    writer.put(id);
    writer.put(channel.schema_id);
    writer.put_text(channel.topic);
    writer.put_text(channel.message_encoding);
    writer.put_metadata(channel.metadata);
    return fields;
}

}  // namespace

void McapWriter::Span::add(WallTime time) {
    first = has_any ? std::min(first, time) : time;
    last = has_any ? std::max(last, time) : time;
    has_any = true;
}

McapWriter::McapWriter(ByteSink sink, std::string_view library) : sink_(std::move(sink)) {
    emit(kMagic);
    std::string fields;
    FieldWriter writer(fields);
    writer.put_text("ros2");
    writer.put_text(library);
    emit_record(Op::header, fields);
}

void McapWriter::emit(std::string_view bytes) {
    crc_ = file_checksum(bytes, crc_);
    at_ += bytes.size();
    has_failed_ = has_failed_ || !sink_(bytes);
}

void McapWriter::emit_record(Op op, std::string_view fields) {
    std::string record;
    put_record(record, op, fields);
    emit(record);
}

std::uint16_t McapWriter::add_channel(const Schema& schema, Channel channel) {
    assert(channels_.size() < kIdsMax);
    const auto found = std::ranges::find(schemas_, schema);
    channel.schema_id = id_of(static_cast<std::size_t>(found - schemas_.begin()));
    if (found == schemas_.end()) {
        schemas_.push_back(schema);
        is_schema_written_.push_back(false);
    }
    channels_.push_back({std::move(channel)});
    return id_of(channels_.size() - 1);
}

/// Into the chunk: a reader of a file that was cut off has no summary.
void McapWriter::declare(std::uint16_t channel) {
    ChannelState& state = channels_[channel - 1];
    if (std::exchange(state.is_written, true)) return;
    const std::size_t schema = state.channel.schema_id - 1U;
    if (!is_schema_written_[schema])
        put_record(chunk_, Op::schema, schema_fields(state.channel.schema_id, schemas_[schema]));
    is_schema_written_[schema] = true;
    put_record(chunk_, Op::channel, channel_fields(channel, state.channel));
}

bool McapWriter::write(std::uint16_t channel, WallTime when, std::string_view data) {
    assert(channel >= 1 && channel <= channels_.size() && when.ns >= 0);
    declare(channel);
    ChannelState& state = channels_[channel - 1];
    chunk_index_[channel].emplace_back(when, chunk_.size());
    FieldWriter writer(chunk_);
    writer.put(static_cast<std::uint8_t>(Op::message));
    writer.put(static_cast<std::uint64_t>(MessageHead::kBytes + data.size()));
    put(writer, {channel, static_cast<std::uint32_t>(state.messages), when, when});
    chunk_ += data;
    ++state.messages;
    ++messages_;
    chunk_times_.add(when);
    times_.add(when);
    if (chunk_.size() >= kChunkBytes) end_chunk();
    return !has_failed_;
}

void McapWriter::end_chunk() {
    if (chunk_.empty()) return;
    const std::string packed = compress_zstd(chunk_);
    std::string fields;
    FieldWriter writer(fields);
    writer.put(bits_of(chunk_times_.first));
    writer.put(bits_of(chunk_times_.last));
    writer.put(static_cast<std::uint64_t>(chunk_.size()));
    writer.put(file_checksum(chunk_));
    writer.put_text(name_of(Compression::zstd));
    writer.put(static_cast<std::uint64_t>(packed.size()));
    fields += packed;
    ChunkPlace place{.times = chunk_times_,
                     .at = at_,
                     .bytes = kRecordHeadBytes + fields.size(),
                     .indexes = {},
                     .packed_bytes = packed.size(),
                     .unpacked_bytes = chunk_.size()};
    emit_record(Op::chunk, fields);
    emit_indexes(place);
    places_.push_back(std::move(place));
    chunk_.clear();
    chunk_index_.clear();
    chunk_times_ = {};
}

void McapWriter::emit_indexes(ChunkPlace& place) {
    const std::uint64_t begin = at_;
    for (const auto& [channel, index] : chunk_index_) {
        std::string entries;
        FieldWriter writer(entries);
        for (const auto& [time, offset] : index) {
            writer.put(bits_of(time));
            writer.put(offset);
        }
        std::string fields;
        FieldWriter all(fields);
        all.put(channel);
        all.put_text(entries);
        place.indexes[channel] = at_;
        emit_record(Op::message_index, fields);
    }
    place.index_bytes = at_ - begin;
}

std::string McapWriter::schemas() const {
    std::string records;
    for (std::size_t i = 0; i < schemas_.size(); ++i)
        if (is_schema_written_[i]) put_record(records, Op::schema, schema_fields(id_of(i), schemas_[i]));
    return records;
}

std::string McapWriter::channels() const {
    std::string records;
    for (std::size_t i = 0; i < channels_.size(); ++i)
        if (channels_[i].is_written)
            put_record(records, Op::channel, channel_fields(id_of(i), channels_[i].channel));
    return records;
}

std::string McapWriter::statistics() const {
    std::string counts;
    FieldWriter each(counts);
    std::uint32_t written = 0;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
        if (!channels_[i].is_written) continue;
        ++written;
        each.put(id_of(i));
        each.put(channels_[i].messages);
    }
    std::string fields;
    FieldWriter writer(fields);
    writer.put(messages_);
    writer.put(static_cast<std::uint16_t>(std::ranges::count(is_schema_written_, true)));
    writer.put(written);
    writer.put(std::uint32_t{0});  // attachments
    writer.put(std::uint32_t{0});  // metadata records
    writer.put(static_cast<std::uint32_t>(places_.size()));
    writer.put(bits_of(times_.first));
    writer.put(bits_of(times_.last));
    writer.put_text(counts);
    std::string record;
    put_record(record, Op::statistics, fields);
    return record;
}

std::string McapWriter::chunk_indexes() const {
    std::string records;
    for (const ChunkPlace& place : places_) {
        std::string indexes;
        FieldWriter each(indexes);
        for (const auto& [channel, at] : place.indexes) {
            each.put(channel);
            each.put(at);
        }
        std::string fields;
        FieldWriter writer(fields);
        writer.put(bits_of(place.times.first));
        writer.put(bits_of(place.times.last));
        writer.put(place.at);
        writer.put(place.bytes);
        writer.put_text(indexes);
        writer.put(place.index_bytes);
        writer.put_text(name_of(Compression::zstd));
        writer.put(place.packed_bytes);
        writer.put(place.unpacked_bytes);
        put_record(records, Op::chunk_index, fields);
    }
    return records;
}

void McapWriter::emit_summary() {
    crc_ = 0;
    const std::uint64_t begin = at_;
    std::string offsets;
    const std::array<std::pair<Op, std::string>, 4> groups = {{{Op::schema, schemas()},
                                                               {Op::channel, channels()},
                                                               {Op::statistics, statistics()},
                                                               {Op::chunk_index, chunk_indexes()}}};
    for (const auto& [op, records] : groups) {
        if (records.empty()) continue;
        std::string fields;
        FieldWriter writer(fields);
        writer.put(static_cast<std::uint8_t>(op));
        writer.put(at_);
        writer.put(static_cast<std::uint64_t>(records.size()));
        put_record(offsets, Op::summary_offset, fields);
        emit(records);
    }
    const std::uint64_t offsets_begin = at_;
    emit(offsets);
    std::string footer;
    FieldWriter writer(footer);
    writer.put(static_cast<std::uint8_t>(Op::footer));
    writer.put(std::uint64_t{20});
    writer.put(begin);
    writer.put(offsets_begin);
    writer.put(file_checksum(footer, crc_));
    emit(footer);
}

bool McapWriter::finish() {
    end_chunk();
    std::string fields;
    FieldWriter(fields).put(crc_);
    emit_record(Op::data_end, fields);
    emit_summary();
    emit(kMagic);
    return !has_failed_;
}

}  // namespace octoskin::mcap
