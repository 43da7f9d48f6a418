// Sorting networks: the sequence of comparisons does not depend on the values, so the lanes of vectors are
// sorted side by side.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace octoskin {

/// One comparison: afterwards the smaller of two values is at `low`, the larger at `high`.
struct Exchange {
    std::size_t low = 0;
    std::size_t high = 0;
};

/// Calls visit(Exchange) for each comparison of Batcher's merge exchange (Knuth, The Art of Computer
/// Programming 3, 5.2.2, algorithm M), in order.
template <class Visit>
constexpr void for_each_exchange(std::size_t count, Visit&& visit) {
    std::size_t top = 1;
    while (2 * top < count) top *= 2;
    for (std::size_t p = top; p > 0 && count > 1; p /= 2) {
        std::size_t distance = p;
        std::size_t phase = 0;
        for (std::size_t q = top; q >= p; q /= 2) {
            for (std::size_t i = 0; i + distance < count; ++i) {
                if ((i & p) == phase) visit(Exchange{i, i + distance});
            }
            distance = q - p;
            phase = p;
        }
    }
}

/// The comparisons at compile time: 26 for 9 values, 138 for 25, 383 for 49.
template <std::size_t kCount>
consteval auto sorting_network() {
    constexpr std::size_t kExchanges = [] {
        std::size_t exchanges = 0;
        for_each_exchange(kCount, [&](Exchange) { ++exchanges; });
        return exchanges;
    }();
    std::array<Exchange, kExchanges> network{};
    std::size_t next = 0;
    for_each_exchange(kCount, [&](Exchange exchange) { network[next++] = exchange; });
    return network;
}

}  // namespace octoskin
