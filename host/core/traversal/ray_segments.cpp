#include "host/core/traversal/ray_segments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/core/traversal/sliding_minimum.hpp"

namespace octoskin {
namespace {

/// Squares of this width and more are composed of blocks of pixels.
constexpr std::uint32_t kBlock = 4;
constexpr std::uint32_t kBlockRadius = 8;
/// Ratio of the depths at an interval's end and beginning.
constexpr double kRungRatio = 1.2;

Raster blocks_of(const ProjectedImage& image) {
    return {(image.width + kBlock - 1) / kBlock, (image.height + kBlock - 1) / kBlock};
}

std::vector<float> shortest_of_blocks(const ProjectedImage& image, const std::vector<float>& passed_m) {
    const Raster blocks = blocks_of(image);
    std::vector<float> shortest(std::size_t{blocks.width} * blocks.height,
                                std::numeric_limits<float>::infinity());
    for (std::uint32_t v = 0; v < image.height; ++v) {
        const float* const row = passed_m.data() + std::size_t{v} * image.width;
        float* const out = shortest.data() + std::size_t{v / kBlock} * blocks.width;
        for (std::uint32_t u = 0; u < image.width; ++u) out[u / kBlock] = std::min(out[u / kBlock], row[u]);
    }
    return shortest;
}

/// Joins the intervals in which a ray must be walked.
class Pieces {
  public:
    /// `open_m`: begin of an open interval; negative: none.
    explicit Pieces(float open_m) : open_m_(open_m) {}

    [[nodiscard]] float open_m() const noexcept { return open_m_; }

    /// Adds the interval from `from_m` to `to_m`, in which the ray needs no walk before `safe_m`.
    template <class Emit>
    void add(float from_m, float to_m, float safe_m, Emit&& emit) {
        if (safe_m > from_m) {
            end(from_m, emit);
            if (safe_m < to_m) open_m_ = safe_m;
        } else if (open_m_ < 0.0F) {
            open_m_ = from_m;
        }
    }
    template <class Emit>
    void end(float at_m, Emit&& emit) {
        if (open_m_ >= 0.0F && at_m > open_m_) emit(open_m_, at_m);
        open_m_ = -1.0F;
    }

  private:
    float open_m_;
};

}  // namespace

void RaySegments::set_rungs(const CertainView& view, const ProjectedImage& image) {
    near_.clear();
    far_.clear();
    const CameraIntrinsics& camera = view.camera;
    const double focal_max = std::max(camera.fx, camera.fy);
    const double x = std::max(camera.cx, camera.width - camera.cx) / camera.fx;
    const double y = std::max(camera.cy, camera.height - camera.cy) / camera.fy;
    // A point and the centre of its voxel are at most `radius_m` apart. The angle at which this distance is
    // seen grows with the distance from the optical axis.
    const double spread_m = view.radius_m * std::sqrt(1.0 + std::max(x * x, y * y));
    const double reach_max_m =
        static_cast<double>(*std::max_element(image.reach_m.begin(), image.reach_m.end()));
    const std::uint32_t everywhere = std::max(camera.width, camera.height);
    double to_m = std::min(view.depth_max_m - view.radius_m, reach_max_m);
    while (to_m > 0.0) {
        double from_m = to_m / kRungRatio;
        const double apart_px = focal_max * spread_m / std::max(from_m - view.radius_m, 1e-9);
        const bool is_first = apart_px > 0.5 * everywhere;
        if (is_first) from_m = 0.0;
        Rung rung{.from_m = static_cast<float>(from_m),
                  .to_m = static_cast<float>(to_m),
                  .radius_px = is_first ? everywhere : static_cast<std::uint32_t>(apart_px + 0.51),
                  .safe_m = {}};
        (rung.radius_px < kBlockRadius ? far_ : near_).push_back(std::move(rung));
        to_m = from_m;
    }
}

void RaySegments::fill_rungs(const CertainView& view, const ProjectedImage& image) {
    const auto kept_clear = static_cast<float>(view.half_depth_m + 2.0 * view.margin_m);
    const auto fill = [&](std::vector<Rung>& rungs, std::vector<float> shortest, const Raster& raster,
                          std::uint32_t pixels) {
        std::uint32_t had = 0;
        for (Rung& rung : rungs) {  // from far to near: the squares grow
            const std::uint32_t radius = (rung.radius_px + pixels - 1) / pixels;
            spread_minimum(shortest, rows_, raster, had, radius);
            had = std::max(had, radius);
            rung.safe_m.resize(shortest.size());
            for (std::size_t i = 0; i < shortest.size(); ++i) rung.safe_m[i] = shortest[i] - kept_clear;
        }
        std::ranges::reverse(rungs);
    };
    // For a voxel whose nearest pixel has no ray, the other pixels decide.
    std::vector<float> passed_m(std::size_t{image.width} * image.height);
    for (std::size_t i = 0; i < passed_m.size(); ++i) {
        passed_m[i] = image.reach_m[i] < 0.0F ? std::numeric_limits<float>::infinity() : image.passed_m[i];
    }
    fill(near_, shortest_of_blocks(image, passed_m), blocks_of(image), kBlock);
    fill(far_, std::move(passed_m), {image.width, image.height}, 1);
}

void RaySegments::find_pieces(const CertainView& view, const ProjectedImage& image,
                              std::vector<RayPiece>& pieces) {
    constexpr float kEnd = std::numeric_limits<float>::infinity();
    set_rungs(view, image);
    fill_rungs(view, image);
    const Raster blocks = blocks_of(image);
    const float last_m = !far_.empty() ? far_.back().to_m : !near_.empty() ? near_.back().to_m : 0.0F;
    for (std::uint32_t block_v = 0; block_v < blocks.height; ++block_v) {
        for (std::uint32_t block_u = 0; block_u < blocks.width; ++block_u) {
            const std::size_t block = std::size_t{block_v} * blocks.width + block_u;
            block_pieces_.clear();
            Pieces of_block(0.0F);
            for (const Rung& rung : near_) {
                of_block.add(rung.from_m, rung.to_m, rung.safe_m[block], [&](float from_m, float to_m) {
                    block_pieces_.push_back({0, from_m, to_m});
                });
            }
            const std::uint32_t u_end = std::min((block_u + 1) * kBlock, image.width);
            const std::uint32_t v_end = std::min((block_v + 1) * kBlock, image.height);
            for (std::uint32_t v = block_v * kBlock; v < v_end; ++v) {
                for (std::uint32_t u = block_u * kBlock; u < u_end; ++u) {
                    const std::uint32_t pixel = v * image.width + u;
                    const float reach_m = image.reach_m[pixel];
                    if (reach_m < 0.0F) continue;
                    const auto emit = [&](float from_m, float to_m) {
                        if (from_m < reach_m) pieces.push_back({pixel, from_m, to_m < reach_m ? to_m : kEnd});
                    };
                    for (const RayPiece& piece : block_pieces_) emit(piece.from_m, piece.to_m);
                    Pieces of_pixel(of_block.open_m());
                    for (const Rung& rung : far_)
                        of_pixel.add(rung.from_m, rung.to_m, rung.safe_m[pixel], emit);
                    if (of_pixel.open_m() < 0.0F) of_pixel.add(last_m, kEnd, 0.0F, emit);
                    of_pixel.end(kEnd, emit);
                }
            }
        }
    }
}

}  // namespace octoskin
