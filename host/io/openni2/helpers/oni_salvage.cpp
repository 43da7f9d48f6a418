#include "host/io/openni2/helpers/oni_salvage.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <map>
#include <vector>

#include "host/io/openni2/helpers/oni_records.hpp"

namespace octoskin::openni2 {
namespace {

constexpr std::uint32_t kNodeAddedFieldsMin = kOniRecordHeaderSize + 40;  ///< with an empty name
constexpr std::size_t kStreamsMax = 8;  ///< a device has depth, colour and infrared

struct IndexedFrame {
    std::uint64_t timestamp_us = 0;
    std::uint64_t position = 0;
};

/// A stream of the recording (a "node" in the file).
struct Stream {
    OniRecord added;
    std::vector<IndexedFrame> frames;
};

struct Contents {
    std::map<std::uint32_t, Stream> streams;
    std::uint32_t frames = 0;
    std::uintmax_t length = 0;  ///< end of the last complete frame
};

std::uint64_t timestamp_of(std::ifstream& file, const OniRecord& record) {
    std::uint64_t timestamp_us = 0;
    file.clear();
    file.seekg(static_cast<std::streamoff>(record.position + kOniRecordHeaderSize));
    file.read(reinterpret_cast<char*>(&timestamp_us), sizeof(timestamp_us));
    return timestamp_us;
}

Contents contents_of(const std::filesystem::path& oni) {
    Contents contents;
    OniRecords records(oni);
    while (const auto record = records.next()) {
        if (!record->fits()) break;
        if (record->type == OniRecordType::node_removed || record->type == OniRecordType::end) break;
        if (record->type == OniRecordType::node_added) {
            // Once for each stream, with room for the totals; otherwise the rest of the file is not valid.
            const bool is_new = contents.streams.try_emplace(record->node, Stream{*record, {}}).second;
            if (!is_new || record->fields_size < kNodeAddedFieldsMin) break;
        }
        if (record->type != OniRecordType::new_data) continue;
        const auto stream = contents.streams.find(record->node);
        // A frame without a stream: the rest of the file is not valid.
        if (record->fields_size < kOniFrameFieldsSize || stream == contents.streams.end()) break;
        stream->second.frames.push_back({timestamp_of(records.file(), *record), record->position});
        ++contents.frames;
        contents.length = record->end;
    }
    // Streams added after the last frame are not copied.
    std::erase_if(contents.streams,
                  [&](const auto& entry) { return entry.second.added.position >= contents.length; });
    return contents;
}

/// Appends to a file and overwrites parts of it; the first error is kept.
class Writer {
  public:
    explicit Writer(const std::filesystem::path& file)
        : file_(file, std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc) {}

    void copy(std::ifstream& from, std::uintmax_t count) {
        std::vector<char> buffer(1U << 16U);
        from.clear();
        from.seekg(0);
        while (count > 0 && file_) {
            const auto part = static_cast<std::streamsize>(std::min<std::uintmax_t>(count, buffer.size()));
            if (!from.read(buffer.data(), part)) file_.setstate(std::ios::failbit);
            file_.write(buffer.data(), part);
            count -= static_cast<std::uintmax_t>(part);
        }
    }
    template <class T>
    void put(T value) {
        file_.write(reinterpret_cast<const char*>(&value), sizeof(value));
    }
    void put_header(OniRecordType type, std::uint32_t node, std::uint32_t payload_size, std::uint64_t undo) {
        put(kOniRecordMagic);
        put(type);
        put(node);
        put(kOniRecordHeaderSize);
        put(payload_size);
        put(undo);
    }
    [[nodiscard]] std::uint64_t position() { return static_cast<std::uint64_t>(file_.tellp()); }
    void go_to(std::uint64_t position) { file_.seekp(static_cast<std::streamoff>(position)); }
    [[nodiscard]] bool close() {
        file_.close();
        return static_cast<bool>(file_);
    }

  private:
    std::fstream file_;
};

/// Returns the position of the table.
std::uint64_t put_end_of(Writer& out, std::uint32_t node, const Stream& stream) {
    constexpr std::uint32_t kEntrySize = 20;
    out.put_header(OniRecordType::node_removed, node, 0, stream.added.position);
    const std::uint64_t table = out.position();
    // Entry 0 is unused: frames are numbered from 1.
    const auto entries = static_cast<std::uint32_t>(stream.frames.size() + 1);
    out.put_header(OniRecordType::seek_table, node, entries * kEntrySize, 0);
    const auto put_entry = [&out](const IndexedFrame& frame) {
        out.put(frame.timestamp_us);
        out.put(std::uint32_t{0});  // the configuration's number, which only seeking needs
        out.put(frame.position);
    };
    put_entry({});
    for (const IndexedFrame& frame : stream.frames) put_entry(frame);
    return table;
}

/// The last fields of a stream's first record, which the recorder fills in only at the end.
void put_totals(Writer& out, const Stream& stream, std::uint64_t table) {
    constexpr std::uint32_t kTotalsSize = 28;
    out.go_to(stream.added.position + stream.added.fields_size - kTotalsSize);
    out.put(static_cast<std::uint32_t>(stream.frames.size()));
    out.put(std::uint64_t{0});  // the first time stamp
    out.put(stream.frames.empty() ? std::uint64_t{0} : stream.frames.back().timestamp_us);
    out.put(table);
}

}  // namespace

std::optional<std::uint32_t> salvage(const std::filesystem::path& oni, const std::filesystem::path& copy) {
    const Contents contents = contents_of(oni);
    if (contents.frames == 0 || contents.streams.size() > kStreamsMax || contents.length > kSalvageMax)
        return std::nullopt;
    std::ifstream from(oni, std::ios::binary);
    Writer out(copy);
    out.copy(from, contents.length);
    std::map<std::uint32_t, std::uint64_t> tables;
    for (const auto& [node, stream] : contents.streams) tables[node] = put_end_of(out, node, stream);
    out.put_header(OniRecordType::end, 0, 0, 0);
    for (const auto& [node, stream] : contents.streams) put_totals(out, stream, tables[node]);
    if (!out.close()) return std::nullopt;
    return contents.frames;
}

}  // namespace octoskin::openni2
