// Depth frames through a pipe: the format between octoskin and the two helper programs that alone are linked
// with OpenNI2.
//
//     stream  = "OSKD" version:u32 width:u32 height:u32 is_salvaged:u32 rate_mhz:u32  frame*  end
//     frame   = timestamp_us:u64 pixels:u16[width * height]   timestamps of a recording relative to its first
//                                                             frame; of a camera, the host's monotonic clock
//             | 0xFFFFFFFFFFFFFFFE                     one of a camera, whose time is not known
//     end     = 0xFFFFFFFFFFFFFFFF
//
// Native byte order: both ends are on one machine. A stream that stops without `end` was cut off.
#pragma once

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
};
/// Both ends refuse more: OpenNI2's player has buffers for so many pixels and does not check.
inline constexpr std::uint32_t kSideMax = 4096;
inline constexpr std::size_t kPixelsMax = std::size_t{1600} * 1200;

struct StreamHeader {
    FrameSize size;
    bool is_salvaged = false;  ///< the recording has no end: these are its whole frames
    /// A camera's, of the mode that it is in, in thousandths of a hertz; 0: not told, as of a recording.
    std::uint32_t rate_mhz = 0;
};

struct PipedFrame {
    bool is_timed = true;  ///< else nothing of the rest is there
    std::uint64_t timestamp_us = 0;
    std::vector<std::uint16_t> depth_mm;
};

enum class PipeError : std::uint8_t {
    timeout,       ///< nothing came (or nothing was taken) for as long as the deadline allows
    closed,        ///< the other end went away in mid-stream
    interrupted,   ///< whoever waits was told to end
    wrong_format,  ///< not this format, or an impossible size
    io,            ///< read or write failed
};
[[nodiscard]] const char* name(PipeError error) noexcept;

/// Every call waits at most `patience` for the next byte to move, if the descriptor is a socket or does not
/// block. The descriptors stay the caller's.
class FramePipe {
  public:
    /// `interrupt`: once this one is readable, no call waits any longer; -1: none.
    FramePipe(int descriptor, std::chrono::milliseconds patience, int interrupt = -1)
        : descriptor_(descriptor), patience_(patience), interrupt_(interrupt) {}

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
    [[nodiscard]] Status<PipeError> wait_for(short events) const;

    int descriptor_;
    std::chrono::milliseconds patience_;
    int interrupt_;
};

}  // namespace octoskin::openni2
