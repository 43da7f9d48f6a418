// Reserved address space, for work that must not fail when the process has used up its limit.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <utility>

namespace octoskin {

/// A part of this process's address space and data limit (ulimit -v, ulimit -d) that nothing uses. It takes
/// no memory: none of its pages is ever touched. Destroying it frees the part for all.
class AddressReserve {
  public:
    AddressReserve() = default;  ///< reserves nothing
    /// Throws std::bad_alloc.
    explicit AddressReserve(std::size_t bytes)
        : place_(::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)),
          bytes_(bytes) {
        if (place_ == MAP_FAILED) throw std::bad_alloc();
    }
    AddressReserve(AddressReserve&& other) noexcept
        : place_(std::exchange(other.place_, MAP_FAILED)), bytes_(other.bytes_) {}
    AddressReserve& operator=(AddressReserve&& other) noexcept {
        std::swap(place_, other.place_);
        std::swap(bytes_, other.bytes_);
        return *this;
    }
    ~AddressReserve() {
        if (place_ != MAP_FAILED) (void)::munmap(place_, bytes_);
    }

  private:
    void* place_ = MAP_FAILED;
    std::size_t bytes_ = 0;
};

}  // namespace octoskin
