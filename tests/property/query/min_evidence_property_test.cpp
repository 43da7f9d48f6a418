// A larger minimum of evidence never makes a query free: random maps of images and ranges, the experiment's
// arm, with and without its own space.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "host/apps/query/query_answer.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin::property {
namespace {

HostSetup setup() {
    const auto rig =
        rig::read_rig(std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/rigs/experiment_zones.yaml");
    EXPECT_TRUE(rig) << rig.error().message();
    return make_host_setup(*rig).value();
}

class MinEvidenceProperty : public testing::Test {
  protected:
    double within(double min, double max) { return std::uniform_real_distribution(min, max)(random_); }

    /// Free with random evidence as far as the arm reaches, and a little of it stale, unknown or occupied.
    FusedMap random_map() {
        MappingConfig mapping = denoised_mapping();
        mapping.map.resolution_m = 0.08;
        FusedMap map(mapping.map);
        std::vector<VoxelUpdate> image;
        ConeVoxels cone;
        const double weak_share = within(0.0, 0.02);
        map.advance_time({1'000'000'000});
        for (double x = -1.2; x < 1.2; x += 0.08)
            for (double y = -1.2; y < 1.2; y += 0.08)
                for (double z = -0.4; z < 1.4; z += 0.08)
                    image.push_back({*map.key_of({x + 0.04, y + 0.04, z + 0.04}), -0.4F});
        const int images = static_cast<int>(within(1.0, 5.99));
        for (int i = 0; i < images; ++i) feed(map, image, SensorKind::camera);
        std::vector<VoxelUpdate> changed;
        for (const VoxelUpdate& of : image) {
            if (within(0.0, 1.0) < 0.3) cone.passed.push_back(of.key);
            if (within(0.0, 1.0) < weak_share)
                changed.push_back({of.key, static_cast<float>(within(0.0, 1.9))});
        }
        for (int i = 0; i < 3; ++i) feed(map, cone, mapping.zone);
        feed(map, changed, SensorKind::range);
        return map;
    }

    std::vector<double> posture() {
        std::vector<double> position;
        for (const JointLimits& limit : setup_.robot.limits())
            position.push_back(within(limit.min, limit.max));
        return position;
    }

    [[nodiscard]] bool is_free(QueryRequest request, double min_evidence, const FusedMap& map,
                               const std::vector<double>& present) const {
        request.min_evidence = min_evidence;
        const auto answer = answer_query(request, {&setup_.rig, &setup_.robot, map.copy(), present});
        EXPECT_TRUE(answer.at("ok").get<bool>()) << answer;
        return answer.at("state") == "free";
    }

    HostSetup setup_ = setup();
    std::mt19937_64 random_{21};
};

TEST_F(MinEvidenceProperty, a_larger_minimum_never_makes_a_query_free) {
    const std::vector<double> minima{0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 100.0};
    std::size_t free = 0;
    std::size_t not_free = 0;
    for (unsigned round = 0; round < testing_support::cases(40); ++round) {
        const FusedMap map = random_map();
        QueryRequest request;
        const auto present = posture();
        request.path = {posture()};
        request.reach_m = 0.0;
        if (round % 2 == 1) request.own_space_m = 0.1;
        bool was_free = true;
        for (const double minimum : minima) {
            const bool now = is_free(request, minimum, map, present);
            EXPECT_TRUE(was_free || !now) << "round " << round << ", minimum " << minimum;
            was_free = was_free && now;
            (now ? free : not_free) += 1;
        }
        EXPECT_FALSE(was_free) << "no voxel has a hundred measurements";
    }
    EXPECT_GT(free, 8U);
    EXPECT_GT(not_free, 8U);
}

}  // namespace
}  // namespace octoskin::property
