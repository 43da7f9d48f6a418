#include "host/core/mapping/voxel_ages.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "host/core/bricks/brick_sets.hpp"

namespace octoskin {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
/// Larger than any nanosecond clock reaches; longer times are clamped to it.
constexpr std::int64_t kSecondsMax = std::int64_t{1} << 40U;

/// Rounds towards earlier times.
std::int64_t whole_seconds(HostTime time) {
    const std::int64_t seconds = time.ns / kNanosecondsPerSecond;
    return time.ns % kNanosecondsPerSecond < 0 ? seconds - 1 : seconds;
}

/// A beam has few voxels in a brick: writing them one by one is faster.
void put(BrickStamps& stamps, const BrickMask& voxels, std::uint16_t stamp) {
    constexpr std::size_t kFew = 16;
    if (count_of(voxels) > kFew) return put_stamp(stamps, voxels, stamp);
    for (std::size_t word = 0; word < voxels.size(); ++word)
        for (std::uint64_t bits = voxels[word]; bits != 0; bits &= bits - 1)
            stamps[64 * word + static_cast<std::size_t>(std::countr_zero(bits))] = stamp;
}

/// The oldest of the time stamps that are set; 0 if none is.
std::uint16_t oldest_of(const StampView& view) {
    if (view.values == nullptr) return view.value;
    // Minus one, a missing time stamp (0) becomes the latest of all.
    std::uint16_t least = 0xFFFF;
    for (const std::uint16_t stamp : *view.values)
        least = std::min(least, static_cast<std::uint16_t>(stamp - 1U));
    return static_cast<std::uint16_t>(least + 1U);
}

}  // namespace

bool VoxelAges::is_possible(const Clock& clock) noexcept {
    const auto is_time = [](std::int64_t seconds) { return seconds >= 0 && seconds <= kSecondsMax; };
    const bool are_times = is_time(clock.runs_for_s) && is_time(clock.waited_s) &&
                           clock.zero_s >= -kSecondsMax && clock.zero_s <= kSecondsMax;
    if (!clock.has_begun) return are_times && clock.runs_for_s == 0 && clock.now == 0;
    return are_times && clock.now >= kAgeMax_s && clock.now <= kNowMax;
}

bool VoxelAges::is_possible(std::uint16_t stamp, const Clock& clock) noexcept {
    if (stamp == 0 || stamp == kOfBefore) return true;
    const std::uint32_t then = std::uint32_t{stamp} >> kKindBits;
    const auto kind = static_cast<SensorKind>(stamp & ((1U << kKindBits) - 1U));
    return then >= 1 && then <= clock.now && (kind == SensorKind::range || kind == SensorKind::camera);
}

bool VoxelAges::advance_time(HostTime now) {
    const std::int64_t second = whole_seconds(now);
    if (!clock_.has_begun) {
        clock_ = {.has_begun = true, .zero_s = second - kAgeMax_s, .now = kAgeMax_s};
        return true;
    }
    if (std::exchange(clock_.waits, false)) {
        clock_.zero_s = second - clock_.now;
        return true;
    }
    const std::int64_t shown = second - clock_.zero_s;
    if (shown == clock_.now || (shown < clock_.now && clock_.now - shown <= kBackMax_s)) return false;
    if (shown < clock_.now) {
        clock_.zero_s = second - clock_.now;
        return false;
    }
    advance(shown - clock_.now);
    clock_.zero_s = second - clock_.now;
    return true;
}

std::int64_t VoxelAges::seconds_to(HostTime now) const noexcept {
    if (!clock_.has_begun || clock_.waits) return 0;
    return std::max(whole_seconds(now) - clock_.zero_s - clock_.now, std::int64_t{0});
}

void VoxelAges::advance(std::int64_t passed_s) {
    const std::int64_t shown = clock_.now + passed_s;
    const bool is_shown = shown <= kNowMax;
    if (!is_shown) bring_up(static_cast<std::uint32_t>(std::min<std::int64_t>(shown - kAgeMax_s, kNowMax)));
    clock_.now = is_shown ? static_cast<std::uint32_t>(shown) : kAgeMax_s;
    clock_.runs_for_s = std::min(clock_.runs_for_s + passed_s, kSecondsMax);
}

bool VoxelAges::wait(std::int64_t seconds) {
    if (!clock_.has_begun || !clock_.waits || seconds <= clock_.waited_s) return false;
    advance(seconds - clock_.waited_s);
    clock_.waited_s = seconds;
    return true;
}

