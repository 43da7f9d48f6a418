// Messages as JSON and as the bytes of the wire, by the code that fastddsgen generates from the field lists.
//
// The bytes are CDR with the four bytes of encapsulation before it, as in a DDS sample, in an MCAP file and
// in a message of Foxglove's WebSocket protocol.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace octoskin::ros {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<std::uint8_t>;

/// How much of a sequence of bytes JSON shows: its first ones, or all.
struct Shown {
    bool has_all_bytes = false;
};

struct Decoded {
    Json fields;
    std::size_t unread = 0;  ///< Bytes behind the last field: a newer layout of the message has more fields.
};

/// One message type.
struct Codec {
    std::string name;       ///< "sensor_msgs/Range"
    std::string dds_name;   ///< "sensor_msgs::msg::dds_::Range_"
    std::string type_hash;  ///< "RIHS01_..."

    /// Throws std::exception if the bytes end early, or announce more elements than memory holds.
    Decoded (*decode)(const Bytes& bytes, const Shown& shown);

    /// A field that the JSON lacks is 0 or empty. Throws std::exception for an unknown field or a value that
    /// does not fit, with its place.
    Bytes (*encode)(const Json& fields);
};

/// All types of fields/.
[[nodiscard]] const std::vector<Codec>& codecs();

/// Takes "sensor_msgs/Range", "sensor_msgs/msg/Range" and "sensor_msgs::msg::dds_::Range_". Throws
/// std::invalid_argument for another type.
[[nodiscard]] const Codec& find_codec(const std::string& name);

/// Throws std::runtime_error if it cannot.
[[nodiscard]] Bytes read_file(const std::string& path);

/// As one line of text. Text that is not UTF-8 has the replacement character where it is not.
[[nodiscard]] std::string line(const Json& json);

}  // namespace octoskin::ros
