// A depth worker that ends when the test says so, and the order in which measurements go into a live map.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/core/pipeline/depth_worker.hpp"
#include "host/core/pipeline/ordered_replay.hpp"

namespace octoskin::test {

/// Works when the test ends it, or when the pipeline waits for it.
class PatientWorker final : public DepthWorker {
  public:
    void begin(std::function<void()> work) override {
        EXPECT_FALSE(work_) << "one at a time";
        work_ = std::move(work);
        is_done_ = false;
        ++begun;
    }
    [[nodiscard]] bool is_done() const override { return is_done_; }
    void finish() override {
        if (!is_done_) ++waits;
        end();
        work_ = nullptr;
    }
    void end() {
        if (!is_done_) work_();
        is_done_ = true;
    }
    [[nodiscard]] bool has_work() const { return work_ && !is_done_; }
    int begun = 0;
    int waits = 0;

  private:
    std::function<void()> work_;
    bool is_done_ = true;
};

/// Keeps what goes into the map of up to two cameras, and gives it to a replay in the same order.
class CommitOrder final : public CommitListener, public CommitSource {
  public:
    void on_joints(const JointMeasurement& joints) override { commits_.emplace_back(joints); }
    void on_reading(const RangeMeasurement& measurement, const Beam&, std::span<const VoxelUpdate>) override {
        commits_.emplace_back(measurement);
    }
    void on_depth(const DepthFrame& frame, const Evidence&) override {
        std::vector<DepthFrame>& frames = frames_.at(frame.camera);
        commits_.emplace_back(DepthCommit{frames.size(), frame.captured, frame.camera});
        frames.push_back(frame);
        cameras_.push_back(frame.camera);
    }
    Result<std::optional<Commit>, Error> next() override {
        return next_ < commits_.size() ? std::optional(commits_[next_++]) : std::nullopt;
    }
    [[nodiscard]] const std::vector<DepthFrame>& frames(std::size_t camera = 0) const {
        return frames_.at(camera);
    }
    /// The camera of each frame, in the map's order.
    [[nodiscard]] const std::vector<std::uint8_t>& cameras() const { return cameras_; }

  private:
    std::vector<Commit> commits_;
    std::array<std::vector<DepthFrame>, 2> frames_;
    std::vector<std::uint8_t> cameras_;
    std::size_t next_ = 0;
};

}  // namespace octoskin::test
