#include "host/apps/daemon/boot_clock.hpp"

#include <charconv>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>

namespace octoskin {
namespace {

std::optional<std::array<std::uint8_t, 16>> boot_id() {
    std::ifstream kernels("/proc/sys/kernel/random/boot_id");
    std::string text;
    if (std::getline(kernels, text)) return read_boot_id(text);
    const char* const systemds = std::getenv("OCTOSKIN_BOOT_ID");
    return systemds != nullptr ? read_boot_id(systemds) : std::nullopt;
}

}  // namespace

std::optional<std::array<std::uint8_t, 16>> read_boot_id(std::string_view text) {
    constexpr int kHex = 16;
    std::string digits;
    for (const char letter : text)
        if (letter != '-') digits += letter;
    std::array<std::uint8_t, 16> id{};
    if (digits.size() != 2 * id.size()) return std::nullopt;
    for (std::size_t i = 0; i < id.size(); ++i) {
        const char* const first = digits.data() + 2 * i;
        const auto [end, error] = std::from_chars(first, first + 2, id[i], kHex);
        if (error != std::errc{} || end != first + 2) return std::nullopt;
    }
    return id;
}

std::optional<BootTime> boot_now() {
    static const auto boot = boot_id();  // it is the same for as long as this process lives
    timespec now{};
    if (!boot || ::clock_gettime(CLOCK_BOOTTIME, &now) != 0) return std::nullopt;
    return BootTime{*boot, Nanoseconds{std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec}};
}

std::optional<std::int64_t> seconds_between(const std::optional<BootTime>& then,
                                            const std::optional<BootTime>& now) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    if (!then || !now || then->boot != now->boot || now->since_boot < then->since_boot) return std::nullopt;
    const std::int64_t passed_ns = (now->since_boot - then->since_boot).count();
    return passed_ns / kSecond_ns + (passed_ns % kSecond_ns > 0 ? 1 : 0);
}

std::optional<std::int64_t> MapTime::begin_with(FusedMap& map, const std::optional<BootTime>& saved) {
    saved_ = saved;
    map_time_ = saved;
    looked_ = clock_();
    const auto passed_s = seconds_between(saved_, looked_);
    if (passed_s) {
        map.begin_to_wait();
        if (map.wait(*passed_s)) map_time_ = looked_;
    } else {
        map.forget_times();
    }
    seen_ = map.layers().ages.clock();
    return passed_s;
}

void MapTime::note(const FusedMap& map) {
    const VoxelAges::Clock& clock = map.layers().ages.clock();
    const bool went_on = clock.has_begun != seen_.has_begun || clock.runs_for_s != seen_.runs_for_s;
    const std::optional<BootTime> now = clock_();
    if (went_on) map_time_ = looked_;
    seen_ = clock;
    looked_ = now;
}

}  // namespace octoskin
