// DepthDenoiser against its definition, pixel by pixel, with the same float operations in the same order.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "host/core/depth/depth_denoiser.hpp"
#include "tests/support/instruction_sets.hpp"

namespace octoskin {
namespace {

using Pixel = DepthDenoiser::Pixel;
using Memory = DepthDenoiser::Memory;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

CameraIntrinsics camera_of(std::uint32_t width, std::uint32_t height) {
    return {
        .width = width, .height = height, .fx = 365.0, .fy = 367.0, .cx = 0.5 * width, .cy = 0.5 * height};
}

/// Inverse depth of a pixel's mean, with its variance and weight; a NaN if the pixel has none that counts.
struct Posterior {
    float inverse = kNan;
    float variance = 0.0F;
    float weight = 0.0F;
};

/// The oracle. Knows no rows, no margins and no vectors.
class PlainDenoiser {
  public:
    PlainDenoiser(const DepthDenoiserConfig& config, const CameraIntrinsics& camera)
        : config_(config),
          width_(static_cast<int>(camera.width)),
          height_(static_cast<int>(camera.height)),
          // A surface whose normal is 63 degrees off the ray: its tangent.
          slope_(static_cast<float>(2.0 * (2.0 / (camera.fx + camera.fy)))),
          kept(camera.width * camera.height),
          changes(camera.width * camera.height) {}

    std::vector<float> denoise(const std::vector<float>& depth_m, Memory memory) {
        if (memory == Memory::of_other_place) {
            before_.assign(kept.size(), {});
        } else {
            before_ = kept;
        }
        next_.assign(kept.size(), {});
        posterior_.assign(kept.size(), {});
        used_.assign(kept.size(), false);
        for (int v = 0; v < height_; ++v)
            for (int u = 0; u < width_; ++u) take(depth_m, u, v);
        return averaged();
    }
    void keep() { kept = next_; }

