#include "host/lab/depth_study/hand_study.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <set>

#include "host/lab/depth_study/depth_mapper.hpp"
#include "host/lab/depth_study/noisy_camera.hpp"
#include "host/lab/evaluation/clean_view.hpp"
#include "hw/sim/world/shapes.hpp"

namespace octoskin::depth_study {
namespace {

constexpr double kSide_m = 0.08;
constexpr double kThickness_m = 0.03;
constexpr double kFarthest_m = 2.45;
constexpr double kNearest_m = 2.05;
constexpr double kPath_m = kFarthest_m - kNearest_m;
constexpr double kEmpty_s = 1.0;
constexpr double kRests_s = 2.0;
constexpr double kMoves_s = 3.0;
constexpr double kLeaves_s = 5.0;
constexpr std::uint32_t kSkipped = 4;  ///< frames of the motion that are not judged
constexpr double kAppeared = 0.9;
/// Beside the path, so that the hand's surroundings are in the image.
constexpr double kMargin_m = 0.15;

struct HandMotion {
    HandPath path = HandPath::towards;
    double speed_m_per_s = 0.0;

    [[nodiscard]] double duration_s() const { return std::min(kMoves_s, kPath_m / speed_m_per_s); }
    /// Middle of the hand's front, in camera coordinates.
    [[nodiscard]] Eigen::Vector3d p_camera_front(double moved_s) const {
        const double moved_m = speed_m_per_s * moved_s;
        if (path == HandPath::towards) return {0.0, 0.0, kFarthest_m - moved_m};
        const double start_m = -speed_m_per_s * duration_s() / 2.0;
        return {start_m + moved_m, 0.0, (kFarthest_m + kNearest_m) / 2.0};
    }
};

sim::Solid hand_solid(const Eigen::Isometry3d& T_base_camera, const Eigen::Vector3d& p_camera_front) {
    const Eigen::Vector3d centre = p_camera_front + Eigen::Vector3d(0.0, 0.0, kThickness_m / 2.0);
    const Eigen::Isometry3d T_base_hand = T_base_camera * Eigen::Translation3d(centre);
    const auto mesh = sim::transformed(sim::box_mesh({kSide_m, kSide_m, kThickness_m}), T_base_hand);
    return {"hand/link/visual", "hand", mesh.vertices, mesh.triangles, true};
}

/// The part of the image that shows all paths.
rig::Camera round_paths(const rig::Camera& camera) {
    const double reach_m = (kPath_m + kSide_m) / 2.0 + kMargin_m;
    const double height_m = kSide_m / 2.0 + kMargin_m;
    const auto begin = [](double centre, double half) {
        return static_cast<std::uint32_t>(std::max(0.0, std::floor(centre - half)));
    };
    const auto end = [](double centre, double half, std::uint32_t size) {
        return std::min(size, static_cast<std::uint32_t>(std::ceil(centre + half)));
    };
    const double half_u = camera.fx * reach_m / kNearest_m;
    const double half_v = camera.fy * height_m / kNearest_m;
    const std::uint32_t u = begin(camera.cx, half_u);
    const std::uint32_t v = begin(camera.cy, half_v);
    rig::Camera part = camera;
    assert(u < end(camera.cx, half_u, camera.width) && v < end(camera.cy, half_v, camera.height));
    part.width = end(camera.cx, half_u, camera.width) - u;
    part.height = end(camera.cy, half_v, camera.height) - v;
    part.cx -= u;
    part.cy -= v;
    return part;
}

std::vector<sim::Solid> without_hand(const sim::World& world) {
    std::vector<sim::Solid> solids;
    std::ranges::copy_if(world.solids(), std::back_inserter(solids),
                         [](const sim::Solid& solid) { return solid.model != "hand"; });
    return solids;
}

using Voxels = std::set<VoxelKey>;

/// One motion of the hand, mapped by all contenders.
class HandRun {
  public:
    HandRun(const DepthCase& of, const rig::Camera& camera, const HandMotion& motion)
        : of_(of),
          camera_(camera),
          motion_(motion),
          lattice_(of.contenders.front().mapping.map.resolution_m),
          background_(without_hand(of.world)),
          empty_(background_) {
        for (const Contender& contender : of.contenders) {
            mappers_.emplace_back(camera, of.T_map_base, contender.mapping);
            figures_.push_back({.subject = subject_of(of, contender),
                                .path = motion.path,
                                .speed_m_per_s = motion.speed_m_per_s});
        }
        of_background_ = seen_of(empty_, [](std::uint32_t) { return true; });
    }

    Result<std::vector<HandFigures>, AppError> run() {
        if (auto done = show_empty(); !done) return unexpected(done.error());
        if (auto done = rest(); !done) return unexpected(done.error());
        if (auto done = move(); !done) return unexpected(done.error());
        if (auto done = leave(); !done) return unexpected(done.error());
        return std::move(figures_);
    }

  private:
    [[nodiscard]] std::uint32_t frames_in(double duration_s) const {
        return frame_at(duration_s, camera_.rate_hz);
    }

    Status<AppError> show(const NoisyCamera& camera) {
        const DepthFrame frame = camera.frame(next_++);
        for (DepthMapper& mapper : mappers_)
            if (auto taken = mapper.take(frame); !taken) return taken;
        return Done{};
    }

