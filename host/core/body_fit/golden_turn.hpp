// Multiples of the golden angle, for points spread evenly over a sphere or a cylinder (Fibonacci lattice).
#pragma once

namespace octoskin {

/// Cosine and sine of 0, 1, 2, ... golden angles, without the library's functions: their last digit depends
/// on the processor, and a search that compares numbers would end elsewhere. Off by less than 1e-9 after
/// 100,000 turns.
class GoldenTurn {
  public:
    [[nodiscard]] double cosine() const noexcept { return cosine_; }
    [[nodiscard]] double sine() const noexcept { return sine_; }
    void advance() noexcept {
        constexpr double kCosine = -0.73736887807831990;  // of pi * (3 - sqrt(5))
        constexpr double kSine = 0.67549029426152362;
        const double next = kCosine * cosine_ - kSine * sine_;
        sine_ = kSine * cosine_ + kCosine * sine_;
        cosine_ = next;
    }

  private:
    double cosine_ = 1.0;
    double sine_ = 0.0;
};

}  // namespace octoskin
