#include "tests/bench/planner_rows.hpp"

#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "host/core/mapping/depth_integrator.hpp"
#include "host/core/query/distance_field.hpp"
#include "host/core/query/robot_query.hpp"
#include "tests/bench/arm_capsules.hpp"
#include "tests/bench/clouds.hpp"
#include "tests/bench/sizes.hpp"

namespace octoskin::bench {
namespace {

constexpr std::size_t kFramesOfMap = 10;
/// Half a metre from the thickest capsule of the arm, and what the field loses by its voxels.
constexpr double kReach_m = 0.5;
constexpr double kFieldReach_m = 0.7;

void require_that(bool is_so, const char* what) {
    if (!is_so) throw std::runtime_error(what);
}

/// Where the arm may be.
FieldExtent about_arm(const RoomFrames& room) {
    FieldExtent extent{.region = {}, .reach_m = kFieldReach_m};
    for (const ArmCapsules& capsules : postures_of_arm(OCTOSKIN_RIG, room.T_map_arm))
        for (const PosedCapsule& capsule : capsules) extent.region.extend(capsule.p_a).extend(capsule.p_b);
    return extent;
}
FieldExtent all_of(const FusedMap& map) {
    FieldExtent extent{.region = {}, .reach_m = kFieldReach_m};
    for (const MapBrick& brick : map.bricks())
        extent.region.extend(map.centre_of(key_of_morton(brick.first)));
    return extent;
}

/// How many capsules are told a distance to something occupied, and the sum of these.
struct Told {
    std::size_t occupied = 0;
    double sum_m = 0.0;
    void add(const CapsuleClearance& clearance) {
        occupied += clearance.occupied_m ? 1U : 0U;
        sum_m += clearance.occupied_m.value_or(0.0) + clearance.not_free_m.value_or(0.0);
    }
};

class Clearances final : public Task {
  public:
    Clearances(const RoomFrames& room, const FusedMap& map, bool has_field)
        : map_(map), postures_(postures_of_arm(OCTOSKIN_RIG, room.T_map_arm)) {
        for (const ArmCapsules& capsules : postures_) {
            for (const PosedCapsule& capsule : capsules) {
                const auto found = clearance(map_, capsule, kReach_m);
                require_that(found.has_value(), "a capsule is refused");
                wanted_.add(*found);
            }
        }
        require_that(wanted_.occupied > postures_.size(), "nothing occupied is near the arm");
        if (!has_field) return;
        field_.emplace(map.config(), about_arm(room));
        (void)field_->update(map);
    }
    void run() override {
        Told reported;
        for (const ArmCapsules& capsules : postures_) {
            for (const PosedCapsule& capsule : capsules)
                reported.add(field_ ? *field_->clearance(capsule) : *clearance(map_, capsule, kReach_m));
        }
        require_that(reported.occupied >= wanted_.occupied, "a distance is not told");
    }
    void tell(Figures& figures) const override { tell_size(map_, figures); }

  private:
    const FusedMap& map_;
    std::vector<ArmCapsules> postures_;
    Told wanted_;
    std::optional<DistanceField> field_;
};

/// From the ten frames' map on, one frame after the other.
class FieldUpdate final : public Task {
  public:
    FieldUpdate(const RoomFrames& room, const std::string& resolution, const FusedMap& ten_frames,
                const FieldExtent& extent)
        : room_(room),
          integrator_(bench_mapping(resolution, DepthUpdate::paper), room.camera),
          map_(ten_frames.copy()),
          field_(map_.config(), extent) {
        (void)field_.update(map_);
    }
    void prepare() override {
        const RoomFrame& frame = room_.frames[next_++ % room_.frames.size()];
        const auto result = integrator_.integrate(frame.image, frame.T_map_camera);
        require_that(result.has_value(), "a frame was refused");
        map_.apply(result->terms);
    }
    void run() override { require_that(field_.update(map_).written > 0, "a frame changed nothing"); }
    void tell(Figures& figures) const override {
        tell_size(map_, figures);
        figures.heap_bytes = field_.memory_bytes();
    }

  private:
    const RoomFrames& room_;
    DepthIntegrator integrator_;
    FusedMap map_;
    DistanceField field_;
    std::size_t next_ = kFramesOfMap;
};

}  // namespace

std::vector<Row> planner_rows(const RoomFrames& room, const std::string& resolution, unsigned runs,
                              std::function<const FusedMap&()> ten_frames) {
    std::vector<Row> rows;
    rows.push_back({"clearances", "", runs,
                    [&room, ten_frames] { return std::make_unique<Clearances>(room, ten_frames(), false); }});
    rows.push_back({"field_clearances", "clearances", runs,
                    [&room, ten_frames] { return std::make_unique<Clearances>(room, ten_frames(), true); }});
    rows.push_back({"field_update", "", runs, [&room, resolution, ten_frames] {
                        return std::make_unique<FieldUpdate>(room, resolution, ten_frames(), about_arm(room));
                    }});
    rows.push_back({"field_update_room", "field_update", runs, [&room, resolution, ten_frames] {
                        return std::make_unique<FieldUpdate>(room, resolution, ten_frames(),
                                                             all_of(ten_frames()));
                    }});
    return rows;
}

}  // namespace octoskin::bench
