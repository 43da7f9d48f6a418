#include "host/core/mapping/end_memory.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "host/core/depth/denoised_row.hpp"
#include "host/core/voxels/morton.hpp"

namespace octoskin {
namespace {

MortonCode code_of(const EndMemory::End& end) {
    return morton_of({static_cast<std::uint16_t>(end.key_xy), static_cast<std::uint16_t>(end.key_xy >> 16U),
                      static_cast<std::uint16_t>(end.key_z)});
}

/// Below all log-odds: nothing is left of what it is added to.
constexpr float kTakesAll = std::numeric_limits<float>::lowest();

}  // namespace

void EndMemory::find(const ProjectedImage& image, std::span<const std::uint8_t> changes,
                     const Evidence& terms, Evidence& retracted) {
    assert(changes.size() == image.pixels());
    retracted.clear();
    retracted.rule = EvidenceRule::weaken;
    retracted.sensor = SensorKind::camera;
    retracted.miss = kTakesAll;
    const Changed changed = find_changed(image, changes);
    take_codes(changed.left, left_);
    if (!left_.empty()) {
        take_codes(changed.held, held_);
        std::erase_if(left_, [&](MortonCode code) { return std::ranges::binary_search(held_, code); });
        keep_hit(terms);
    }
    for (const MortonCode code : left_)
        put_in(retracted.last(code - code % kBrickVoxels).voxels, code % kBrickVoxels);
}

void EndMemory::keep(const ProjectedImage& image, std::span<const std::uint8_t> changes) {
    assert(changes.size() == image.pixels());
    ends_.resize(image.pixels());
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        const bool is_doubtful = changes[i] == kChangeFound && ends_[i] != End{};
        if (image.key_z[i] != ProjectedImage::kNoKey && !is_doubtful)
            ends_[i] = {image.key_xy[i], image.key_z[i], image.reach_m[i]};
    }
}

/// Most pixels are neither, and which ones are is not predictable: so there is no branch.
EndMemory::Changed EndMemory::find_changed(const ProjectedImage& image,
                                           std::span<const std::uint8_t> changes) {
    left_pixels_.resize(ends_.size() + 1);
    held_pixels_.resize(ends_.size() + 1);
    std::size_t left = 0;
    std::size_t held = 0;
    for (std::size_t i = 0; i < ends_.size(); ++i) {
        const End& last = ends_[i];
        const auto had_end = static_cast<unsigned>(last.key_z != ProjectedImage::kNoKey);
        const auto has_end = static_cast<unsigned>(image.key_z[i] != ProjectedImage::kNoKey);
        const auto is_elsewhere = static_cast<unsigned>(image.key_z[i] != last.key_z) |
                                  static_cast<unsigned>(image.key_xy[i] != last.key_xy);
        const auto is_found = static_cast<unsigned>(changes[i] == kChangeFound);
        const auto is_hidden = static_cast<unsigned>(changes[i] == kChangeConfirmed) &
                               static_cast<unsigned>(image.reach_m[i] < last.depth_m);
        left_pixels_[left] = static_cast<std::uint32_t>(i);
        left += had_end & has_end & is_elsewhere & ((is_found | is_hidden) ^ 1U);
        held_pixels_[held] = static_cast<std::uint32_t>(i);
        held += had_end & ((has_end ^ 1U) | is_found);
    }
    return {{left_pixels_.data(), left}, {held_pixels_.data(), held}};
}

void EndMemory::take_codes(std::span<const std::uint32_t> pixels, std::vector<MortonCode>& codes) const {
    codes.clear();
    for (const std::uint32_t pixel : pixels) codes.push_back(code_of(ends_[pixel]));
    std::ranges::sort(codes);
    codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
}

void EndMemory::keep_hit(const Evidence& terms) {
    auto brick = terms.bricks.begin();
    std::erase_if(left_, [&](MortonCode code) {
        const MortonCode first = code - code % kBrickVoxels;
        while (brick != terms.bricks.end() && brick->first < first) ++brick;
        if (brick == terms.bricks.end() || brick->first != first) return false;
        const auto cell = static_cast<std::uint16_t>(code % kBrickVoxels);
        return std::ranges::any_of(terms.cells_of(*brick),
                                   [&](const CellTerm& hit) { return hit.cell == cell; });
    });
}

}  // namespace octoskin