  private:
    [[nodiscard]] std::size_t index(int u, int v) const { return static_cast<std::size_t>(v * width_ + u); }
    [[nodiscard]] bool is_inside(int u, int v) const { return u >= 0 && v >= 0 && u < width_ && v < height_; }
    [[nodiscard]] float sigma(float depth_m) const {
        const float beyond_m = depth_m - static_cast<float>(config_.noise.from_m);
        return static_cast<float>(config_.noise.constant_m) +
               static_cast<float>(config_.noise.quadratic_per_m) * (beyond_m * beyond_m);
    }
    [[nodiscard]] float innovation_sigma(const Pixel& pixel) const {
        return sigma(pixel.mean_m) * std::sqrt(1.0F + 1.0F / std::fabs(pixel.count));
    }
    /// Sum of the differences around a pixel, in sigmas, over the root of their number.
    [[nodiscard]] float step_at(const std::vector<float>& depth_m, int u, int v) const {
        const auto gate = static_cast<float>(config_.gate_sigmas);
        float sum = 0.0F;
        float number = 0.0F;
        for (int row = std::max(0, v - 2); row <= std::min(height_ - 1, v + 2); ++row) {
            float row_sum = 0.0F;
            for (int column = u - 2; column <= u + 2; ++column) {
                if (!is_inside(column, row)) continue;
                const Pixel& pixel = before_[index(column, row)];
                const float value = depth_m[index(column, row)];
                if (!(value > 0.0F) || pixel.count == 0.0F) continue;
                row_sum += std::clamp((value - pixel.mean_m) / innovation_sigma(pixel), -gate, gate);
                number += 1.0F;
            }
            sum += row_sum;
        }
        return sum / std::sqrt(std::max(number, 1.0F));
    }
    void take(const std::vector<float>& depth_m, int u, int v) {
        const std::size_t i = index(u, v);
        const float value = depth_m[i];
        const Pixel before = before_[i];
        Pixel& next = next_[i] = before;
        changes[i] = 0;
        if (value > 0.0F && before.count == 0.0F) {
            next = {value, 1.0F, 0.0F};
            used_[i] = true;
        } else if (value > 0.0F) {
            used_[i] = compare(value, step_at(depth_m, u, v), before, next, changes[i]);
        }
        const float count = std::fabs(next.count);
        if (!used_[i] && count <= 1.0F) return;
        const float inverse = 1.0F / next.mean_m;
        const float squared = inverse * inverse;
        const float variance = sigma(next.mean_m) * sigma(next.mean_m) / count * (squared * squared);
        posterior_[i] = {inverse, variance, 1.0F / variance};
    }
    /// A value of a pixel that has a mean. True if it is used, false if it is held back.
    [[nodiscard]] bool compare(float value, float step, const Pixel& before, Pixel& next,
                               std::uint8_t& change) const {
        const auto share = static_cast<float>(config_.drift_memory);
        const float drift = share * before.drift + (1.0F - share) * step;
        const bool has_moved = std::fabs(step) > static_cast<float>(config_.step_sigmas) ||
                               std::fabs(drift) > static_cast<float>(config_.drift_sigmas);
        const float gate_m = static_cast<float>(config_.gate_sigmas) * innovation_sigma(before);
        const bool is_inside_gate = std::fabs(value - before.mean_m) <= gate_m;
        const bool is_second = before.count < 0.0F && !is_inside_gate;
        if (has_moved || is_second) {
            next = {value, 1.0F, 0.0F};
            change = 1;
            return true;
        }
        const float count = std::fabs(before.count);
        if (!is_inside_gate) {
            next = {before.mean_m, -count, drift};
            return false;
        }
        change = count == 1.0F ? 2 : 0;
        const float more = std::min(count + 1.0F, static_cast<float>(config_.count_max));
        next = {before.mean_m + (value - before.mean_m) / more, more, drift};
        return true;
    }
    [[nodiscard]] Posterior posterior_at(int u, int v) const {
        return is_inside(u, v) ? posterior_[index(u, v)] : Posterior{};
    }
    [[nodiscard]] bool is_one_surface(float difference, float slope, float variance) const {
        const auto sigmas = static_cast<float>(config_.pair_sigmas);
        const float size = std::fabs(difference);
        return size <= slope || (size - slope) * (size - slope) <= sigmas * sigmas * variance;
    }
    /// The pixel averaged with its eight neighbours at a distance; `agreed`: how many of them.
    [[nodiscard]] Posterior average_at(int u, int v, int step, std::uint32_t& agreed) const {
        const Posterior centre = posterior_at(u, v);
        const auto sigmas = static_cast<float>(config_.pair_sigmas);
        float weights = centre.weight;
        float sum = weights * centre.inverse;
        agreed = 0;
        for (const auto& [du, dv] : {std::pair{-1, 0}, {0, -1}, {-1, -1}, {1, -1}}) {
            const Posterior a = posterior_at(u + step * du, v + step * dv);
            const Posterior b = posterior_at(u - step * du, v - step * dv);
            const float both = a.inverse + b.inverse;
            const float variance = a.variance + b.variance;
            const float bend = both - (centre.inverse + centre.inverse);
            if (!(bend * bend <= sigmas * sigmas * (variance + 4.0F * centre.variance))) continue;
            const auto sides = static_cast<float>(std::abs(dv) + std::abs(du));
            const float slope = centre.inverse * (slope_ * static_cast<float>(2 * step)) * sides;
            if (!is_one_surface(a.inverse - b.inverse, slope, variance)) continue;
            const float less = std::min(a.weight, b.weight);
            weights += less + less;
            sum += less * both;
            agreed += 2;
        }
        return {sum / weights, 1.0F / weights, weights};
    }
    [[nodiscard]] bool has_support(int u, int v, std::uint32_t agreed) const {
        const Posterior centre = posterior_at(u, v);
        std::uint32_t neighbours = 0;
        for (int dv = -2; dv <= 2; ++dv) {
            for (int du = -2; du <= 2; ++du) {
                if (du == 0 && dv == 0) continue;
                const auto steps = static_cast<float>(std::abs(dv) + std::abs(du));
                const Posterior a = posterior_at(u + du, v + dv);
                const float reach = centre.inverse * slope_ * steps;
                const bool is_near =
                    is_one_surface(a.inverse - centre.inverse, reach, a.variance + centre.variance);
                neighbours += is_near ? 1U : 0U;
            }
        }
        const auto further = static_cast<std::uint32_t>(std::fabs(next_[index(u, v)].count)) - 1;
        return further + std::max(agreed, neighbours) >= config_.support_min;
    }
    /// Averages all pixels one step after the other. Those without support, or without a new value, count
    /// for their neighbours.
    [[nodiscard]] std::vector<float> averaged() {
        std::vector<bool> has_value = used_;
        for (const int step : {1, 3, 9}) {
            std::vector<Posterior> next;
            for (int v = 0; v < height_; ++v) {
                for (int u = 0; u < width_; ++u) {
                    std::uint32_t agreed = 0;
                    next.push_back(average_at(u, v, step, agreed));
                    if (step == 1 && has_value[index(u, v)])
                        has_value[index(u, v)] = has_support(u, v, agreed);
                }
            }
            posterior_ = next;
        }
        std::vector<float> depth_m;
        for (std::size_t i = 0; i < posterior_.size(); ++i)
            depth_m.push_back(has_value[i] ? 1.0F / posterior_[i].inverse : kNan);
        return depth_m;
    }

