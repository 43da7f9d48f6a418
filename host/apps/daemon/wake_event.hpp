// Wakes the event loop from another thread.
#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace octoskin {

/// An eventfd: readable from `wake` until `clear`. Both from any thread, and neither waits.
class WakeEvent {
  public:
    /// Throws std::system_error if there is no descriptor left.
    WakeEvent() : descriptor_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
        if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
    }
    ~WakeEvent() { ::close(descriptor_); }
    WakeEvent(const WakeEvent&) = delete;
    WakeEvent& operator=(const WakeEvent&) = delete;

    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    void wake() const noexcept { (void)::eventfd_write(descriptor_, 1); }
    void clear() const noexcept {
        eventfd_t count = 0;
        (void)::eventfd_read(descriptor_, &count);
    }

  private:
    int descriptor_;
};

}  // namespace octoskin
