#include "host/core/depth/sorting_network.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>

namespace octoskin {
namespace {

/// A network that sorts every sequence of zeros and ones sorts every sequence (Knuth, The Art of Computer
/// Programming 3, 5.3.4, theorem Z). Bit i of `values` is value i.
template <std::size_t kCount>
std::uint32_t sorted_bits(std::uint32_t values) {
    for (const auto [low, high] : sorting_network<kCount>()) {
        const std::uint32_t moves = (values >> low) & ~(values >> high) & 1U;
        values ^= moves << low | moves << high;
    }
    return values;
}

template <std::size_t kCount>
void expect_all_sorted() {
    for (std::uint32_t values = 0; values < 1U << kCount; ++values) {
        const std::uint32_t ones = static_cast<std::uint32_t>(std::popcount(values));
        const std::uint32_t expected = ((1U << ones) - 1U) << (kCount - ones);
        ASSERT_EQ(sorted_bits<kCount>(values), expected) << values;
    }
}

TEST(SortingNetwork, sorts_all_zeros_and_ones_and_therefore_everything) {
    expect_all_sorted<1>();
    expect_all_sorted<2>();
    expect_all_sorted<9>();
    expect_all_sorted<13>();
}

}  // namespace
}  // namespace octoskin
