// Memory for destructors, which must not fail: nlohmann's, of an array or object, asks for some.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <exception>
#include <new>
#include <utility>

namespace octoskin {

/// Of the thread that calls, which spends it before it ends: to have that done for it takes memory. While an
/// exception is on its way, what there is no memory for gets this room.
class UnwindingRoom {
  public:
    /// From now on; to be called again where it may have been used. Nothing where there is no memory.
    static void keep() noexcept {
        constexpr std::size_t kBytes = std::size_t{64} << 10U;
        (void)std::set_new_handler(&give);
        if (room_ == nullptr) room_ = std::malloc(kBytes);
    }
    /// For what is about to be destroyed.
    static void spend() noexcept { std::free(std::exchange(room_, nullptr)); }

  private:
    static void give() {
        if (std::uncaught_exceptions() == 0 || room_ == nullptr) throw std::bad_alloc();
        spend();
    }
    static inline thread_local void* room_ = nullptr;
};

}  // namespace octoskin
