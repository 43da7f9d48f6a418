// A scenario file: read, or refused with its file and a reason; what is read is within what simulation and
// evaluation can take.
#include <cassert>
#include <cmath>
#include <variant>

#include "hw/sim/scenario/scenario.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/input_file.hpp"

namespace octoskin::sim {
namespace {

class ScenarioInput {
  public:
    ScenarioInput() {
        for (const char* file :
             {"hw/worlds/experiment.sdf", "tests/data/gantry/room.sdf", "tests/data/gantry/scenario.yaml"}) {
            directory_.offer(std::filesystem::path(OCTOSKIN_SOURCE_DIR) / file);
        }
    }
    void check(std::string_view text) const {
        const auto file = directory_.write("input.yaml", text);
        const auto scenario = read_scenario(file);
        if (!scenario) {
            assert(!scenario.error().what.empty() && !scenario.error().file.empty());
            return;
        }
        assert(scenario->world.is_file());
        const CircleMotion& motion = scenario->motion;
        assert(!motion.link.empty() && motion.ticks() > 0 && motion.tick_rate_hz > 0.0);
        assert(motion.start_position.allFinite() && motion.p_base_centre.allFinite());
        assert((motion.R_base_link.transpose() * motion.R_base_link - Eigen::Matrix3d::Identity()).norm() <
               1e-6);
        assert(scenario->ranges.min_m <= scenario->ranges.max_m && scenario->rest_s >= 3.0);
        if (const auto* kinect = std::get_if<KinectNoise>(&scenario->depth_noise.model))
            assert(kinect->flying_share + kinect->missing_share <= 1.0 && kinect->bias_spacing_px > 0);
        assert(scenario->slow_clocks.factor_min <= scenario->slow_clocks.factor_max);
        assert((scenario->region.p_base_min.array() < scenario->region.p_base_max.array()).all());
        for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{7}, ~std::uint64_t{0}}) {
            assert(scenario->map_shift_m(seed).cwiseAbs().maxCoeff() <= 1.0);
        }
        for (const char* key : {"region", "hidden_models", "motion.circle", "motion.circle.link"}) {
            assert(scenario->error(key, {.what = "x"}).line > 0);
        }
    }

  private:
    fuzz::InputDirectory directory_;
};

}  // namespace
}  // namespace octoskin::sim

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const octoskin::sim::ScenarioInput input;
    input.check(octoskin::fuzz::text_of({data, size}));
    return 0;
}
