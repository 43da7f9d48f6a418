// Reads a message in the encoding of ROS 2: CDR (XCDR1), little-endian. Safe for any bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "host/bridge/cdr/cdr_writer.hpp"

namespace octoskin::cdr {

enum class Fault : std::uint8_t {
    encoding,    ///< not CDR, or big-endian
    too_short,   ///< the bytes end within a field, or a length goes beyond them
    bad_string,  ///< a string without its terminating zero
};
[[nodiscard]] constexpr const char* describe(Fault fault) noexcept {
    switch (fault) {
        case Fault::encoding:
            return "is not encoded as little-endian CDR";
        case Fault::too_short:
            return "ends too early";
        case Fault::bad_string:
            return "has a string without an end";
    }
    return "";
}

/// The fewest bytes that a value can have: bounds the memory of a sequence by the bytes received.
template <class T>
struct LeastBytes;
template <Number T>
struct LeastBytes<T> {
    static constexpr std::size_t kValue = sizeof(T);
};
template <>
struct LeastBytes<std::string> {
    static constexpr std::size_t kValue = 4;
};
template <class T>
struct LeastBytes<std::vector<T>> {
    static constexpr std::size_t kValue = 4;
};
template <class T, std::size_t kSize>
struct LeastBytes<std::array<T, kSize>> {
    static constexpr std::size_t kValue = kSize * LeastBytes<T>::kValue;
};
template <Message T>
struct LeastBytes<T> {
    template <class... Field>
    static constexpr std::size_t sum(std::tuple<Field&...>*) {
        return (LeastBytes<Field>::kValue + ... + 0U);
    }
    static constexpr std::size_t kValue =
        sum(static_cast<decltype(std::declval<T&>().all_fields())*>(nullptr));
};

class Reader {
  public:
    /// `bytes`: behind the header; they must outlive the reader.
    explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    /// The first fault; what is read after it has no meaning.
    [[nodiscard]] const std::optional<Fault>& fault() const noexcept { return fault_; }

    template <Number T>
    void get(T& value) {
        align(sizeof(T));
        if constexpr (std::is_same_v<T, bool>) {
            std::uint8_t byte = 0;
            copy(&byte, 1);
            value = byte != 0;
        } else {
            copy(&value, sizeof(T));
        }
    }
    void get(std::string& text) {
        const std::size_t size = get_length(1);
        if (fault_ || size == 0) return;  // some writers give an empty string no zero
        const auto* const begin = reinterpret_cast<const char*>(bytes_.data() + at_);
        if (begin[size - 1] != '\0') return fail(Fault::bad_string);
        text.assign(begin, std::strlen(begin));
        at_ += size;
    }
    template <class T>
    void get(std::vector<T>& values) {
        const std::size_t size = get_length(LeastBytes<T>::kValue);
        if (fault_) return;
        values.resize(size);
        get_each(values.data(), size);
    }
    template <class T, std::size_t kSize>
    void get(std::array<T, kSize>& values) {
        get_each(values.data(), kSize);
    }
    void get(Message auto& message) {
        std::apply([this](auto&... field) { (this->get(field), ...); }, message.all_fields());
    }

  private:
    template <class T>
    void get_each(T* values, std::size_t count) {
        if constexpr (Number<T>) {
            if (count == 0) return;
            align(sizeof(T));
            copy(values, count * sizeof(T));
        } else {
            for (std::size_t i = 0; i < count && !fault_; ++i) get(values[i]);
        }
    }
    [[nodiscard]] std::size_t get_length(std::size_t least_bytes) {
        std::uint32_t length = 0;
        get(length);
        if (!fault_ && length > left() / least_bytes) fail(Fault::too_short);
        return fault_ ? 0 : length;
    }
    void align(std::size_t size) { at_ += (size - at_ % size) % size; }
    void copy(void* to, std::size_t size) {
        if (fault_) return;
        if (size > left()) return fail(Fault::too_short);
        std::memcpy(to, bytes_.data() + at_, size);
        at_ += size;
    }
    [[nodiscard]] std::size_t left() const noexcept { return at_ < bytes_.size() ? bytes_.size() - at_ : 0; }
    void fail(Fault fault) {
        if (!fault_) fault_ = fault;
    }

    std::span<const std::uint8_t> bytes_;
    std::size_t at_ = 0;
    std::optional<Fault> fault_;
};

/// Bytes behind the last field are ignored: a newer version of the type may have more fields. O(bytes).
/// Memory: a small multiple of the bytes. Throws std::bad_alloc.
template <Message T>
[[nodiscard]] Result<T, Fault> read(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < kHeader.size()) return unexpected(Fault::too_short);
    if (bytes[0] != kHeader[0] || bytes[1] != kHeader[1]) return unexpected(Fault::encoding);
    Reader reader(bytes.subspan(kHeader.size()));
    T message;
    reader.get(message);
    if (reader.fault()) return unexpected(*reader.fault());
    return message;
}

}  // namespace octoskin::cdr
