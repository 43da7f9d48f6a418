// Writes the evidence of cones' ranges into a map: hits, misses, confirmed and cleared voxels.
#pragma once

#include <span>
#include <vector>

#include "host/core/mapping/counted_brick.hpp"
#include "host/core/mapping/evidence.hpp"

namespace octoskin {

class CountWriter {
  public:
    CountWriter(BrickEditor& editor, const EvidenceOptions& options) noexcept
        : editor_(editor), options_(options), brick_(editor) {}

    /// Writes any evidence except `image` and `terms`. About 25 ns a voxel. Throws what appending to the
    /// changes throws.
    void write(const Evidence& evidence);

  private:
    /// Voxels of one brick of an evidence that were refused.
    struct Refused {
        std::size_t brick = 0;
        BrickMask voxels{};
    };

    void count(const Evidence& evidence);
    [[nodiscard]] float share_of(const CellTerm& cell, bool of_occupied) const noexcept;
    [[nodiscard]] float sum_of_shares(const Evidence& evidence, bool of_occupied) noexcept;
    void confirm(const Evidence& evidence);
    void withdraw(const Evidence& evidence);
    void clear(const Evidence& evidence);
    /// Sets the time stamps of a range's voxels, except the refused ones.
    void date_range(const Evidence& evidence, std::span<const Refused> refused) noexcept;
    void date_one(const BrickEvidence& brick, std::size_t cell) noexcept;
    /// Counts the result for a voxel. True if it was not refused.
    bool note(const BrickEvidence& brick, std::size_t cell, const Result<float, MapRefusal>& change);

    BrickEditor& editor_;
    EvidenceOptions options_;
    CountedBrick brick_;
};

}  // namespace octoskin
