// Memory for destructors, which must not fail: nlohmann's, of an array or object, asks for some.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <exception>
#include <new>
#include <utility>

#include "host/apps/daemon/address_reserve.hpp"

namespace octoskin {

/// Addresses for one answer in JSON, of the thread that makes it, for as long as this lives. The first
/// allocation of it that fails gets them: then there is room for all that follows, destructors included.
class AnswerRoom {
  public:
    /// The answer where there is no such room, as query_refused() has it, but made without JSON.
    static constexpr const char* kRefusal = R"({"ok":false,"error":"no memory for an answer","code":69})";

    /// Throws std::bad_alloc where there are not as many. At most one at a time in a thread.
    explicit AnswerRoom(std::size_t bytes) : reserve_(bytes) { of_thread_ = this; }
    ~AnswerRoom() { of_thread_ = nullptr; }
    AnswerRoom(const AnswerRoom&) = delete;
    AnswerRoom& operator=(const AnswerRoom&) = delete;

    /// False if the thread has none, or none any more.
    static bool give() noexcept {
        if (of_thread_ == nullptr) return false;
        std::exchange(of_thread_, nullptr)->reserve_ = AddressReserve();
        return true;
    }

  private:
    AddressReserve reserve_;
    static inline thread_local AnswerRoom* of_thread_ = nullptr;
};

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
        if (AnswerRoom::give()) return;
        if (std::uncaught_exceptions() == 0 || room_ == nullptr) throw std::bad_alloc();
        spend();
    }
    static inline thread_local void* room_ = nullptr;
};

}  // namespace octoskin
