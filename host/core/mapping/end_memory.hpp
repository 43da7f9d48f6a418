// Where the pixels of a stationary camera ended last, so that evidence of an earlier, less exact estimate is
// taken back.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "host/core/mapping/evidence.hpp"
#include "host/core/traversal/projected_image.hpp"

namespace octoskin {

/// The images of a denoised camera are not independent: each pixel's depth is an estimate from all images so
/// far, and a new estimate replaces the last one. So a voxel is retracted if a pixel ended in it and now ends
/// elsewhere, unless another pixel ends there now, or ended there when it last had a value. If the pixel's
/// surface has changed, the image after the one that found it decides: one wrong image takes nothing. If the
/// new surface is nearer, it hides the voxel and states nothing about it.
class EndMemory {
  public:
    EndMemory() = default;
    /// `keep` needs no further memory for images of so many pixels.
    explicit EndMemory(std::size_t pixels) { ends_.reserve(pixels); }

    /// Last end of a pixel: its voxel as in ProjectedImage, and its depth, metres.
    struct End {
        std::uint32_t key_xy = 0;
        std::uint32_t key_z = ProjectedImage::kNoKey;
        float depth_m = 0.0F;
        friend bool operator==(const End&, const End&) = default;
    };

    /// Replaces `retracted` with EvidenceRule::weaken, by all that they have, for the voxels that an image
    /// from the same place as the remembered ones retracts. `terms`: the image's evidence. `changes`: as of
    /// DepthDenoiser, one entry for each pixel (asserted), likewise for `keep`. About 1.2 ms for 512 x 424.
    /// Throws std::bad_alloc.
    void find(const ProjectedImage& image, std::span<const std::uint8_t> changes, const Evidence& terms,
              Evidence& retracted);
    /// Remembers the ends of an image, but for those that are in doubt. Throws std::bad_alloc if it has no
    /// room yet.
    void keep(const ProjectedImage& image, std::span<const std::uint8_t> changes);
    /// The camera has moved.
    void forget() noexcept { ends_.clear(); }

    /// Row-major; empty if nothing is remembered.
    [[nodiscard]] std::span<const End> ends() const noexcept { return ends_; }
    void resume_with(std::vector<End> ends) noexcept { ends_ = std::move(ends); }

  private:
    /// Pixels; valid until the next image.
    struct Changed {
        std::span<const std::uint32_t> left;  ///< have left their voxel and state that its surface has gone
        std::span<const std::uint32_t> held;  ///< still state what they did: without a value now, or in doubt
    };
    [[nodiscard]] Changed find_changed(const ProjectedImage& image, std::span<const std::uint8_t> changes);
    /// The voxels of the last ends of `pixels`, in Morton order, each once.
    void take_codes(std::span<const std::uint32_t> pixels, std::vector<MortonCode>& codes) const;
    void keep_hit(const Evidence& terms);

    std::vector<End> ends_;
    std::vector<std::uint32_t> left_pixels_;
    std::vector<std::uint32_t> held_pixels_;
    std::vector<MortonCode> left_;
    std::vector<MortonCode> held_;
};

}  // namespace octoskin
