// Writes EvidenceRule::image into a map.
#pragma once

#include "host/core/mapping/brick_editor.hpp"
#include "host/core/mapping/evidence.hpp"

namespace octoskin {

class ImageWriter {
  public:
    explicit ImageWriter(BrickEditor& editor) noexcept : editor_(editor) {}

    /// Writes brick by brick. A brick is refused as a whole. About 0.1 us a brick.
    void write(const Evidence& image) noexcept;

  private:
    [[nodiscard]] Status<MapRefusal> write_brick(const Evidence& image, const BrickEvidence& brick) noexcept;
    [[nodiscard]] Status<MapRefusal> write_priors(const Evidence& image, const BrickEvidence& brick) noexcept;

    BrickEditor& editor_;
};

}  // namespace octoskin
