// Limits the wait of system calls that may have to wait for something that another program has sent, mainly a
// lingering connection.
#pragma once

namespace octoskin::socketcan {

/// During the lifetime of this object, an interruptible wait in a system call of this thread ends within some
/// milliseconds: the kernel checks for signals while it waits for a lingering connection. Use it around as
/// few calls as possible, because other calls may end early, too (EINTR). One at a time in a thread. If no
/// timer is available (`ulimit -i`), waits are not limited. Cost: two system calls at the beginning, two at
/// the end.
class ShortWaits {
  public:
    ShortWaits();
    ~ShortWaits();
    ShortWaits(const ShortWaits&) = delete;
    ShortWaits& operator=(const ShortWaits&) = delete;

    /// The signal has no other use in this process. If a thread blocks it, it has no effect outside of a
    /// ShortWaits.
    [[nodiscard]] static int signal() noexcept;
};

}  // namespace octoskin::socketcan
