// Writes EvidenceRule::terms, usually those of rays, into a map.
#pragma once

#include <cstddef>

#include "host/core/mapping/brick_editor.hpp"
#include "host/core/mapping/evidence.hpp"

namespace octoskin {

class TermWriter {
  public:
    explicit TermWriter(BrickEditor& editor) noexcept : editor_(editor) {}

    /// Writes term by term, in order. About 5 ns a voxel of a ray in known space.
    void write(const Evidence& evidence) noexcept;

  private:
    [[nodiscard]] std::size_t write_owned(const Evidence& evidence, std::size_t from) noexcept;
    /// True for a term that is 0 or not finite, which it counts; false for any other term.
    [[nodiscard]] bool leaves_out(float term) noexcept;
    void write_brick(const Evidence& evidence, const BrickEvidence& brick) noexcept;
    void write_priors(const Evidence& evidence, const BrickEvidence& brick) noexcept;
    void date(const Evidence& evidence) noexcept;

    BrickEditor& editor_;
};

}  // namespace octoskin
