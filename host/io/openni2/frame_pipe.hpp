// Depth frames through a pipe: the format between octoskin and its helper programs. Only these are linked
// with OpenNI2.
//
//     stream  = "OSKD" version:u32 width:u32 height:u32 is_salvaged:u32 rate_mhz:u32  frame*  end
//     frame   = timestamp_us:u64 pixels:u16[width * height]   of a recording: time since its first
//                                                             frame; of a camera: host's monotonic clock
//             | 0xFFFFFFFFFFFFFFFE                     a frame of a camera with an unknown time
//     end     = 0xFFFFFFFFFFFFFFFF
//
// Native byte order: both ends are on one machine. A stream without `end` was cut off.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"

namespace octoskin::openni2 {

struct FrameSize {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    [[nodiscard]] std::size_t pixels() const noexcept { return static_cast<std::size_t>(width) * height; }
    friend bool operator==(const FrameSize&, const FrameSize&) = default;
};
/// Both ends refuse more: OpenNI2's player has buffers for this many pixels, without a check.
inline constexpr std::uint32_t kSideMax = 4096;
inline constexpr std::size_t kPixelsMax = std::size_t{1600} * 1200;

struct StreamHeader {
    FrameSize size;
    bool is_salvaged = false;  ///< the recording has no end; this stream has its complete frames
    /// Of a camera: rate of its present mode in thousandths of a hertz; 0: unknown, as for a recording.
    std::uint32_t rate_mhz = 0;
};

struct PipedFrame {
    bool is_timed = true;  ///< if false, all other fields are empty
    std::uint64_t timestamp_us = 0;
    std::vector<std::uint16_t> depth_mm;
};

enum class PipeError : std::uint8_t {
    timeout,       ///< no byte was received (or accepted) within the time limit
    closed,        ///< the other end closed in the middle of the stream
    interrupted,   ///< the wait was cancelled
    wrong_format,  ///< not this format, or an impossible size
    io,            ///< read or write failed
};
[[nodiscard]] const char* name(PipeError error) noexcept;

/// A write waits at most `patience` for each room for more bytes. A read waits that long for the header, that
/// long for the time of a frame, and that long for its pixels, however slowly they come. All this if the
/// descriptor is a socket or non-blocking. The caller keeps ownership of the descriptors.
class FramePipe {
  public:
    /// Reads some bytes like read(2).
    using ReadSome = ssize_t (*)(int descriptor, std::span<char> bytes);

    /// `interrupt`: when this descriptor becomes readable, calls stop waiting; -1: none. `read_some`: in
    /// place of read(2), if the other end is not trusted.
    FramePipe(int descriptor, std::chrono::milliseconds patience, int interrupt = -1,
              ReadSome read_some = nullptr)
        : descriptor_(descriptor), patience_(patience), interrupt_(interrupt), read_some_(read_some) {}

    [[nodiscard]] Status<PipeError> write_header(const StreamHeader& header);
    [[nodiscard]] Status<PipeError> write_frame(std::uint64_t timestamp_us,
                                                std::span<const std::uint16_t> depth_mm);
    [[nodiscard]] Status<PipeError> write_untimed_frame();
    [[nodiscard]] Status<PipeError> write_end();

    [[nodiscard]] Result<StreamHeader, PipeError> read_header();
    /// The next frame; empty at the regular end.
    [[nodiscard]] Result<std::optional<PipedFrame>, PipeError> read_frame(FrameSize size);

  private:
    [[nodiscard]] Status<PipeError> write_bytes(std::span<const std::byte> bytes);
    [[nodiscard]] Status<PipeError> read_bytes(std::span<std::byte> bytes);
    [[nodiscard]] ssize_t receive(std::span<std::byte> bytes) const;
    [[nodiscard]] Status<PipeError> wait_for(short events, std::chrono::steady_clock::time_point end) const;

    int descriptor_;
    std::chrono::milliseconds patience_;
    int interrupt_;
    ReadSome read_some_;
};

}  // namespace octoskin::openni2
