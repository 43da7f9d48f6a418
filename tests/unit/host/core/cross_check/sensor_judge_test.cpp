// Evidence of short ranges: a board is seen by the camera from one side and by three sensors from the other.
#include "host/core/cross_check/sensor_judge.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

namespace octoskin {
namespace {

constexpr double kBoardM = 1.0;  ///< distance of the side that the camera sees
constexpr double kThickM = 0.02;
constexpr double kShortM = 0.5;
constexpr std::uint16_t kJudged = 0;

/// A range of a sensor that looks at the board along x.
Compared at_board(std::uint16_t sensor, std::uint8_t zone, double range_m, HostTime captured) {
    Compared compared;
    compared.sensor = sensor;
    compared.beam.source = {1, static_cast<std::uint8_t>(sensor), zone};
    compared.beam.captured = captured;
    compared.beam.direction_map = Eigen::Vector3d::UnitX();
    compared.beam.range_m = range_m;
    compared.beam.sigma_m = 0.01;
    RangePrediction& at = compared.predictions.mounted;
    at.range_m = kBoardM;
    at.sigma_m = 0.01;
    at.is_from_behind = true;
    at.surface = SeenSurface{{kBoardM, 0, 0}, Eigen::Vector3d::UnitX()};
    return compared;
}

/// What the judged sensor reports beside each image: a zone and a range.
struct Reported {
    std::uint8_t zone;
    double range_m;
};

/// Evidence after 30 s of images at 10 Hz, while two other sensors measure the board.
double evidence_after(const std::vector<Reported>& turns) {
    constexpr std::int64_t kPeriod_ns = 100'000'000;
    constexpr std::size_t kImages = 300;
    constexpr double kWholeM = kBoardM - kThickM;
    SensorJudge judge(std::array<std::size_t, 1>{3}, 1);
    for (std::size_t i = 0; i < kImages; ++i) {
        const HostTime now{static_cast<std::int64_t>(i) * kPeriod_ns};
        const Reported& turn = turns[i % turns.size()];
        judge.judge(std::array{at_board(kJudged, turn.zone, turn.range_m, now), at_board(1, 0, kWholeM, now),
                               at_board(2, 0, kWholeM, now)});
    }
    return judge.verdict(kJudged).evidence;
}

constexpr double kWhole = kBoardM - kThickM;

TEST(SensorJudge, takes_ranges_that_are_short_between_two_good_ones_as_evidence) {
    EXPECT_GE(evidence_after({{1, kWhole}, {1, kShortM}, {1, kWhole}}), SensorJudge::kNamedFrom);
}

TEST(SensorJudge, takes_no_evidence_of_a_zone_that_sees_an_object_beside_zones_that_see_past_it) {
    EXPECT_LE(evidence_after({{1, kWhole}, {3, kShortM}, {1, kWhole}}), 0.0);
    EXPECT_LE(evidence_after({{1, kWhole}, {3, kShortM}, {8, kWhole}}), 0.0);
    EXPECT_LE(evidence_after({{8, kWhole}, {3, kShortM}, {3, kWhole}}), 0.0);
}

TEST(SensorJudge, takes_no_evidence_of_a_sensor_that_sees_the_board) {
    EXPECT_LE(evidence_after({{1, kWhole}, {2, kWhole}}), 0.0);
}

}  // namespace
}  // namespace octoskin
