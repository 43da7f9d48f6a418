// Where the frames of a live camera come from: a helper process that opens a device (helper_frames.hpp), or a
// program that feeds them (fed_frames.hpp).
#pragma once

#include <memory>
#include <string>

#include "common/result.hpp"
#include "host/io/openni2/frame_pipe.hpp"

namespace octoskin {

/// The frames of one opening; its destructor closes it.
class FrameStream {
  public:
    FrameStream() = default;
    virtual ~FrameStream() = default;
    FrameStream(const FrameStream&) = delete;
    FrameStream& operator=(const FrameStream&) = delete;

    /// Of its mode; 0: not known.
    [[nodiscard]] virtual double rate_hz() const = 0;
    [[nodiscard]] virtual openni2::FrameSize size() const = 0;
    /// The next frame; the error is why there is none, for a person: the camera ended, was silent for too
    /// long, or `interrupt` of its opening became readable.
    [[nodiscard]] virtual Result<openni2::PipedFrame, std::string> read() = 0;
    /// `what` with what is known about the stream beside it: why it is closed now.
    [[nodiscard]] virtual std::string reason(const std::string& what) = 0;
};

/// Used by the thread of a CameraFeed alone, except where it says otherwise.
class FrameSource {
  public:
    FrameSource() = default;
    virtual ~FrameSource() = default;
    FrameSource(const FrameSource&) = delete;
    FrameSource& operator=(const FrameSource&) = delete;

    /// Waits for the camera, until it is there, cannot be opened this time, or `interrupt` becomes readable.
    /// The error is why it is not open, for a person.
    [[nodiscard]] virtual Result<std::unique_ptr<FrameStream>, std::string> open(int interrupt) = 0;
    /// Why it is not open before the first opening.
    [[nodiscard]] virtual std::string why_at_first() const = 0;
    /// What a person can do while it is not open; empty: nothing that all such cameras have in common.
    [[nodiscard]] virtual std::string remedy() const = 0;
    /// Images that equal earlier ones are no sign of a fault.
    [[nodiscard]] virtual bool may_repeat() const = 0;
};

}  // namespace octoskin
