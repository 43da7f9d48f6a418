// The stored form of a tree's bricks: one value for all voxels, or one for each, with runs of equal values:
//
//     distance from the previous brick, in Morton order; in a block's first record: from brick 0
//     0, value                      all voxels are alike
//     1, runs until 512 voxels      n in 0..127: n + 1 values follow;
//                                   n in 128..255: n - 126 voxels (2 to 129) of the value that follows
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "host/core/bricks/brick_tree.hpp"
#include "host/io/snapshot/blocks.hpp"

namespace octoskin::snapshot {

inline constexpr std::size_t kLoneMax = 128;   ///< values after one length byte
inline constexpr std::size_t kAlikeMax = 129;  ///< voxels of one value
inline constexpr std::uint8_t kAlikeFrom = 128;

/// Values as bits: a NaN is then equal to itself.
template <class Value>
using BrickBits = std::array<BitsOf<Value>, kBrickVoxels>;

/// The number of equal values from `first` on, at most kAlikeMax.
template <class Bits>
[[nodiscard]] std::size_t alike_from(const Bits& bits, std::size_t first) noexcept {
    const std::size_t last = std::min(first + kAlikeMax, bits.size());
    std::size_t next = first + 1;
    while (next < last && bits[next] == bits[first]) ++next;
    return next - first;
}

template <class Value>
void put_values(ByteWriter& writer, const BrickValuesOf<Value>& values) {
    const auto bits = std::bit_cast<BrickBits<Value>>(values);
    for (std::size_t first = 0; first < bits.size();) {
        const std::size_t alike = alike_from(bits, first);
        if (alike > 1) {
            writer.put(static_cast<std::uint8_t>(alike + kAlikeFrom - 2));
            writer.put(bits[first]);
            first += alike;
            continue;
        }
        std::size_t end = first + 1;
        while (end < std::min(first + kLoneMax, bits.size()) && alike_from(bits, end) == 1) ++end;
        writer.put(static_cast<std::uint8_t>(end - first - 1));
        for (; first < end; ++first) writer.put(bits[first]);
    }
}

template <class Value>
void get_values(ByteReader& reader, BrickValuesOf<Value>& values) {
    for (std::size_t first = 0; first < values.size() && reader.is_sound();) {
        const auto length = reader.get<std::uint8_t>();
        const bool is_alike = length >= kAlikeFrom;
        const std::size_t count = is_alike ? std::size_t{length} - kAlikeFrom + 2 : std::size_t{length} + 1;
        if (count > values.size() - first) return reader.fail();
        Value value = is_alike ? reader.get<Value>() : Value{};
        for (const std::size_t end = first + count; first < end; ++first) {
            if (!is_alike) value = reader.get<Value>();
            values[first] = value;
        }
    }
}

/// Writes all bricks of a tree. Throws std::bad_alloc.
template <class Value>
void put_bricks(BlockWriter& blocks, BlockKind kind, const BrickTreeOf<Value>& tree) {
    std::uint64_t before = 0;
    tree.for_each([&](MortonCode brick, const BrickViewOf<Value>& view) {
        const std::uint64_t number = brick / kBrickVoxels;
        blocks.add(kind, [&](ByteWriter& writer, bool is_first) {
            writer.put_count(is_first ? number : number - before);
            writer.put_flag(view.values != nullptr);
            view.values != nullptr ? put_values(writer, *view.values) : writer.put(view.value);
        });
        before = number;
    });
}

/// Reads bricks into a tree, block by block, in ascending order.
template <class Value>
class BrickTaker {
  public:
    /// `bytes_max`: limit of the tree's heap memory, computed as if each voxel had a value of its own.
    BrickTaker(BrickTreeOf<Value>& tree, std::size_t bytes_max) noexcept
        : tree_(tree), bytes_max_(bytes_max) {}

    /// `is_possible(value)`: whether a voxel may have this value. Throws std::bad_alloc.
    template <class IsPossible>
    [[nodiscard]] BlockRead take(std::string_view payload, const IsPossible& is_possible) {
        ByteReader reader(payload);
        for (bool is_first = true; !reader.is_over(); is_first = false) {
            const std::uint64_t step = reader.get_count();
            if (!is_first && step == 0) return BlockRead::malformed;
            if (!go_to(is_first ? step : number_ + step) || !take_one(reader, is_possible))
                return BlockRead::malformed;
            const std::size_t bytes = tree_.nodes() * BrickTreeOf<Value>::kNodeBytes +
                                      tree_.bricks() * BrickTreeOf<Value>::kBrickBytes;
            if (bytes > bytes_max_) return BlockRead::no_room;
        }
        return reader.is_sound() ? BlockRead::all : BlockRead::malformed;
    }

  private:
    static constexpr std::uint64_t kBricks = (std::uint64_t{1} << 48U) / kBrickVoxels;

    [[nodiscard]] bool go_to(std::uint64_t number) noexcept {
        const bool is_further = !has_any_ || number > number_;
        has_any_ = true;
        number_ = number;
        return is_further && number < kBricks;
    }
    template <class IsPossible>
    [[nodiscard]] bool take_one(ByteReader& reader, const IsPossible& is_possible) {
        const MortonCode brick = number_ * kBrickVoxels;
        if (reader.get_flag()) {
            BrickValuesOf<Value> values;
            get_values(reader, values);
            if (!reader.is_sound() || !std::ranges::all_of(values, is_possible)) return false;
            tree_.open(brick) = values;
            return true;
        }
        const auto value = reader.get<Value>();
        if (!reader.is_sound() || UnknownValue<Value>::is(value) || !is_possible(value)) return false;
        tree_.set_all(brick, value);
        return true;
    }

    BrickTreeOf<Value>& tree_;
    std::size_t bytes_max_;
    std::uint64_t number_ = 0;
    bool has_any_ = false;
};

}  // namespace octoskin::snapshot