void VoxelAges::jump_time(Nanoseconds by) noexcept {
    clock_.zero_s += whole_seconds(HostTime{by.count() + kNanosecondsPerSecond / 2});
}

template <class Change>
void VoxelAges::change_stamps(const Change& change) {
    StampTree next = stamps_;
    stamps_.for_each([&](MortonCode brick, const StampView& view) {
        if (view.values == nullptr) return next.set_all(brick, change(view.value));
        for (std::uint16_t& stamp : next.open(brick)) stamp = change(stamp);
    });
    stamps_ = std::move(next);
    agenda_.change_stamps(change);
}

/// Time stamps too old for the shift become the oldest possible one.
void VoxelAges::bring_up(std::uint32_t by) {
    change_stamps([by](std::uint16_t stamp) -> std::uint16_t {
        if (stamp == 0) return 0;
        const auto then = std::uint32_t{stamp} >> kKindBits;
        const std::uint32_t kind = stamp & ((1U << kKindBits) - 1U);
        return static_cast<std::uint16_t>(((then > by ? then - by : 1U) << kKindBits) | kind);
    });
}

void VoxelAges::begin_agenda() {
    ExpiryAgenda agenda;
    stamps_.for_each([&](MortonCode brick, const StampView& view) {
        agenda.make_room();
        agenda.put(brick, oldest_of(view));
    });
    agenda.begin();
    agenda_ = std::move(agenda);
}

std::uint16_t VoxelAges::oldest_in(MortonCode brick) const noexcept {
    return oldest_of(stamps_.find(brick));
}

void VoxelAges::take_from_before(MortonCode brick, const BrickMask& voxels) {
    const StampView before = stamps_.find(brick);
    if (before.is_unknown()) return stamp_first(brick, kOfBefore, [&] { stamps_.set_all(brick, kOfBefore); });
    if (before.values == nullptr) return;
    BrickMask undated{};
    for (std::size_t word = 0; word < voxels.size(); ++word)
        undated[word] = voxels[word] & stamps_below(*before.values, word, 1);
    if (undated == BrickMask{}) return;
    put_stamp(stamps_.open(brick), undated, kOfBefore);
    agenda_ = ExpiryAgenda();  // it has a later time stamp for the brick: the next visit rebuilds it
}

std::optional<Confirmation> VoxelAges::confirmation_of(std::uint16_t stamp) const noexcept {
    if (stamp == 0 || stamp == kOfBefore) return std::nullopt;
    const auto then = std::uint32_t{stamp} >> kKindBits;
    const auto kind = static_cast<SensorKind>(stamp & ((1U << kKindBits) - 1U));
    return Confirmation{then == 1 ? kAgeMax_s : std::min(clock_.now - then, kAgeMax_s), kind};
}

std::uint16_t VoxelAges::stamp_before(std::uint32_t age_s) const noexcept {
    if (age_s >= clock_.now) return kOfBefore + 1;
    return static_cast<std::uint16_t>((clock_.now - age_s + 1) << kKindBits);
}

void VoxelAges::confirm(MortonCode brick, const BrickMask& voxels, SensorKind kind) {
    const std::uint16_t now = stamp(kind);
    if (BrickStamps* const own = stamps_.own(brick)) {
        if (is_whole(voxels)) return stamps_.set_all(brick, now);
        return put(*own, voxels, now);
    }
    const StampView before = stamps_.find(brick);
    // Most frames find the time stamps of a frame in the same second: then nothing is copied.
    if (before.values == nullptr ? before.value == now : !has_other_stamp(*before.values, voxels, now))
        return;
    const auto stamp_voxels = [&] {
        is_whole(voxels) ? stamps_.set_all(brick, now) : put(stamps_.open(brick), voxels, now);
    };
    before.is_unknown() ? stamp_first(brick, now, stamp_voxels) : stamp_voxels();
}

void VoxelAges::forget(MortonCode brick, const BrickMask& voxels) {
    if (stamps_.find(brick).is_unknown()) return;
    if (is_whole(voxels)) return stamps_.forget(brick);
    BrickStamps& stamps = stamps_.open(brick);
    put_stamp(stamps, voxels, 0);
    if (std::ranges::all_of(stamps, [](std::uint16_t stamp) { return stamp == 0; })) stamps_.forget(brick);
}

}  // namespace octoskin
