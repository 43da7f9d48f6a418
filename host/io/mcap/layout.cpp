#include "host/io/mcap/layout.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "host/io/mapfile/file_checksum.hpp"
#include "host/io/mcap/types.hpp"

namespace octoskin::mcap {
namespace {

/// A run of records outside chunks ends at this size, so that one of them in memory is no more than a chunk.
constexpr std::uint64_t kRunBytes = std::uint64_t{1} << 20U;
/// The head of a record and the longest beginning that is looked at: of a message.
constexpr std::size_t kPeekBytes = kRecordHeadBytes + MessageHead::kBytes;

Unexpected<Error> system_fault(const OpenFile& file, int error) {
    const char* const why = error == 0 ? "became shorter while it was read" : std::strerror(error);
    return unexpected(in_file({ErrorCode::system_error, why}, file.shown()));
}

/// Up to `count` bytes: fewer at the end of the file.
Result<std::size_t, Error> read_some(const OpenFile& file, std::uint64_t at, char* to, std::size_t count) {
    std::size_t got = 0;
    while (got < count) {
        const ssize_t more = ::pread(file.descriptor(), to + got, count - got, static_cast<off_t>(at + got));
        if (more < 0 && errno == EINTR) continue;
        if (more < 0) return system_fault(file, errno);
        if (more == 0) break;
        got += static_cast<std::size_t>(more);
    }
    return got;
}

bool is_of_run(Op op) {
    return op == Op::message || op == Op::schema || op == Op::channel;
}

/// Goes from record to record.
class Survey {
  public:
    Survey(const OpenFile& file, std::uint64_t size) : file_(file), size_(size) {}

    Result<Layout, Error> run() {
        layout_.is_cut = true;  // until there is a footer
        layout_.end = at_;
        while (!is_over_) {
            if (const auto taken = take_record(); !taken) return unexpected(taken.error());
        }
        return std::move(layout_);
    }

  private:
    Status<Error> take_record() {
        std::array<char, kPeekBytes> bytes{};
        const auto got = read_some(file_, at_, bytes.data(), bytes.size());
        if (!got) return unexpected(got.error());
        FieldReader reader(std::string_view(bytes.data(), *got));
        const Op op{reader.get<std::uint8_t>()};
        const auto length = reader.get<std::uint64_t>();
        // The file may have grown since its size was taken.
        const bool has_head = reader.is_sound() && at_ + kRecordHeadBytes <= size_;
        const bool is_whole = has_head && op != Op{0} && length <= size_ - at_ - kRecordHeadBytes;
        is_over_ = !is_whole || op == Op::footer;
        if (!is_whole) return Done{};
        if (auto taken = take(op, length, reader); !taken) return taken;
        at_ += kRecordHeadBytes + length;
        layout_.end = at_;
        return Done{};
    }

    Status<Error> take(Op op, std::uint64_t length, FieldReader reader) {
        const bool is_read_whole = op == Op::chunk || is_of_run(op) || op == Op::data_end;
        if (is_read_whole && length > kRecordBytesMax) {
            ++layout_.oversized;
            is_in_run_ = false;
            return Done{};
        }
        if (op == Op::footer) layout_.is_cut = false;
        if (op == Op::data_end) return take_data_end(length);
        if (is_in_summary_ && is_of_run(op)) return take_type(op, length);
        if (!is_in_summary_ && is_of_run(op)) return take_in_run(op, length, reader);
        is_in_run_ = false;
        if (!is_in_summary_ && op == Op::chunk) return take_chunk(length, reader);
        return Done{};
    }

    Status<Error> add(const Stretch& stretch) {
        if (layout_.stretches.size() >= kStretchesMax)
            return unexpected(in_file({.code = ErrorCode::limit_exceeded,
                                       .what = fmt::format("expected at most {} chunks", kStretchesMax),
                                       .remedy = "split the file"},
                                      file_.shown()));
        layout_.stretches.push_back(stretch);
        return Done{};
    }

