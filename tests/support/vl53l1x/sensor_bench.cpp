#include "tests/support/vl53l1x/sensor_bench.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace octoskin::test {

using vl53l1x::Progress;

sim::RangingScene wall_at(double range_m) {
    return [range_m](std::uint32_t, sim::SimTime, const Roi&) {
        return sim::RangingReturn{
            .range_m = range_m, .sigma_m = 0.005, .peak_signal_mcps = 16.0, .ambient_mcps = 0.125};
    };
}

sim::RangingScene empty_scene() {
    return [](std::uint32_t, sim::SimTime, const Roi&) {
        return sim::RangingReturn{
            .range_m = std::nullopt, .sigma_m = 0.0, .peak_signal_mcps = 0.0, .ambient_mcps = 0.5};
    };
}

SensorBench::SensorBench(NodeTime node_start) : clock_(node_start, 0.0), bus_(present_, 400'000) {}

sim::SensorModel& SensorBench::add(const sim::RangingScene& scene, const sim::SensorPart& part) {
    sensors_.push_back(std::make_unique<sim::SensorModel>(part, scene));
    bus_.attach(*sensors_.back());
    return *sensors_.back();
}

sim::SensorModel& SensorBench::add_booted(const sim::RangingScene& scene, const sim::SensorPart& part) {
    sim::SensorModel& sensor = add(scene, part);
    set_xshut(sensor, true);
    wait(Microseconds{2'000});
    return sensor;
}

std::optional<Bytes> SensorBench::transfer(i2c::Address address, const Bytes& write, std::size_t read_bytes) {
    Bytes read(read_bytes);
    bus_.submit({address, write, read}, now(), now() + Microseconds{20'000});
    present_.time = bus_.transfer_end().value_or(sim::SimTime{present_.time.us + 20'000});
    if (bus_.poll(now()) != i2c::TransferState::done) return std::nullopt;
    return read;
}

Bytes SensorBench::read(std::uint16_t index, std::size_t count, i2c::Address address) {
    const auto bytes = transfer(
        address, {static_cast<std::uint8_t>(index >> 8U), static_cast<std::uint8_t>(index & 0xFFU)}, count);
    EXPECT_TRUE(bytes) << "read of " << index;
    return bytes.value_or(Bytes(count));
}

void SensorBench::write(std::uint16_t index, const Bytes& bytes, i2c::Address address) {
    Bytes all{static_cast<std::uint8_t>(index >> 8U), static_cast<std::uint8_t>(index & 0xFFU)};
    all.insert(all.end(), bytes.begin(), bytes.end());
    EXPECT_TRUE(transfer(address, all, 0)) << "write of " << index;
}

void SensorBench::play(std::string_view trace) {
    for (const TraceEntry& entry : parse_trace(trace)) {
        wait(Microseconds{std::int64_t{entry.wait_ms} * 1'000});
        if (entry.is_wait()) continue;
        const auto answer = transfer(entry.address, entry.write, entry.read.size());
        ASSERT_TRUE(answer) << entry.text;
        for (std::size_t i = 0; i < entry.read.size(); ++i) {
            if (!entry.read[i]) continue;
            EXPECT_EQ(unsigned{(*answer)[i]}, unsigned{*entry.read[i]}) << entry.text << ", byte " << i;
        }
    }
}

bool SensorBench::await_ready(Microseconds limit, i2c::Address address) {
    for (const sim::SimTime begin = present_.time; present_.time.us - begin.us < limit.count();) {
        const bool is_active_low = (read(0x0030, 1, address)[0] & 0x10U) != 0;
        const bool is_high = (read(0x0031, 1, address)[0] & 1U) != 0;
        if (is_high != is_active_low) return true;
        wait(Microseconds{100});
    }
    return false;
}

Progress SensorBench::finish(vl53l1x::Device& device) {
    const sim::SimTime begin = present_.time;
    while (present_.time.us - begin.us < 10'000'000) {
        const Progress progress = device.poll(now());
        if (progress != Progress::busy) return progress;
        if (const auto end = bus_.transfer_end()) {
            present_.time = std::max(present_.time, *end);
        } else if (const auto wake = device.wake_time()) {
            wait(std::max(elapsed(now(), *wake), Microseconds{0}));
        } else {
            wait(Microseconds{100});
        }
    }
    return Progress::busy;
}

void SensorBench::bring_up(vl53l1x::Device& device, sim::SensorModel& sensor,
                           const vl53l1x::Settings& settings) {
    set_xshut(sensor, true);
    wait(Microseconds{2'000});
    device.begin_probe(vl53l1x::kDefaultAddress);
    ASSERT_EQ(finish(device), Progress::done);
    device.begin_set_address(settings.address);
    ASSERT_EQ(finish(device), Progress::done);
    device.begin_initialise();
    ASSERT_EQ(finish(device), Progress::done);
    device.begin_finish_initialise();
    ASSERT_EQ(finish(device), Progress::done);
    device.begin_configure(settings);
    ASSERT_EQ(finish(device), Progress::done);
    device.begin_start();
    ASSERT_EQ(finish(device), Progress::done);
}

bool SensorBench::await_measurement(vl53l1x::Device& device, Microseconds limit) {
    for (const sim::SimTime begin = present_.time; present_.time.us - begin.us < limit.count();) {
        device.begin_read();
        if (finish(device) != Progress::done) return false;
        if (device.has_measurement()) return true;
        wait(Microseconds{500});
    }
    return false;
}

}  // namespace octoskin::test
