// Memory for destructors, which must not fail: nlohmann's, of an array or object, allocates some.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <exception>
#include <new>
#include <utility>

#include "host/apps/daemon/address_reserve.hpp"

namespace octoskin {

/// Reserved address space for one answer in JSON, for the thread that makes it, while this lives. The first
/// allocation of that thread that fails gets it: then there is room for all that follows, destructors
/// included.
class AnswerRoom {
  public:
    /// The answer without such room: as by query_refused(), but made without JSON.
    static constexpr const char* kRefusal =
        R"({"ok":false,"exit":69,"error":{"code":"no_resources","message":"no memory for an answer"}})";

    /// Throws std::bad_alloc if there is not enough. At most one at a time in a thread.
    explicit AnswerRoom(std::size_t bytes) : reserve_(bytes) { of_thread_ = this; }
    ~AnswerRoom() { of_thread_ = nullptr; }
    AnswerRoom(const AnswerRoom&) = delete;
    AnswerRoom& operator=(const AnswerRoom&) = delete;

    /// False if the thread has none, or has none left.
    static bool give() noexcept {
        if (of_thread_ == nullptr) return false;
        std::exchange(of_thread_, nullptr)->reserve_ = AddressReserve();
        return true;
    }

  private:
    AddressReserve reserve_;
    static inline thread_local AnswerRoom* of_thread_ = nullptr;
};

/// A reserve of the calling thread, which must spend it before it ends: automatic release would need memory.
/// While an exception propagates, failing allocations get this reserve.
class UnwindingRoom {
  public:
    /// Creates the reserve; call it again after it may have been used. Does nothing without memory.
    static void keep() noexcept {
        constexpr std::size_t kBytes = std::size_t{64} << 10U;
        (void)std::set_new_handler(&give);
        if (room_ == nullptr) room_ = std::malloc(kBytes);
    }
    /// Releases the reserve for the objects to be destroyed.
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
