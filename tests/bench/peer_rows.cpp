#include "tests/bench/peer_rows.hpp"

#include <octomap/octomap.h>

#include <algorithm>

#include "tests/bench/clouds.hpp"
#include "tests/bench/dense_grid.hpp"
#include "tests/bench/frame_task.hpp"
#include "tests/bench/sizes.hpp"

namespace octoskin::bench {
namespace {

class OctomapFrames final : public FrameTask {
  public:
    OctomapFrames(const RoomFrames& room, const std::string& resolution, bool is_lazy)
        : FrameTask(room), tree_(std::stod(resolution)), is_lazy_(is_lazy) {}
    void prepare() override {
        const RoomFrame& frame = next();
        cloud_ = cloud_of(frame, camera());
        origin_ = origin_of(frame);
    }
    void run() override {
        // Lazy evaluation leaves inner nodes to be worked out once: that is part of it.
        tree_.insertPointCloud(cloud_, origin_, kRangeMax_m, is_lazy_, is_lazy_);
        if (is_lazy_) tree_.updateInnerOccupancy();
    }
    void tell(Figures& figures) const override { tell_size(tree_, figures); }

  private:
    octomap::OcTree tree_;
    octomap::Pointcloud cloud_;
    octomap::point3d origin_;
    bool is_lazy_;
};

class DenseGridFrames final : public FrameTask {
  public:
    DenseGridFrames(const RoomFrames& room, const std::string& resolution)
        : FrameTask(room), grid_(box_of(room), static_cast<float>(std::stod(resolution))) {}
    void prepare() override { frame_ = &next(); }
    void run() override { grid_.insert(frame_->image, camera(), frame_->T_map_camera); }
    void tell(Figures& figures) const override {
        figures.heap_bytes = grid_.bytes();
        figures.voxels = grid_.known();
    }

  private:
    /// Just large enough: a user knows the room.
    static Eigen::AlignedBox3f box_of(const RoomFrames& room) {
        Eigen::AlignedBox3f box;
        for (const RoomFrame& frame : room.frames)
            box.extend(DenseGrid::seen(frame.image, room.camera, frame.T_map_camera));
        return box;
    }

    DenseGrid grid_;
    const RoomFrame* frame_ = nullptr;
};

}  // namespace

std::vector<Row> peer_rows(const RoomFrames& room, const std::string& resolution, unsigned runs,
                           unsigned runs_octomap, const std::string& suffix) {
    const std::string peer = kOctomap + suffix;
    const auto octomap = [&](const std::string& name, bool is_lazy) {
        return Row{name + suffix, peer, std::min(runs, runs_octomap), [&room, resolution, is_lazy] {
                       return std::make_unique<OctomapFrames>(room, resolution, is_lazy);
                   }};
    };
    std::vector<Row> rows = {octomap(kOctomap, false)};
    if (room.is_stationary) return rows;
    rows.push_back(octomap("octomap_lazy", true));
    rows.push_back({"dense_grid_nearest_pixel" + suffix, peer, runs,
                    [&room, resolution] { return std::make_unique<DenseGridFrames>(room, resolution); }});
    return rows;
}

}  // namespace octoskin::bench
