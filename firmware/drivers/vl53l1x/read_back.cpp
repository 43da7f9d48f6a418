#include "firmware/drivers/vl53l1x/read_back.hpp"

#include <algorithm>

namespace octoskin::vl53l1x {
namespace {

constexpr std::size_t total(std::size_t runs) noexcept {
    std::size_t count = 0;
    for (std::size_t i = 0; i < runs; ++i) count += kRegisterRuns[i].count;
    return count;
}
static_assert(total(kRegisterRuns.size()) == kRegistersReadBack);
static_assert(std::all_of(kRegisterRuns.begin(), kRegisterRuns.end(),
                          [](const RegisterRun& run) { return run.count <= kRunBytesMax; }));

/// Index of a register in the arrays; empty if it is not read back.
std::optional<std::size_t> slot_of(reg::Index index) noexcept {
    std::size_t before = 0;
    for (const RegisterRun& run : kRegisterRuns) {
        if (index >= run.first && index < run.first + run.count) return before + (index - run.first);
        before += run.count;
    }
    return std::nullopt;
}

}  // namespace

void ReadBack::note(reg::Index first, std::span<const std::uint8_t> bytes) noexcept {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (const auto slot = slot_of(static_cast<reg::Index>(first + i))) {
            expected_[*slot] = bytes[i];
            is_known_.set(*slot);
        }
    }
}

void ReadBack::learn(const RegisterRun& run, std::span<const std::uint8_t> bytes) noexcept {
    for (std::size_t i = 0; i < run.count; ++i) {
        const auto slot = slot_of(static_cast<reg::Index>(run.first + i));
        if (!is_known_[*slot]) note(static_cast<reg::Index>(run.first + i), bytes.subspan(i, 1));
    }
}

void LastingDifferences::note(const RegisterDifference& difference) noexcept {
    const auto known = std::span(all_).first(count_);
    const auto place = std::find_if(known.begin(), known.end(), [&](const RegisterDifference& other) {
        return other.index == difference.index;
    });
    if (place != known.end()) {
        *place = difference;
    } else if (!is_full()) {
        all_[count_++] = difference;
    }
}

void LastingDifferences::forget_overlooked(const Verification& verification) noexcept {
    const auto known = std::span(all_).first(count_);
    const auto rest = std::remove_if(known.begin(), known.end(), [&](const RegisterDifference& difference) {
        return verification.overlooks(difference);
    });
    count_ = static_cast<std::uint8_t>(rest - known.begin());
}

bool ReadBack::differs(std::size_t slot, reg::Index index, std::uint8_t found) const noexcept {
    if (!is_known_[slot] || ((expected_[slot] ^ found) & compared_bits(index)) == 0) return false;
    return !verification_.overlooks({.index = index, .expected = expected_[slot], .found = found});
}

bool ReadBack::agrees(const RegisterRun& run, std::span<const std::uint8_t> bytes) const noexcept {
    for (std::size_t i = 0; i < run.count; ++i) {
        const auto index = static_cast<reg::Index>(run.first + i);
        const auto slot = slot_of(index);
        if (!is_exempt_[*slot] && differs(*slot, index, bytes[i])) return false;
    }
    return true;
}

bool ReadBack::record(const RegisterRun& run, std::span<const std::uint8_t> bytes) noexcept {
    bool counts = false;
    clean_checks_ = 0;
    for (std::size_t i = 0; i < run.count; ++i) {
        const auto index = static_cast<reg::Index>(run.first + i);
        const auto slot = slot_of(index);
        if (is_exempt_[*slot] || !differs(*slot, index, bytes[i])) continue;
        last_ = {.index = index, .expected = expected_[*slot], .found = bytes[i]};
        const bool is_lasting = is_third_sighting(*last_);
        if (is_lasting && is_exempted(*slot, *last_)) continue;
        counts = true;
    }
    return counts;
}

bool ReadBack::record_of_write(const RegisterRun& run, std::span<const std::uint8_t> bytes) noexcept {
    bool counts = false;
    for (std::size_t i = 0; i < run.count; ++i) {
        const auto index = static_cast<reg::Index>(run.first + i);
        const auto slot = slot_of(index);
        if (is_exempt_[*slot] || !differs(*slot, index, bytes[i])) continue;
        last_ = {.index = index, .expected = expected_[*slot], .found = bytes[i]};
        counts = true;
    }
    return counts;
}

/// For a persistent difference: exempts the register, unless it decides the range or the table is full.
bool ReadBack::is_exempted(std::size_t slot, const RegisterDifference& difference) noexcept {
    if (decides_range(difference.index)) {
        deciding_.note(difference);
        ++lasting_count_;
        return false;
    }
    if (exempt_.is_full()) return false;
    exempt_.note(difference);
    ++lasting_count_;
    is_exempt_.set(slot);
    return true;
}

void ReadBack::forget_overlooked() noexcept {
    deciding_.forget_overlooked(verification_);
    exempt_.forget_overlooked(verification_);
    is_exempt_.reset();
    for (const RegisterDifference& difference : exempt_.all()) is_exempt_.set(*slot_of(difference.index));
    for (Sighting& sighting : sightings_) {
        if (sighting.count != 0 && verification_.overlooks(sighting.difference)) sighting = {};
    }
}

std::optional<RegisterDifference> ReadBack::fixed_register() const noexcept {
    if (!deciding_.all().empty()) return deciding_.all().front();
    if (!exempt_.all().empty()) return exempt_.all().back();
    return std::nullopt;
}

/// A difference without a free entry is not counted, but still acted on: entries become free again.
bool ReadBack::is_third_sighting(const RegisterDifference& difference) noexcept {
    const auto same_register = [&](const Sighting& sighting) {
        return sighting.count != 0 && sighting.difference.index == difference.index;
    };
    auto place = std::find_if(sightings_.begin(), sightings_.end(), same_register);
    if (place == sightings_.end()) {
        place = std::find_if(sightings_.begin(), sightings_.end(),
                             [](const Sighting& sighting) { return sighting.count == 0; });
        if (place == sightings_.end()) return false;
    }
    const bool is_the_same = place->count != 0 && place->difference == difference;
    *place = {.difference = difference,
              .count = is_the_same ? static_cast<std::uint8_t>(place->count + 1) : std::uint8_t{1}};
    if (place->count < kSightingsUntilFixed) return false;
    *place = {};
    return true;
}

void ReadBack::on_clean_check() noexcept {
    if (++clean_checks_ < kCleanChecksUntilForgotten) return;
    clean_checks_ = 0;
    sightings_.fill({});
    deciding_.clear();
}

}  // namespace octoskin::vl53l1x
