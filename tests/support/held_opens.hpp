// A file system that does not answer: every open of a file, or of an entry of a folder, blocks during the
// lifetime of this object (fanotify(7), which needs CAP_SYS_ADMIN). The test's own process blocks, too.
#pragma once

#include <fcntl.h>
#include <sys/fanotify.h>
#include <unistd.h>

#include <filesystem>

namespace octoskin::testing_support {

class HeldOpens {
  public:
    explicit HeldOpens(const std::filesystem::path& place)
        : descriptor_(::fanotify_init(FAN_CLASS_CONTENT | FAN_CLOEXEC | FAN_NONBLOCK, O_RDONLY)) {
        constexpr std::uint64_t kEvents = FAN_OPEN_PERM | FAN_ONDIR | FAN_EVENT_ON_CHILD;
        is_held_ = descriptor_ >= 0 &&
                   ::fanotify_mark(descriptor_, FAN_MARK_ADD, kEvents, AT_FDCWD, place.c_str()) == 0;
    }
    ~HeldOpens() {
        if (descriptor_ >= 0) ::close(descriptor_);  // releases all that wait
    }
    HeldOpens(const HeldOpens&) = delete;
    HeldOpens& operator=(const HeldOpens&) = delete;

    /// False: this process lacks the right to block opens.
    [[nodiscard]] explicit operator bool() const noexcept { return is_held_; }

  private:
    int descriptor_;
    bool is_held_ = false;
};

}  // namespace octoskin::testing_support
