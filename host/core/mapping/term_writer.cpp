#include "host/core/mapping/term_writer.hpp"

#include <array>
#include <cmath>
#include <span>

#include "host/core/bricks/brick_terms.hpp"

namespace octoskin {
namespace {

/// Calls write(cell, term) for each voxel of a brick, in order, for every term.
template <class Write>
void for_each_voxel(const Evidence& evidence, const BrickEvidence& brick, const Write& write) {
    for_each_cell(brick.voxels, [&](std::size_t cell) { write(cell, evidence.miss); });
    for (const CellTerm& cell : evidence.cells_of(brick)) write(std::size_t{cell.cell}, cell.term);
}

}  // namespace

void TermWriter::write(const Evidence& evidence) noexcept {
    const std::uint64_t no_memory = editor_.counters().no_memory;
    const bool has_counts = !editor_.layers().counts.empty();
    for (std::size_t next = 0; next < evidence.bricks.size();) {
        const std::size_t owned = has_counts ? 0 : write_owned(evidence, next);
        next += owned;
        if (owned > 0) continue;
        const BrickEvidence& brick = evidence.bricks[next++];
        editor_.has_counts(brick.first) ? write_priors(evidence, brick) : write_brick(evidence, brick);
    }
    // Terms without room are in an unknown brick, which gets no time stamp.
    if (editor_.layers().ages.has_begun() && editor_.counters().no_memory == no_memory) date(evidence);
}

/// Writes consecutive bricks whose voxels have their own values, as long as nothing must be refused; returns
/// how many. In known space, these are all bricks of a ray. Most of a map is not cached: all bricks, then all
/// voxels, are prefetched before the first is written.
std::size_t TermWriter::write_owned(const Evidence& evidence, std::size_t from) noexcept {
    constexpr std::size_t kVoxelsMax = 512;
    constexpr std::size_t kBricksMax = 256;
    std::array<BrickValues*, kBricksMax> bricks;  // NOLINT: the first `found` are set
    BrickTree::OwnBricks own(editor_.layers().log_odds);
    const auto wanted = std::span(evidence.bricks).subspan(from);
    std::size_t found = 0;
    for (std::size_t voxels = 0; found < wanted.size() && found < kBricksMax; ++found) {
        const BrickEvidence& brick = wanted[found];
        voxels += brick.cells_end - brick.cells_begin;
        if (voxels > kVoxelsMax) break;
        bricks[found] = own.find(brick.first);
        if (bricks[found] == nullptr) break;
    }
    std::array<float*, kVoxelsMax> voxels;  // NOLINT: the first `count` are set
    std::size_t count = 0;
    std::size_t written = 0;
    for (; written < found; ++written) {
        const BrickEvidence& brick = wanted[written];
        if (brick.voxels != BrickMask{}) break;
        const std::size_t before = count;
        bool are_plain = true;
        for (const CellTerm& cell : evidence.cells_of(brick)) {
            are_plain = are_plain && is_plain(cell.term);
            voxels[count] = bricks[written]->data() + cell.cell;
            __builtin_prefetch(voxels[count++], 1);
        }
        if (!are_plain) {
            count = before;
            break;
        }
    }
    if (written == 0) return 0;
    const auto cells = std::span(evidence.cells).subspan(wanted.front().cells_begin, count);
    editor_.layers().known_voxels +=
        add_to_each(std::span<float* const>(voxels).first(count), cells, editor_.rules().added(0.0F));
    editor_.note(&MapCounters::applied, count);
    return written;
}

bool TermWriter::leaves_out(float term) noexcept {
    if (is_plain(term)) return false;
    editor_.note(term == 0.0F ? &MapCounters::zero : &MapCounters::not_finite);
    return true;
}

/// Creates the brick at the first voxel that needs it.
void TermWriter::write_brick(const Evidence& evidence, const BrickEvidence& brick) noexcept {
    BrickTree& log_odds = editor_.layers().log_odds;
    BrickValues* values = log_odds.own(brick.first);
    Status<MapRefusal> has_values = Done{};
    for_each_voxel(evidence, brick, [&](std::size_t cell, float term) {
        if (leaves_out(term)) return;
        const ClampedTerm added = editor_.rules().added(term);
        if (values == nullptr && has_values) {
            const BrickView before = log_odds.find(brick.first);
            if (before.values == nullptr && added.added_to(before.value) == before.value)
                // the value stays at its clamp, as in most of free space
                return editor_.note(&MapCounters::applied);
            has_values = editor_.change(brick.first, [&] { values = &log_odds.open(brick.first); });
        }
        if (values != nullptr) editor_.set((*values)[cell], added.added_to((*values)[cell]));
        editor_.note(has_values, 1);
    });
}

/// In bricks with counts, the terms go to the priors.
void TermWriter::write_priors(const Evidence& evidence, const BrickEvidence& brick) noexcept {
    MapLayers& layers = editor_.layers();
    const BrickView hits = layers.counts.hits.find(brick.first);
    const BrickView misses = layers.counts.misses.find(brick.first);
    for_each_voxel(evidence, brick, [&](std::size_t cell, float term) {
        if (leaves_out(term)) return;
        editor_.note(
            editor_.change(brick.first,
                           [&] {
                               BrickValues& values = layers.log_odds.open(brick.first);
                               BrickValues& priors = layers.counts.prior.open(brick.first);
                               VoxelState voxel{values[cell], priors[cell], hits.at(cell), misses.at(cell)};
                               editor_.rules().add(voxel, term);
                               priors[cell] = voxel.prior;
                               editor_.set(values[cell], voxel.log_odds);
                           }),
            1);
    });
}

void TermWriter::date(const Evidence& evidence) noexcept {
    VoxelAges& ages = editor_.layers().ages;
    const std::uint16_t now = ages.stamp(evidence.sensor);
    auto own = ages.own_bricks();
    for (const BrickEvidence& brick : evidence.bricks) {
        if (BrickStamps* const stamps = own.find(brick.first)) {
            for_each_voxel(evidence, brick, [&](std::size_t cell, float term) {
                if (is_plain(term)) (*stamps)[cell] = now;
            });
            continue;
        }
        BrickMask voxels{};
        for_each_voxel(evidence, brick, [&](std::size_t cell, float term) {
            if (is_plain(term)) put_in(voxels, cell);
        });
        if (voxels == BrickMask{}) continue;
        editor_.date(brick.first, voxels, evidence.sensor);
        own = ages.own_bricks();
    }
}

}  // namespace octoskin