    DepthDenoiserConfig config_;
    int width_;
    int height_;
    float slope_;
    std::vector<Pixel> before_;
    std::vector<Pixel> next_;
    std::vector<Posterior> posterior_;
    std::vector<bool> used_;

  public:
    std::vector<Pixel> kept;
    std::vector<std::uint8_t> changes;
};

/// Steps and a slope that move at times, with noise, holes, single wrong values and values between surfaces.
class NoisyScene {
  public:
    NoisyScene(unsigned seed, std::uint32_t width, std::uint32_t height)
        : random_(seed), width_(width), height_(height) {
        holes_percent_ = below(3) == 0 ? 0 : below(70);
        step_px_ = 1 + below(30);
        noise_m_ = below(4) == 0 ? 0.003F : 0.03F;
        is_in_mm_ = below(2) == 0;
    }
    DepthImage next() {
        if (below(3) == 0) nearer_m_ += 0.01F * static_cast<float>(below(12));
        if (below(5) == 0) nearer_m_ = 0.0F;
        std::normal_distribution<float> noise(0.0F, noise_m_);
        DepthImage image{.width = width_, .height = height_, .depth_m = {}};
        for (std::uint32_t v = 0; v < height_; ++v) {
            for (std::uint32_t u = 0; u < width_; ++u) {
                const std::uint32_t number = (u / step_px_ + v / step_px_) % 3;
                const float slope_m = 0.004F * static_cast<float>(u % 200);
                float depth_m = 1.4F + 0.2F * static_cast<float>(number) + slope_m + noise(random_);
                if (number == 1) depth_m -= nearer_m_;
                if (below(50) == 0) depth_m += 0.1F * static_cast<float>(below(20));
                if (is_in_mm_) depth_m = std::round(1000.0F * depth_m) / 1000.0F;
                image.depth_m.push_back(below(100) < holes_percent_ ? kNan : depth_m);
            }
        }
        return image;
    }
    std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(random_() % limit); }