    template <class Chosen>
    [[nodiscard]] Voxels seen_of(const sim::World& world, const Chosen& is_chosen) const {
        Voxels voxels;
        const evaluation::CleanView view(world, camera_);
        for (const evaluation::ViewPoint& point : view.points()) {
            if (!is_chosen(point.solid)) continue;
            if (const auto key = lattice_.key_of(of_.T_map_base * point.p_base)) voxels.insert(*key);
        }
        return voxels;
    }

    [[nodiscard]] sim::World with_hand(double moved_s) const {
        std::vector<sim::Solid> solids = background_;
        solids.push_back(hand_solid(camera_.T_link_camera, motion_.p_camera_front(moved_s)));
        return sim::World(std::move(solids));
    }

    /// Also counts them among those that the hand ever had.
    Voxels hand_voxels(const sim::World& world) {
        const std::size_t hand = background_.size();
        Voxels voxels = seen_of(world, [=](std::uint32_t solid) { return solid == hand; });
        ever_.insert(voxels.begin(), voxels.end());
        return voxels;
    }

    [[nodiscard]] std::uint64_t count(const FusedMap& map, const Voxels& voxels, Occupancy state) const {
        return static_cast<std::uint64_t>(
            std::ranges::count_if(voxels, [&](VoxelKey key) { return map.occupancy(key) == state; }));
    }

    Status<AppError> show_empty() {
        const NoisyCamera camera(empty_, camera_, of_.noise.noise, of_.seed);
        for (std::uint32_t i = 0; i < frames_in(kEmpty_s); ++i)
            if (auto shown = show(camera); !shown) return shown;
        return Done{};
    }

    Status<AppError> rest() {
        const sim::World world = with_hand(0.0);
        const Voxels voxels = hand_voxels(world);
        const NoisyCamera camera(world, camera_, of_.noise.noise, of_.seed);
        for (std::uint32_t i = 0; i < frames_in(kRests_s); ++i) {
            if (auto shown = show(camera); !shown) return shown;
            for (std::size_t k = 0; k < mappers_.size(); ++k) {
                const auto occupied = count(mappers_[k].map(), voxels, Occupancy::occupied);
                if (figures_[k].appears_s ||
                    static_cast<double>(occupied) < kAppeared * static_cast<double>(voxels.size()))
                    continue;
                figures_[k].appears_s = i / camera_.rate_hz;
            }
        }
        return Done{};
    }

    Status<AppError> move() {
        const std::uint32_t frames = frames_in(motion_.duration_s());
        for (std::uint32_t i = 0; i < frames; ++i) {
            const sim::World world = with_hand((i + 1) / camera_.rate_hz);
            const Voxels voxels = hand_voxels(world);
            if (auto shown = show(NoisyCamera(world, camera_, of_.noise.noise, of_.seed)); !shown)
                return shown;
            if (i < kSkipped) continue;
            for (std::size_t k = 0; k < mappers_.size(); ++k) {
                figures_[k].voxels += voxels.size();
                figures_[k].occupied += count(mappers_[k].map(), voxels, Occupancy::occupied);
                figures_[k].free += count(mappers_[k].map(), voxels, Occupancy::free);
            }
        }
        return Done{};
    }

    Status<AppError> leave() {
        Voxels left;
        std::ranges::set_difference(ever_, of_background_, std::inserter(left, left.end()));
        const NoisyCamera camera(empty_, camera_, of_.noise.noise, of_.seed);
        for (std::uint32_t i = 0; i < frames_in(kLeaves_s); ++i) {
            if (auto shown = show(camera); !shown) return shown;
            for (std::size_t k = 0; k < mappers_.size(); ++k) {
                if (figures_[k].leaves_s || count(mappers_[k].map(), left, Occupancy::occupied) > 0) continue;
                figures_[k].leaves_s = i / camera_.rate_hz;
            }
            if (std::ranges::all_of(figures_, [](const auto& of) { return of.leaves_s.has_value(); })) break;
        }
        return Done{};
    }

    const DepthCase& of_;
    const rig::Camera& camera_;
    HandMotion motion_;
    VoxelLattice lattice_;
    std::vector<sim::Solid> background_;
    sim::World empty_;
    Voxels of_background_;  ///< seen in the empty world
    Voxels ever_;           ///< that the hand had
    std::vector<DepthMapper> mappers_;
    std::vector<HandFigures> figures_;
    std::uint32_t next_ = 0;  ///< index of the next frame
};

}  // namespace

std::string_view name_of(HandPath path) noexcept {
    return path == HandPath::towards ? "towards" : "sideways";
}

Result<std::vector<HandFigures>, AppError> study_hand(const DepthCase& of) {
    const rig::Camera camera = round_paths(of.camera);
    std::vector<HandFigures> all;
    for (const HandPath path : {HandPath::towards, HandPath::sideways}) {
        for (const double speed_m_per_s : kHandSpeeds_m_per_s) {
            auto figures = HandRun(of, camera, {path, speed_m_per_s}).run();
            if (!figures) return unexpected(figures.error());
            std::ranges::move(*figures, std::back_inserter(all));
        }
    }
    return all;
}

}  // namespace octoskin::depth_study
