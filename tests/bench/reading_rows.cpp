#include "tests/bench/reading_rows.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>
#include <utility>

#include "host/core/pipeline/map_builder.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/bench/clouds.hpp"
#include "tests/bench/sizes.hpp"

namespace octoskin::bench {
namespace {

constexpr const char* kRays = "readings_ray";

struct Sensors {
    const char* name;
    const char* rig;
    RangeUpdate update;
    bool is_stationary;
};
constexpr std::array kSensors = {
    Sensors{kRays, "experiment_cone.yaml", RangeUpdate::ray, false},
    Sensors{"readings_cone", "experiment_cone.yaml", RangeUpdate::cone, false},
    Sensors{"readings_zone", "experiment_zones.yaml", RangeUpdate::cone, false},
    Sensors{"readings_cone_stands", "experiment_cone.yaml", RangeUpdate::cone, true},
    Sensors{"readings_zone_stands", "experiment_zones.yaml", RangeUpdate::cone, true},
};

constexpr std::array kReady = {0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785};
/// Each joint swings by this at this many radians a second: the flange then moves at some 0.3 m/s.
constexpr double kSwing_rad = 0.4;
constexpr double kSwingRate = 1.5;
constexpr std::int64_t kPeriod_ns = 33'000'000;
constexpr std::int64_t kJointsAhead_ns = 5'000'000;
constexpr double kSigma_m = 0.01;

/// What the sensors of a rig range, 30 times a second each, zone by zone.
class Readings final : public Task {
  public:
    Readings(const std::filesystem::path& rig, const std::string& resolution, const Sensors& sensors,
             const FusedMap& map)
        : builder_(builder_of(rig, resolution, sensors.update)), is_stationary_(sensors.is_stationary) {
        builder_.begin_with(map.copy());
        for (auto& range_m : ranges_m_) range_m = range_m_(random_);
        // What a stationary sensor has seen for long, all of its zones.
        for (int cycle = 0; cycle < kCyclesBefore; ++cycle) {
            prepare();
            run();
        }
        taken_ = 0;
        given_ = 0;
    }

    void prepare() override {
        now_.ns += kPeriod_ns;
        readings_.clear();
        for (std::uint8_t node = 1; node <= kNodes; ++node) {
            for (std::uint8_t sensor = 0; sensor < kSensorsOfNode; ++sensor) {
                double& range_m = ranges_m_.at((node - 1U) * kSensorsOfNode + sensor);
                if (!is_stationary_) range_m = range_m_(random_);
                const auto zone = builder_.has({node, sensor, kZones - 1})
                                      ? static_cast<std::uint8_t>(cycle_ % kZones)
                                      : std::uint8_t{0};
                readings_.push_back(
                    {{node, sensor, zone}, now_, range_m + 0.5 * kSigma_m * noise_(random_), kSigma_m});
            }
        }
        // The arm's joints about the readings' time.
        for (const std::int64_t ahead_ns : {-kJointsAhead_ns, kJointsAhead_ns}) {
            const HostTime time{now_.ns + ahead_ns};
            JointMeasurement joints{time, {}};
            const double seconds = is_stationary_ ? 0.0 : 1e-9 * static_cast<double>(time.ns);
            for (std::size_t i = 0; i < kReady.size(); ++i)
                joints.position_rad.at(i) =
                    kReady.at(i) + kSwing_rad * std::sin(kSwingRate * seconds + static_cast<double>(i));
            if (!builder_.add(joints)) throw std::runtime_error("a joint sample was refused");
        }
        ++cycle_;
    }

    void run() override {
        for (const RangeMeasurement& reading : readings_) taken_ += builder_.integrate(reading) ? 1U : 0U;
        given_ += readings_.size();
    }

    /// A reading that ends on the robot itself is refused, and costs little.
    void tell(Figures& figures) const override {
        if (20 * taken_ < 17 * given_) throw std::runtime_error("of the readings over 15 % are refused");
        tell_size(builder_.map(), figures);
    }

  private:
    static constexpr std::uint8_t kNodes = 2;
    static constexpr std::uint8_t kSensorsOfNode = 17;
    static constexpr std::uint8_t kZones = 9;
    static constexpr int kCyclesBefore = 6 * kZones;

    static MapBuilder builder_of(const std::filesystem::path& path, const std::string& resolution,
                                 RangeUpdate update) {
        const auto rig = rig::read_rig(path);
        if (!rig) throw std::runtime_error("the rig cannot be read");
        auto setup = make_host_setup(*rig);
        if (!setup) throw std::runtime_error("the rig's robot cannot be read");
        MappingConfig mapping = bench_mapping(resolution, DepthUpdate::fast);
        mapping.range_update = update;
        auto builder = MapBuilder::build(setup->rig, std::move(setup->robot), mapping, {}, {MapFeed::both});
        if (!builder) throw std::runtime_error("the rig and its robot do not go together");
        return std::move(builder).value();
    }

    MapBuilder builder_;
    bool is_stationary_;
    unsigned cycle_ = 0;
    HostTime now_{kPeriod_ns};
    std::mt19937 random_{5};
    std::uniform_real_distribution<double> range_m_{0.15, 1.2};
    std::normal_distribution<double> noise_;
    std::array<double, kNodes * kSensorsOfNode> ranges_m_{};
    std::vector<RangeMeasurement> readings_;
    std::size_t given_ = 0;
    std::size_t taken_ = 0;
};

}  // namespace

std::vector<Row> reading_rows(const std::filesystem::path& rigs, const std::string& resolution, unsigned runs,
                              const std::function<const FusedMap&()>& map) {
    std::vector<Row> rows;
    for (const Sensors& sensors : kSensors) {
        rows.push_back({sensors.name, kRays, runs, [rigs, resolution, map, sensors] {
                            return std::make_unique<Readings>(rigs / sensors.rig, resolution, sensors, map());
                        }});
    }
    return rows;
}

}  // namespace octoskin::bench
