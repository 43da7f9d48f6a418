// Writes EvidenceRule::weaken into a map.
#pragma once

#include <vector>

#include "host/core/mapping/brick_editor.hpp"
#include "host/core/mapping/evidence.hpp"

namespace octoskin {

class WeakeningWriter {
  public:
    WeakeningWriter(BrickEditor& editor, const EvidenceOptions& options) noexcept
        : editor_(editor), changes_(options.changes) {}

    /// Writes brick by brick. Voxels that the rule does not change are not counted.
    void write(const Evidence& evidence) noexcept;

  private:
    /// The voxels of the brick that the rule changes.
    [[nodiscard]] BrickMask changed_in(const BrickEvidence& brick) const noexcept;
    void write_brick(MortonCode brick, const BrickMask& voxels, float term);

    BrickEditor& editor_;
    std::vector<VoxelUpdate>* changes_;
};

}  // namespace octoskin