  private:
    std::mt19937 random_;
    std::uint32_t width_;
    std::uint32_t height_;
    std::uint32_t holes_percent_ = 0;
    std::uint32_t step_px_ = 1;
    float noise_m_ = 0.0F;
    float nearer_m_ = 0.0F;
    bool is_in_mm_ = false;
};

std::vector<DepthDenoiserConfig> configurations() {
    DepthDenoiserConfig kinect;
    kinect.noise = {.constant_m = 0.0012, .quadratic_per_m = 0.0019, .from_m = 0.4};
    DepthDenoiserConfig forgetful;
    forgetful.drift_memory = 0.0;
    forgetful.count_max = 3;
    forgetful.support_min = 0;
    DepthDenoiserConfig strict;
    strict.gate_sigmas = 1.0;
    strict.step_sigmas = 5.0;
    strict.pair_sigmas = 1.0;
    strict.count_max = 1;
    strict.support_min = 24;
    return {{}, kinect, forgetful, strict};
}

std::uint32_t bits_of(float value) {
    return std::isnan(value) ? 0x7FC0'0000U : std::bit_cast<std::uint32_t>(value);
}

void expect_equal_bits(const std::vector<float>& values, const std::vector<float>& expected) {
    ASSERT_EQ(values.size(), expected.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        ASSERT_EQ(bits_of(values[i]), bits_of(expected[i]))
            << i << ": " << values[i] << " for " << expected[i];
}

void expect_equal_memory(const DepthDenoiser& denoiser, const std::vector<Pixel>& expected) {
    for (std::uint32_t v = 0; v < denoiser.height(); ++v) {
        for (std::uint32_t u = 0; u < denoiser.width(); ++u) {
            const Pixel pixel = denoiser.pixel(u, v);
            const Pixel& wanted = expected[std::size_t{v} * denoiser.width() + u];
            ASSERT_EQ(bits_of(pixel.mean_m), bits_of(wanted.mean_m)) << u << "," << v;
            ASSERT_EQ(bits_of(pixel.count), bits_of(wanted.count)) << u << "," << v;
            ASSERT_EQ(bits_of(pixel.drift), bits_of(wanted.drift)) << u << "," << v;
        }
    }
}

/// Images of one scene, of which some are not kept and some are from another place.
void compare(const DepthDenoiserConfig& config, unsigned seed, std::uint32_t width, std::uint32_t height) {
    const CameraIntrinsics camera = camera_of(width, height);
    DepthDenoiser denoiser(config, camera);
    PlainDenoiser plain(config, camera);
    NoisyScene scene(seed, width, height);
    for (int image_number = 0; image_number < 9; ++image_number) {
        SCOPED_TRACE(image_number);
        DepthImage image = scene.next();
        const Memory memory = scene.below(9) == 0 ? Memory::of_other_place : Memory::used;
        const std::vector<float> expected = plain.denoise(image.depth_m, memory);
        denoiser.denoise(image, memory);
        ASSERT_NO_FATAL_FAILURE(expect_equal_bits(image.depth_m, expected));
        const auto changes = denoiser.changes();
        ASSERT_TRUE(std::ranges::equal(changes, plain.changes));
        if (scene.below(4) != 0) {
            denoiser.keep();
            plain.keep();
        }
        ASSERT_NO_FATAL_FAILURE(expect_equal_memory(denoiser, plain.kept));
    }
}

TEST(DepthDenoiserReference, is_bit_for_bit_the_definition_on_every_instruction_set) {
    struct Size {
        std::uint32_t width;
        std::uint32_t height;
    };
    on_each_instruction_set([](const std::string& name) {
        unsigned seed = 0;
        for (const Size& size : {Size{1, 1}, Size{1, 9}, Size{2, 2}, Size{7, 5}, Size{17, 4}, Size{63, 6},
                                 Size{64, 3}, Size{65, 31}, Size{512, 6}, Size{40, 60}}) {
            for (const DepthDenoiserConfig& config : configurations()) {
                SCOPED_TRACE(name + " seed " + std::to_string(++seed));
                ASSERT_NO_FATAL_FAILURE(compare(config, seed, size.width, size.height));
            }
        }
    });
}

// A value is given back where it was set, and is what the next image is compared with.
TEST(DepthDenoiserReference, continues_with_pixels_that_are_set) {
    const CameraIntrinsics camera = camera_of(9, 4);
    DepthDenoiser first({}, camera);
    NoisyScene scene(7, 9, 4);
    for (int i = 0; i < 5; ++i) {
        DepthImage image = scene.next();
        first.denoise(image, Memory::used);
        first.keep();
    }
    DepthDenoiser second({}, camera);
    for (std::uint32_t v = 0; v < 4; ++v)
        for (std::uint32_t u = 0; u < 9; ++u) second.set_pixel(u, v, first.pixel(u, v));
    DepthImage one = scene.next();
    DepthImage other = one;
    first.denoise(one, Memory::used);
    second.denoise(other, Memory::used);
    expect_equal_bits(one.depth_m, other.depth_m);
    EXPECT_TRUE(std::ranges::equal(first.changes(), second.changes()));
}

}  // namespace
}  // namespace octoskin
