#include "host/io/openni2/helpers/oni_streams.hpp"

#include <algorithm>

#include "host/io/openni2/frame_pipe.hpp"
#include "host/io/openni2/helpers/oni_fields.hpp"
#include "host/io/openni2/helpers/packed_depth.hpp"

namespace octoskin::openni2 {
namespace {

constexpr std::uint32_t kTypeDepth = 2;
constexpr std::uint32_t kTypeImage = 3;
constexpr std::uint32_t kTypeInfrared = 5;
constexpr std::uint64_t kFormatDepthMm = 100;
constexpr std::size_t kDataBeginFields = 12;
constexpr std::size_t kNameMax = 79;  ///< PlayerNode has 80 bytes for it

constexpr std::uint32_t codec_of(const char (&name)[5]) {
    std::uint32_t codec = 0;
    for (unsigned i = 0; i < 4; ++i) codec |= std::uint32_t{static_cast<std::uint8_t>(name[i])} << 8U * i;
    return codec;
}
constexpr std::uint32_t kUncompressed = codec_of("NONE");
constexpr std::uint32_t kPlainDepth = codec_of("16zP");
constexpr std::uint32_t kTableDepth = codec_of("16zT");
constexpr std::uint32_t kJpeg = codec_of("JPEG");

Unexpected<std::string> fault(std::string what) {
    return unexpected(std::move(what));
}

std::string text_of(std::uint64_t number) {
    return std::to_string(number);
}

bool is_property(OniRecordType type) {
    return type == OniRecordType::int_property || type == OniRecordType::real_property ||
           type == OniRecordType::string_property || type == OniRecordType::general_property;
}

OniFinding fault_of_codec(std::uint32_t codec, bool is_depth) {
    if (codec == kUncompressed || (is_depth && (codec == kPlainDepth || codec == kTableDepth))) return Done{};
    if (codec == kJpeg) {
        return fault(
            "colours with lossy compression, whose decoder is not safe; record without it, or the depth "
            "stream alone");
    }
    return fault("a compression (" + text_of(codec) + ") that OpenNI2's recorder does not write for it");
}

}  // namespace

OniFinding OniStreams::take(const OniRecord& record, OniBytes fields, OniBytes payload) {
    const bool has_payload =
        record.type == OniRecordType::new_data || record.type == OniRecordType::seek_table;
    // For other records the player would interpret the payload as the next records.
    if (!has_payload && !payload.empty()) return fault("a payload in a record that has none");
    // The player may fail to skip a table with more fields.
    if (record.type == OniRecordType::seek_table && !fields.empty()) return fault("a seek table with fields");
    if (record.node >= header_.streams)
        return fault("stream " + text_of(record.node) + " of " + text_of(header_.streams) + " numbers");
    // The player does not open a file if it refuses a stream before the data begin. Later it continues
    // without that stream, and interprets the payloads of its frames as records. Changes of a stream during
    // playback (gain, mirroring) are safe: the player continues in any case.
    if (record.type == OniRecordType::node_added)
        return has_begun_ ? fault("a stream that is added after the data begin") : add(record, fields);
    const auto found = streams_.find(record.node);
    if (found == streams_.end()) return fault("stream " + text_of(record.node) + " was not added");
    Stream& stream = found->second;
    if (record.type == OniRecordType::seek_table) return take_table(stream, record, payload);
    if (stream.state == State::removed) return fault("stream " + text_of(record.node) + " was removed");
    return take_of(stream, record, fields, payload);
}

OniFinding OniStreams::take_of(Stream& stream, const OniRecord& record, OniBytes fields, OniBytes payload) {
    if (is_property(record.type)) {
        if (has_begun_ && stream.state != State::playing)
            return fault("a stream that is set up after the data begin");
        return set(stream, record, fields);
    }
    if (record.type == OniRecordType::state_ready) return make_ready(stream);
    if (record.type == OniRecordType::new_data) return take_frame(stream, record, fields, payload);
    if (record.type == OniRecordType::data_begin) return begin(stream, fields);
    if (record.type == OniRecordType::node_removed) {
        if (stream.state != State::playing) return fault("a stream that ends before it begins");
        stream.state = State::removed;
        return Done{};
    }
    return fault("a record of type " + text_of(static_cast<std::uint32_t>(record.type)) +
                 ", which OpenNI2's recorder does not write");
}

OniFinding OniStreams::add(const OniRecord& record, OniBytes bytes) {
    OniFields fields(bytes);
    const auto name = fields.take_text();
    const auto type = fields.take<std::uint32_t>();
    const auto codec = fields.take<std::uint32_t>();
    const auto frames = fields.take<std::uint32_t>();
    const auto times = fields.take_bytes(16);
    const auto table = fields.take<std::uint64_t>();
    if (!name || !type || !codec || !frames || !times || !table || !fields.are_at_end())
        return fault("a stream with incomplete fields");
    if (name->empty() || name->size() > kNameMax) return fault("a stream's name without 1 to 79 characters");
    if (*type != kTypeDepth && *type != kTypeImage && *type != kTypeInfrared)
        return fault("a stream of type " + text_of(*type) + ", not depth, colour or infrared");
    // The player finds streams by their names and never removes one.
    for (const auto& [node, other] : streams_) {
        if (node == record.node || other.name == *name)
            return fault("a second stream of one number or of one name");
    }
    const bool is_depth = *type == kTypeDepth;
    if (const auto verdict = fault_of_codec(*codec, is_depth); !verdict) return verdict;
    Stream stream;
    stream.name = *name;
    stream.is_depth = is_depth;
    stream.codec = *codec;
    stream.frames_announced = *frames;
    stream.table_announced = *frames == 0 ? 0 : *table;
    streams_.emplace(record.node, std::move(stream));
    return Done{};
}

OniFinding OniStreams::set(Stream& stream, const OniRecord& record, OniBytes bytes) {
    OniFields fields(bytes);
    const auto name = fields.take_text();
    const auto size = fields.take<std::uint32_t>();
    const auto value = size ? fields.take_bytes(*size) : std::nullopt;
    if (!name || !value || !fields.are_at_end()) return fault("a property with incomplete fields");
    const std::string named(*name);
    const bool is_number =
        record.type == OniRecordType::int_property || record.type == OniRecordType::real_property;
    if (is_number && value->size() != 8) return fault("a number that does not have 8 bytes");
    if (record.type == OniRecordType::string_property && (value->empty() || value->back() != 0))
        return fault("a text without an end");
    if (record.type == OniRecordType::int_property)
        return set_number(stream, named, *OniFields(*value).take<std::uint64_t>());
    return record.type == OniRecordType::general_property ? set_bytes(stream, named, *value)
                                                          : OniFinding(Done{});
}

OniFinding OniStreams::set_number(Stream& stream, const std::string& name, std::uint64_t value) {
    if (name == "oniPixelFormat" || name == "xnPixelFormat") {
        // Before that the player has no mode to change, and uses an uninitialised one.
        if (!stream.size) return fault("a pixel format before the size of the images");
        if (stream.is_depth && name == "oniPixelFormat" && value != kFormatDepthMm)
            return fault("depth that is not in millimetres (pixel format " + text_of(value) + ")");
    }
    if (name == "oniRequiredFrameSize" || name == "RequiredDataSize") {
        if (value > kOniPayloadMax) return fault("frames of " + text_of(value) + " bytes");
        if (stream.frame_bytes.value_or(value) != value) return fault("a second size of frames");
        stream.frame_bytes = value;
    }
    return Done{};
}

OniFinding OniStreams::set_bytes(Stream& stream, const std::string& name, OniBytes bytes) {
    if (name == "xnFOV" && bytes.size() != 16) return fault("a field of view that does not have 16 bytes");
    if (name == "xnCropping" && bytes.size() != 12) return fault("a cropping that does not have 12 bytes");
    if (name == "xnCropping" && stream.is_depth && *OniFields(bytes).take<std::uint32_t>() != 0)
        return fault("a cropped depth stream");
    if (name != "xnMapOutputMode") return Done{};
    if (bytes.size() != 12) return fault("a mode that does not have 12 bytes");
    const auto size = *OniFields(bytes).take<std::array<std::uint32_t, 2>>();
    const auto [width, height] = size;
    if (width == 0 || height == 0 || width > kSideMax || height > kSideMax ||
        FrameSize{width, height}.pixels() > kPixelsMax)
        return fault("images of " + text_of(width) + " x " + text_of(height) + " pixels");
    if (stream.size.value_or(size) != size)
        return fault("images that change their size to " + text_of(width) + " x " + text_of(height));
    stream.size = size;
    return Done{};
}

OniFinding OniStreams::make_ready(Stream& stream) {
    if (stream.state != State::added) return fault("a stream that becomes ready twice");
    if (!stream.size) return fault("a stream without the size of its images");
    const std::uint64_t needed = FrameSize{(*stream.size)[0], (*stream.size)[1]}.pixels() * 2;
    // 0: the player uses the size that the images need.
    if (stream.is_depth && stream.frame_bytes.value_or(0) != 0 && *stream.frame_bytes < needed)
        return fault("frames of " + text_of(*stream.frame_bytes) + " bytes for images of " + text_of(needed));
    stream.state = State::ready;
    return Done{};
}

OniFinding OniStreams::begin(Stream& stream, OniBytes fields) {
    if (stream.state != State::ready || fields.size() != kDataBeginFields)
        return fault("data that begin before the stream is ready, or twice");
    has_begun_ = true;
    stream.state = State::playing;
    return Done{};
}

OniFinding OniStreams::take_frame(Stream& stream, const OniRecord& record, OniBytes bytes,
                                  OniBytes payload) const {
    if (stream.state != State::playing) return fault("a frame before the data begin");
    for (const auto& [node, other] : streams_) {
        if (other.state == State::added) return fault("a frame before stream " + text_of(node) + " is ready");
    }
    if (record.fields_size != kOniFrameFieldsSize) return fault("a frame with other fields");
    // The player refuses such a frame before it skips the payload, and then interprets the payload as
    // records.
    OniFields fields(bytes);
    const std::uint64_t timestamp = *fields.take<std::uint64_t>();
    const std::uint32_t number = *fields.take<std::uint32_t>();
    if (number == 0 || number > stream.frames_announced)
        return fault("frame " + text_of(number) + " of " + text_of(stream.frames_announced));
    if (timestamp > header_.timestamp_max)
        return fault("a frame at " + text_of(timestamp) + " us, after the file's last at " +
                     text_of(header_.timestamp_max));
    stream.frames.push_back(record.position);
    if (!stream.is_depth) return Done{};
    const std::size_t pixels = FrameSize{(*stream.size)[0], (*stream.size)[1]}.pixels();
    const auto is_whole = [&] {
        if (stream.codec == kUncompressed) return payload.size() == pixels * 2;
        return depths_in(payload, stream.codec == kTableDepth ? DepthPacking::with_table
                                                              : DepthPacking::plain) == pixels;
    };
    return is_whole() ? OniFinding(Done{})
                      : fault("a frame that does not contain its " + text_of(pixels) + " pixels");
}

OniFinding OniStreams::take_table(Stream& stream, const OniRecord& record, OniBytes payload) {
    constexpr std::uint64_t kEntrySize = 20;
    // Exactly one, after the stream's end: the player reads the one to which the stream's first record
    // points.
    if (stream.state != State::removed || stream.table != 0)
        return fault("a seek table that does not follow its stream's end");
    if (payload.size() != (std::uint64_t{stream.frames_announced} + 1) * kEntrySize)
        return fault("a seek table that is not for " + text_of(stream.frames_announced) + " frames");
    stream.table = record.position;
    OniFields entries(payload);
    (void)entries.take_bytes(kEntrySize);  // entry 0: frames are numbered from 1
    while (!entries.are_at_end()) {
        (void)entries.take_bytes(kEntrySize - 8);
        const auto place = entries.take<std::uint64_t>();
        if (!place || !std::binary_search(stream.frames.begin(), stream.frames.end(), *place))
            return fault("a seek table with a position without a frame");
    }
    return Done{};
}

OniFinding OniStreams::at_end() const {
    for (const auto& [node, stream] : streams_) {
        if (stream.state != State::removed) return fault("the end, before that of stream " + text_of(node));
        if (stream.table_announced != 0 && stream.table_announced != stream.table)
            return fault("stream " + text_of(node) + " has its seek table elsewhere");
    }
    if (streams_.empty()) return fault("the end, and no stream");
    return Done{};
}

}  // namespace octoskin::openni2
