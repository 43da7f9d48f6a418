// System calls that may have to wait for what another program sent along: a connection that lingers, above
// all.
#pragma once

namespace octoskin::socketcan {

/// While one lives, a wait within a system call of this thread that a signal can end is ended within some
/// milliseconds: the kernel looks for signals where it waits for a connection that lingers. To live around as
/// few calls as can be, as others of them may end early, too (EINTR). One at a time in a thread. Without room
/// for a timer (`ulimit -i`) a wait is as long as it is. Two system calls to begin with, two to end with.
class ShortWaits {
  public:
    ShortWaits();
    ~ShortWaits();
    ShortWaits(const ShortWaits&) = delete;
    ShortWaits& operator=(const ShortWaits&) = delete;

    /// Does nothing else in this process. Blocked in a thread, it does nothing there outside of a ShortWaits.
    [[nodiscard]] static int signal() noexcept;
};

}  // namespace octoskin::socketcan
