#include "tests/bench/frame_rows.hpp"

#include <array>
#include <stdexcept>

#include "host/core/depth/depth_filter.hpp"
#include "host/core/mapping/depth_integrator.hpp"
#include "tests/bench/clouds.hpp"
#include "tests/bench/frame_task.hpp"
#include "tests/bench/peer_rows.hpp"
#include "tests/bench/sizes.hpp"

namespace octoskin::bench {
namespace {

/// One row for each. An integrator that is meant for filtered images gets them; the filter has its own row.
struct OurMethod {
    const char* name;
    DepthUpdate update;
    bool is_filtered;
    unsigned threads = 1;
    /// The camera is moved to the nearest corner of voxels, where three faces meet: the hardest place for
    /// rays.
    bool is_on_face = false;
    /// The map is told the frames' times, ten of them a second, and keeps those of its voxels.
    bool is_dated = false;
};
constexpr std::array kOurs = {
    OurMethod{.name = "exact", .update = DepthUpdate::paper, .is_filtered = false},
    OurMethod{.name = "fast", .update = DepthUpdate::fast, .is_filtered = true},
    OurMethod{.name = "robust", .update = DepthUpdate::robust, .is_filtered = true},
    OurMethod{
        .name = "exact_on_face", .update = DepthUpdate::paper, .is_filtered = false, .is_on_face = true},
    OurMethod{.name = "fast_on_face", .update = DepthUpdate::fast, .is_filtered = true, .is_on_face = true},
};

/// By the clock: what several threads gain.
constexpr const char* kOneThread = "fast_1_thread";
/// The same by the processor's time: what the voxels' times cost.
constexpr const char* kUndated = "fast";
constexpr OurMethod kDated{
    .name = "fast_dated", .update = DepthUpdate::fast, .is_filtered = true, .is_dated = true};
constexpr std::array kTogether = {
    OurMethod{.name = kOneThread, .update = DepthUpdate::fast, .is_filtered = true},
    OurMethod{.name = "fast_2_threads", .update = DepthUpdate::fast, .is_filtered = true, .threads = 2},
};

class OurFrames final : public FrameTask {
  public:
    OurFrames(const RoomFrames& room, const std::string& resolution, const OurMethod& method)
        : FrameTask(room),
          config_(bench_mapping(resolution, method.update)),
          integrator_(config_, room.camera, method.threads),
          map_(config_.map),
          is_filtered_(method.is_filtered),
          is_on_face_(method.is_on_face),
          is_dated_(method.is_dated) {}
    void prepare() override {
        const RoomFrame& frame = next();
        image_ = frame.image;
        if (is_filtered_) DepthFilter(config_.depth_filter).filter(image_);
        T_map_camera_ = frame.T_map_camera;
        if (!is_on_face_) return;
        const double edge_m = config_.map.resolution_m;
        T_map_camera_.translation() =
            edge_m * (T_map_camera_.translation() / edge_m).array().round().matrix();
    }
    void run() override {
        const auto result = integrator_.integrate(image_, T_map_camera_);
        if (!result) throw std::runtime_error("a frame was refused");
        if (is_dated_) map_.advance_time(HostTime{frames_++ * 100'000'000});
        map_.apply(result->terms);
    }
    void tell(Figures& figures) const override {
        // A map without room for all would be quick for the wrong reason.
        if (map_.counters().no_room + map_.counters().no_memory > 0)
            throw std::runtime_error("a map is full");
        tell_size(map_, figures);
    }

  private:
    MappingConfig config_;
    DepthIntegrator integrator_;
    FusedMap map_;
    bool is_filtered_;
    bool is_on_face_;
    bool is_dated_;
    std::int64_t frames_ = 0;
    DepthImage image_;
    Eigen::Isometry3d T_map_camera_ = Eigen::Isometry3d::Identity();
};

class FilterFrames final : public FrameTask {
  public:
    using FrameTask::FrameTask;
    void prepare() override { image_ = next().image; }
    void run() override { filter_.filter(image_); }

  private:
    DepthFilter filter_{robust_mapping().depth_filter};
    DepthImage image_;
};

}  // namespace

std::vector<Row> frame_rows(const RoomFrames& room, const std::string& resolution, unsigned runs,
                            const std::string& suffix) {
    const std::string peer = kOctomap + suffix;
    std::vector<Row> rows;
    for (const OurMethod& method : kOurs) {
        rows.push_back({method.name + suffix, peer, runs, [&room, resolution, method] {
                            return std::make_unique<OurFrames>(room, resolution, method);
                        }});
    }
    rows.push_back({std::string(kDated.name) + suffix, kUndated + suffix, runs,
                    [&room, resolution] { return std::make_unique<OurFrames>(room, resolution, kDated); }});
    for (const OurMethod& method : kTogether) {
        rows.push_back(
            {method.name + suffix, kOneThread + suffix, runs,
             [&room, resolution, method] { return std::make_unique<OurFrames>(room, resolution, method); },
             true});
    }
    rows.push_back(
        {"depth_filter" + suffix, "", runs, [&room] { return std::make_unique<FilterFrames>(room); }});
    return rows;
}

}  // namespace octoskin::bench
