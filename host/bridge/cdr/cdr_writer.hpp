// Writes a message in the encoding of ROS 2: CDR (XCDR1), little-endian, with its header of four bytes.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace octoskin::cdr {

static_assert(std::endian::native == std::endian::little, "bytes are copied as they are");

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::array<std::uint8_t, 4> kHeader = {0, 1, 0, 0};

template <class T>
concept Number = std::is_arithmetic_v<T>;
template <class T>
concept Message = requires(T& message) {
    message.all_fields();
};

class Writer {
  public:
    Writer() : bytes_(kHeader.begin(), kHeader.end()) {}

    void put(Number auto value) {
        align(sizeof(value));
        append(&value, sizeof(value));
    }
    void put(const std::string& text) {
        put(static_cast<std::uint32_t>(text.size() + 1));
        append(text.c_str(), text.size() + 1);
    }
    template <class T>
    void put(const std::vector<T>& values) {
        put(static_cast<std::uint32_t>(values.size()));
        put_each(values.data(), values.size());
    }
    template <class T, std::size_t kSize>
    void put(const std::array<T, kSize>& values) {
        put_each(values.data(), kSize);
    }
    void put(const Message auto& message) {
        std::apply([this](const auto&... field) { (this->put(field), ...); }, message.all_fields());
    }

    [[nodiscard]] Bytes take() && { return std::move(bytes_); }

  private:
    template <class T>
    void put_each(const T* values, std::size_t count) {
        if constexpr (Number<T>) {
            if (count == 0) return;
            align(sizeof(T));
            append(values, count * sizeof(T));
        } else {
            for (std::size_t i = 0; i < count; ++i) put(values[i]);
        }
    }
    /// Counted from the end of the header.
    void align(std::size_t size) {
        while ((bytes_.size() - kHeader.size()) % size != 0) bytes_.push_back(0);
    }
    void append(const void* data, std::size_t size) {
        const auto* const begin = static_cast<const std::uint8_t*>(data);
        bytes_.insert(bytes_.end(), begin, begin + size);
    }

    Bytes bytes_;
};

/// A sequence has at most 2^32 - 1 elements (not checked). O(bytes). Throws std::bad_alloc.
[[nodiscard]] Bytes write(const Message auto& message) {
    Writer writer;
    writer.put(message);
    return std::move(writer).take();
}

}  // namespace octoskin::cdr
