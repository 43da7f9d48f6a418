// Writes EvidenceRule::retract into a map.
#pragma once

#include "host/core/mapping/brick_editor.hpp"
#include "host/core/mapping/evidence.hpp"

namespace octoskin {

class RetractionWriter {
  public:
    explicit RetractionWriter(BrickEditor& editor) noexcept : editor_(editor) {}

    /// Writes brick by brick. Voxels that the rule does not change are not counted.
    void write(const Evidence& evidence) noexcept;

  private:
    /// The voxels of the brick that the rule changes.
    [[nodiscard]] BrickMask changed_in(const BrickEvidence& brick) const noexcept;
    void write_brick(MortonCode brick, const BrickMask& voxels);

    BrickEditor& editor_;
};

}  // namespace octoskin