    Status<Error> take_chunk(std::uint64_t length, FieldReader& reader) {
        return add({.at = at_,
                    .bytes = kRecordHeadBytes + length,
                    .is_chunk = true,
                    .has_messages = true,
                    .first = get_time(reader)});
    }

    Status<Error> take_in_run(Op op, std::uint64_t length, FieldReader& reader) {
        const std::uint64_t bytes = kRecordHeadBytes + length;
        const bool has_room = is_in_run_ && layout_.stretches.back().bytes + bytes <= kRunBytes;
        if (!has_room) {
            if (auto added = add({.at = at_}); !added) return added;
            is_in_run_ = true;
        }
        Stretch& run = layout_.stretches.back();
        run.bytes += bytes;
        if (op != Op::message) return Done{};
        const WallTime logged = get_message_head(reader).logged;
        run.first = run.has_messages ? std::min(run.first, logged) : logged;
        run.has_messages = true;
        return Done{};
    }

    Status<Error> take_data_end(std::uint64_t length) {
        is_in_summary_ = true;
        const auto fields = read_at(file_, at_ + kRecordHeadBytes, length);
        if (!fields) return unexpected(fields.error());
        const auto crc = FieldReader(*fields).get<std::uint32_t>();
        if (crc != 0) layout_.crc = crc;
        layout_.crc_until = at_;
        return Done{};
    }

    Status<Error> take_type(Op op, std::uint64_t length) {
        type_bytes_ += length;
        if (type_bytes_ > kTypesBytesMax) return Done{};
        const auto fields = read_at(file_, at_ + kRecordHeadBytes, length);
        if (!fields) return unexpected(fields.error());
        if (op == Op::schema) {
            if (auto schema = parse_schema(*fields)) layout_.schemas.insert(std::move(*schema));
        } else if (op == Op::channel) {
            if (auto channel = parse_channel(*fields)) layout_.channels.insert(std::move(*channel));
        }
        return Done{};
    }

    const OpenFile& file_;
    std::uint64_t size_;
    std::uint64_t at_ = kMagic.size();
    Layout layout_;
    bool is_over_ = false;
    bool is_in_summary_ = false;
    bool is_in_run_ = false;
    std::uint64_t type_bytes_ = 0;
};

}  // namespace

Result<std::string, Error> read_at(const OpenFile& file, std::uint64_t at, std::uint64_t count) {
    std::string bytes(static_cast<std::size_t>(count), '\0');
    const auto got = read_some(file, at, bytes.data(), bytes.size());
    if (!got) return unexpected(got.error());
    if (*got != bytes.size()) return system_fault(file, 0);
    return bytes;
}

Result<Layout, Error> survey(const OpenFile& file) {
    struct stat status {};
    if (::fstat(file.descriptor(), &status) != 0) return system_fault(file, errno);
    const auto size = static_cast<std::uint64_t>(status.st_size);
    std::array<char, kMagic.size()> magic{};
    const auto got = read_some(file, 0, magic.data(), magic.size());
    if (!got) return unexpected(got.error());
    if (std::string_view(magic.data(), *got) != kMagic)
        return unexpected(in_file({.code = ErrorCode::foreign_format,
                                   .what = "is not an MCAP file: it does not begin like one",
                                   .remedy = "convert another bag with `ros2 bag convert`"},
                                  file.shown()));
    return Survey(file, size).run();
}

Result<bool, Error> has_right_crc(const OpenFile& file, const Layout& layout) {
    if (!layout.crc) return true;
    constexpr std::uint64_t kPiece = std::uint64_t{1} << 20U;
    std::uint32_t crc = 0;
    for (std::uint64_t at = 0; at < layout.crc_until; at += kPiece) {
        const auto bytes = read_at(file, at, std::min(kPiece, layout.crc_until - at));
        if (!bytes) return unexpected(bytes.error());
        crc = file_checksum(*bytes, crc);
    }
    return crc == *layout.crc;
}

}  // namespace octoskin::mcap
