#include "host/apps/daemon/ending.hpp"

#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <chrono>
#include <cstdint>

#include "host/apps/recording/shortage.hpp"

namespace octoskin {

Nanoseconds end_patience(std::size_t map_bytes) noexcept {
    constexpr Nanoseconds kSmallMap{3'500'000'000};
    constexpr std::size_t kSmallBytes = std::size_t{64} << 20U;
    constexpr std::int64_t kNsPerByte = 2 * 32 * 2;  // 20 ns a byte at 50 MB/s, 3.2 bytes, twice
    if (map_bytes <= kSmallBytes) return kSmallMap;
    return kSmallMap + Nanoseconds{kNsPerByte * static_cast<std::int64_t>(map_bytes - kSmallBytes)};
}

void report_end(Nanoseconds patience) {
    const auto all = std::chrono::duration_cast<std::chrono::microseconds>(patience + kEndMargin);
    (void)sd_notifyf(0, "STOPPING=1\nEXTEND_TIMEOUT_USEC=%lld\nWATCHDOG_USEC=%lld",
                     static_cast<long long>(all.count()), static_cast<long long>(all.count()));
}

Nanoseconds load_patience(std::uint64_t bytes) noexcept {
    constexpr Nanoseconds kUsual{90'000'000'000};
    constexpr std::int64_t kNsPerByte = 40;
    return kUsual + Nanoseconds{kNsPerByte * static_cast<std::int64_t>(bytes)};
}

void report_load(Nanoseconds patience) {
    const auto all = std::chrono::duration_cast<std::chrono::microseconds>(patience);
    (void)sd_notifyf(0, "EXTEND_TIMEOUT_USEC=%lld", static_cast<long long>(all.count()));
}

int report_why_it_ends(const std::exception& thrown) {
    const auto shortage = shortage_in(thrown);
    if (!shortage) {
        spdlog::critical("a defect of octoskin, please report it: {}; octoskin saves the map and ends",
                         thrown.what());
        return kInternalDefect;
    }
    spdlog::critical("{}; octoskin saves the map and ends", shortage->message());
    return static_cast<int>(shortage->exit);
}

}  // namespace octoskin
