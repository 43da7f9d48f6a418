// The streams of an .oni file as its records tell of them, each held against what OpenNI2's player expects.
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
using OniVerdict = Status<std::string>;  ///< else what is wrong, for a person

class OniStreams {
  public:
    struct Header {
        std::uint32_t streams = 0;        ///< as many numbers of streams as the player has room for
        std::uint64_t timestamp_max = 0;  ///< of all frames, as the file header has it
    };
    explicit OniStreams(Header header) : header_(header) {}

    /// The next record with its fields and its payload. A file that has its end has no fault if all of them
    /// had none and at_end() has none either. Asserts nothing: any bytes are safe.
    [[nodiscard]] OniVerdict take(const OniRecord& record, OniBytes fields, OniBytes payload);
    [[nodiscard]] OniVerdict at_end() const;

  private:
    enum class State : std::uint8_t { added, ready, playing, removed };
    struct Stream {
        std::string name;
        State state = State::added;
        bool is_depth = false;
        std::uint32_t codec = 0;
        std::uint32_t frames_announced = 0;
        std::uint64_t table_announced = 0;  ///< 0: there is none
        std::uint64_t table = 0;            ///< where it is
        std::optional<std::array<std::uint32_t, 2>> size;
        std::optional<std::uint64_t> frame_bytes;
        std::vector<std::uint64_t> frames;  ///< where they are
    };

    OniVerdict take_of(Stream& stream, const OniRecord& record, OniBytes fields, OniBytes payload);
    OniVerdict add(const OniRecord& record, OniBytes fields);
    static OniVerdict set(Stream& stream, const OniRecord& record, OniBytes fields);
    static OniVerdict set_number(Stream& stream, const std::string& name, std::uint64_t value);
    static OniVerdict set_bytes(Stream& stream, const std::string& name, OniBytes bytes);
    static OniVerdict make_ready(Stream& stream);
    OniVerdict begin(Stream& stream, OniBytes fields);
    OniVerdict take_frame(Stream& stream, const OniRecord& record, OniBytes fields, OniBytes payload) const;
    static OniVerdict take_table(Stream& stream, const OniRecord& record, OniBytes payload);

    Header header_;
    bool has_begun_ = false;  ///< the data of any stream: the player has opened the file
    std::map<std::uint32_t, Stream> streams_;
};

}  // namespace octoskin::openni2
