// The streams of an .oni file, built from its records, each checked against what OpenNI2's player expects.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/io/openni2/helpers/oni_records.hpp"

namespace octoskin::openni2 {

using OniBytes = std::span<const std::uint8_t>;
using OniFinding = Status<std::string>;  ///< the error is the fault, for the user

class OniStreams {
  public:
    struct Header {
        std::uint32_t streams = 0;        ///< the player has room for this many stream numbers
        std::uint64_t timestamp_max = 0;  ///< of all frames, from the file header
    };
    explicit OniStreams(Header header) : header_(header) {}

    /// The next record with its fields and its payload. A file with an end is sound if no record has a fault
    /// and at_end() has none. No assertions: safe for any bytes.
    [[nodiscard]] OniFinding take(const OniRecord& record, OniBytes fields, OniBytes payload);
    [[nodiscard]] OniFinding at_end() const;

  private:
    enum class State : std::uint8_t { added, ready, playing, removed };
    struct Stream {
        std::string name;
        State state = State::added;
        bool is_depth = false;
        std::uint32_t codec = 0;
        std::uint32_t frames_announced = 0;
        std::uint64_t table_announced = 0;  ///< 0: there is none
        std::uint64_t table = 0;            ///< its position
        std::optional<std::array<std::uint32_t, 2>> size;
        std::optional<std::uint64_t> frame_bytes;
        std::vector<std::uint64_t> frames;  ///< their positions
    };

    OniFinding take_of(Stream& stream, const OniRecord& record, OniBytes fields, OniBytes payload);
    OniFinding add(const OniRecord& record, OniBytes fields);
    static OniFinding set(Stream& stream, const OniRecord& record, OniBytes fields);
    static OniFinding set_number(Stream& stream, const std::string& name, std::uint64_t value);
    static OniFinding set_bytes(Stream& stream, const std::string& name, OniBytes bytes);
    static OniFinding make_ready(Stream& stream);
    OniFinding begin(Stream& stream, OniBytes fields);
    OniFinding take_frame(Stream& stream, const OniRecord& record, OniBytes fields, OniBytes payload) const;
    static OniFinding take_table(Stream& stream, const OniRecord& record, OniBytes payload);

    Header header_;
    bool has_begun_ = false;  ///< data of any stream have begun: the player has opened the file
    std::map<std::uint32_t, Stream> streams_;
};

}  // namespace octoskin::openni2
