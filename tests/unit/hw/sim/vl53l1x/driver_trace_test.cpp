// The oracle is what two independent public drivers put on the bus: ST's ULD 3.5.2 and Pololu's library, both
// compiled and logged. Played at the model, every transfer must be acknowledged and every read bring what
// they build on.
#include <gtest/gtest.h>

#include "tests/support/vl53l1x/sensor_bench.hpp"
#include "tests/support/vl53l1x/st_trace.hpp"

namespace octoskin::sim {
namespace {

namespace st = vl53l1x::st;

// 1.250 m of wall. ST's trace sets an offset of -13 mm instead of the factory's 13: 26 mm less. And it
// compensates 2 kcps per SPAD of crosstalk where there is none: of 51.2 SPADs 0.1024 Mcps, 0.64 % of 16, so 8
// mm more.
TEST(DriverTrace, st_uld_runs_on_the_model) {
    test::SensorBench bench;
    bench.add_booted(test::wall_at(1.250));
    bench.play(st::kBootState);
    bench.play(st::kGetSensorId);
    // 91 writes and a start; the first range takes 101 ms, less the 20 ms that ST's two polls need here.
    const std::string init = st::kSensorInit;
    const std::size_t first_poll = init.find("R 0030");
    const std::size_t second_poll = init.find("R 0030", first_poll + 1);
    bench.play(init.substr(0, second_poll));
    bench.play("WAIT 110");
    bench.play(init.substr(second_poll));

    bench.play(st::kSetDistanceModeLong);
    bench.play(st::kSetTimingBudget33Long);
    bench.play(st::kSetInterMeasurement50);
    bench.play(st::kGetInterMeasurement);
    bench.play(st::kSetRoi8x8);
    bench.play(st::kSetRoiCentre167);
    bench.play(st::kSetOffsetMinus13);
    bench.play(st::kSetXtalk2000);
    bench.play(st::kSetSignalThreshold1024);
    bench.play(st::kSetSigmaThreshold15);

    bench.play(st::kStartRanging);
    bench.play(st::kNotReady);
    bench.play("WAIT 60");
    bench.play(st::kReady);
    // Complete, first of its run, 8 x 8 of which 80 % are active, 16.0 and 0.125 Mcps, 5.0 mm, 1232 mm,
    // 15.90 Mcps once compensated.
    bench.play("R 0089 17 -> 09 00 00 33 33 08 00 00 10 00 14 ?? ?? 04 D0 07 F3");
    bench.play(st::kClearInterrupt);
    bench.play(st::kNotReady);
    bench.play(st::kStopRanging);

    bench.play(st::kSetDistanceModeShort);
    bench.play(st::kSetTimingBudget20Short);
    bench.play(st::kSetDistanceThreshold100To300Inside);
    bench.play(st::kSetInterruptPolarityLow);
    bench.play(st::kSetI2cAddress54);
    bench.play("ADDRESS 2A | R 0001 1 -> 2A | R 0030 1 -> 11 | R 0031 1 -> 03");
}

TEST(DriverTrace, st_temperature_update_runs_on_the_model) {
    test::SensorBench bench;
    bench.add_booted(test::wall_at(1.0));
    bench.play("W 0030 01");
    const std::string update = st::kStartTemperatureUpdate;
    const std::size_t second_poll = update.find("R 0030", update.find("R 0030") + 1);
    bench.play(update.substr(0, second_poll));
    bench.play("WAIT 300");
    bench.play(update.substr(second_poll));
}

// Pololu's library, 2V8, long mode, 33 ms, continuous at 50 ms. Its soft reset needs a millisecond; the
// values read of results are the model's.
TEST(DriverTrace, pololu_runs_on_the_model) {
    test::SensorBench bench;
    bench.add_booted(test::wall_at(1.234));
    bench.play(R"(
        R 010F 2 -> EA CC | W 0000 00
        WAIT 1
        W 0000 01
        WAIT 2
        R 00E5 1 -> 03 | R 002E 1 -> 00 | W 002E 01 | R 0006 2 -> BC 7A | R 00DE 2 -> 00 25
        W 0024 0A 00 | W 0031 02 | W 0036 08 | W 0037 10 | W 0039 01 | W 003E FF | W 003F 00 | W 0040 02
        W 0050 00 00 | W 0052 00 00 | W 0057 38 | W 0064 01 68 | W 0066 00 C0 | W 0071 01 | W 007C 01
        W 007E 02 | W 0082 00 | W 0077 01 | W 0081 8B | W 0054 C8 00 | W 004F 02
        R 0060 1 -> 0B | R 005E 2 -> 01 92
        W 0060 0F | W 0063 0D | W 0069 B8 | W 0078 0F | W 0079 0D | W 007A 0E | W 007B 0E
        R 0060 1 -> 0F | W 004B 0A | W 005A 00 00 | W 005E 00 DB | R 0063 1 -> 0D | W 005C 00 00 | W 0061 00 FA
        R 0060 1 -> 0F | W 004B 0A | W 005A 00 00 | W 005E 00 E7 | R 0063 1 -> 0D | W 005C 00 00 | W 0061 01 84
        R 0022 2 -> 00 0D | W 001E 00 34
        R 0060 1 -> 0F | W 004B 0A | W 005A 00 00 | W 005E 00 91 | R 0063 1 -> 0D | W 005C 00 00 | W 0061 00 A5
        W 006C 00 00 07 3A | W 0086 01 | W 0087 40
        R 0031 1 -> 03
        WAIT 60
        R 0031 1 -> 02
        R 0089 17 -> 09 00 00 ?? ?? 08 00 00 10 00 14 ?? ?? 04 D2 08 00
        R 000B 1 -> 95 | R 0008 1 -> 81 | W 000B 15 | W 0008 0D | W 004D 01 | R 00D8 1 -> 0B | W 0047 0B
        W 0054 22 61 | W 0086 01
        R 0031 1 -> 03
        WAIT 60
        R 0031 1 -> 02
        R 0089 17 -> 09 00 01 ?? ?? 08 00 00 10 00 14 ?? ?? 04 D2 08 00
        W 0054 22 61 | W 0086 01
        W 0087 80 | W 000B 95 | W 0008 81 | W 004D 00
        R 0031 1 -> 03
        WAIT 200
        R 0031 1 -> 03)");
}

}  // namespace
}  // namespace octoskin::sim
