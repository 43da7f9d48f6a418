// A reliable wrapper for OpenNI2's recorder on the virtual camera.
#pragma once

#include <OpenNI.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "host/io/openni2/frame_pipe.hpp"

namespace octoskin::openni2 {

/// OpenNI2's recorder writes in a thread of its own. It ignores frames until that thread has begun the file,
/// does not report write errors, and busy-waits without work. So a frame counts only when the file has grown
/// by it, and the recorder is started only when frames are available. Every function returns the error, or an
/// empty text.
class OniRecorder {
  public:
    OniRecorder(std::filesystem::path file, FrameSize size) : file_(std::move(file)), size_(size) {}

    /// Starts OpenNI2 and the virtual camera.
    [[nodiscard]] std::string open();
    /// Starts the file anew, with its first frame if there is one.
    [[nodiscard]] std::string begin(const PipedFrame* first);
    [[nodiscard]] std::string record(const PipedFrame& frame);
    /// Ends the file and checks that it contains all frames.
    [[nodiscard]] std::string finish();

  private:
    [[nodiscard]] std::string start();
    [[nodiscard]] bool push(const PipedFrame& frame, std::chrono::milliseconds patience);

    std::filesystem::path file_;
    FrameSize size_;
    openni::Device device_;
    openni::VideoStream stream_;
    std::unique_ptr<openni::Recorder> recorder_;
    int frames_ = 0;
};

}  // namespace octoskin::openni2
