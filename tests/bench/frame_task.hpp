// A row of one depth frame a run.
#pragma once

#include "tests/bench/room_frames.hpp"
#include "tests/bench/task.hpp"

namespace octoskin::bench {

/// One frame after the other, then the first again.
class FrameTask : public Task {
  public:
    explicit FrameTask(const RoomFrames& room) : room_(room) {}

  protected:
    [[nodiscard]] const RoomFrame& next() { return room_.frames[next_++ % room_.frames.size()]; }
    [[nodiscard]] const RoomFrames& room() const { return room_; }
    [[nodiscard]] const CameraIntrinsics& camera() const { return room_.camera; }

  private:
    const RoomFrames& room_;
    std::size_t next_ = 0;
};

}  // namespace octoskin::bench
