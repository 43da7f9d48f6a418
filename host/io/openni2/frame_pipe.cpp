#include "host/io/openni2/frame_pipe.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace octoskin::openni2 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::array<char, 4> kMagic{'O', 'S', 'K', 'D'};
constexpr std::uint32_t kVersion = 4;
constexpr std::uint64_t kEnd = ~std::uint64_t{0};
constexpr std::uint64_t kUntimed = kEnd - 1;

struct Header {
    std::array<char, 4> magic = kMagic;
    std::uint32_t version = kVersion;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t is_salvaged = 0;
    std::uint32_t rate_mhz = 0;
};

/// Writes to a socket without blocking and without SIGPIPE, whatever the signal's handler; to any other
/// descriptor as usual.
ssize_t write_some(int descriptor, std::span<const std::byte> bytes) {
    const ssize_t sent = ::send(descriptor, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    return sent < 0 && errno == ENOTSOCK ? ::write(descriptor, bytes.data(), bytes.size()) : sent;
}

}  // namespace

const char* name(PipeError error) noexcept {
    switch (error) {
        case PipeError::timeout:
            return "no data in time";
        case PipeError::closed:
            return "ended in the middle of a frame";
        case PipeError::interrupted:
            return "cancelled";
        case PipeError::wrong_format:
            return "not a stream of depth frames";
        case PipeError::io:
            return "reading or writing failed";
    }
    return "unknown error";
}

Status<PipeError> FramePipe::write_header(const StreamHeader& stream) {
    const Header header{.width = stream.size.width,
                        .height = stream.size.height,
                        .is_salvaged = stream.is_salvaged ? 1U : 0U,
                        .rate_mhz = stream.rate_mhz};
    return write_bytes(std::as_bytes(std::span(&header, 1)));
}

Status<PipeError> FramePipe::write_frame(std::uint64_t timestamp_us,
                                         std::span<const std::uint16_t> depth_mm) {
    if (const auto written = write_bytes(std::as_bytes(std::span(&timestamp_us, 1))); !written)
        return written;
    return write_bytes(std::as_bytes(depth_mm));
}

Status<PipeError> FramePipe::write_untimed_frame() {
    return write_bytes(std::as_bytes(std::span(&kUntimed, 1)));
}

Status<PipeError> FramePipe::write_end() {
    return write_bytes(std::as_bytes(std::span(&kEnd, 1)));
}

Result<StreamHeader, PipeError> FramePipe::read_header() {
    Header header;
    if (const auto read = read_bytes(std::as_writable_bytes(std::span(&header, 1))); !read) {
        return unexpected(read.error());
    }
    const bool is_plausible = header.width > 0 && header.height > 0 && header.width <= kSideMax &&
                              header.height <= kSideMax &&
                              FrameSize{header.width, header.height}.pixels() <= kPixelsMax;
    if (header.magic != kMagic || header.version != kVersion || !is_plausible)
        return unexpected(PipeError::wrong_format);
    return StreamHeader{{header.width, header.height}, header.is_salvaged != 0, header.rate_mhz};
}

Result<std::optional<PipedFrame>, PipeError> FramePipe::read_frame(FrameSize size) {
    PipedFrame frame;
    if (const auto read = read_bytes(std::as_writable_bytes(std::span(&frame.timestamp_us, 1))); !read) {
        return unexpected(read.error());
    }
    if (frame.timestamp_us == kEnd) return std::optional<PipedFrame>{};
    frame.is_timed = frame.timestamp_us != kUntimed;
    if (!frame.is_timed) return std::optional(std::move(frame));
    frame.depth_mm.resize(size.pixels());
    if (const auto read = read_bytes(std::as_writable_bytes(std::span(frame.depth_mm))); !read) {
        return unexpected(read.error());
    }
    return std::optional(std::move(frame));
}

/// What comes while this thread does not run is not late: with `end` in the past, it looks once.
Status<PipeError> FramePipe::wait_for(short events, Clock::time_point end) const {
    std::array<pollfd, 2> waiting{{{descriptor_, events, 0}, {interrupt_, POLLIN, 0}}};
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
        const int ready = ::poll(waiting.data(), waiting.size(),
                                 static_cast<int>(std::max<std::chrono::milliseconds::rep>(left.count(), 0)));
        if (ready > 0 && waiting[1].revents != 0) return unexpected(PipeError::interrupted);
        if (ready > 0) return Done{};
        if (ready == 0) return unexpected(PipeError::timeout);
        if (errno != EINTR) return unexpected(PipeError::io);
    }
}

Status<PipeError> FramePipe::write_bytes(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        if (const auto ready = wait_for(POLLOUT, Clock::now() + patience_); !ready) return ready;
        const ssize_t moved = write_some(descriptor_, bytes);
        if (moved > 0) {
            bytes = bytes.subspan(static_cast<std::size_t>(moved));
        } else if (moved < 0 && errno == EPIPE) {
            return unexpected(PipeError::closed);
        } else if (moved < 0 && errno != EINTR && errno != EAGAIN) {
            return unexpected(PipeError::io);
        }
    }
    return Done{};
}

ssize_t FramePipe::receive(std::span<std::byte> bytes) const {
    if (read_some_ == nullptr) return ::read(descriptor_, bytes.data(), bytes.size());
    return read_some_(descriptor_, {reinterpret_cast<char*>(bytes.data()), bytes.size()});
}

Status<PipeError> FramePipe::read_bytes(std::span<std::byte> bytes) {
    const Clock::time_point end = Clock::now() + patience_;
    while (!bytes.empty()) {
        if (const auto ready = wait_for(POLLIN, end); !ready) return ready;
        const ssize_t moved = receive(bytes);
        if (moved == 0) return unexpected(PipeError::closed);
        if (moved > 0) {
            bytes = bytes.subspan(static_cast<std::size_t>(moved));
        } else if (errno == ECONNRESET) {  // the other end left something unread
            return unexpected(PipeError::closed);
        } else if (errno != EINTR && errno != EAGAIN) {
            return unexpected(PipeError::io);
        }
    }
    return Done{};
}

}  // namespace octoskin::openni2
