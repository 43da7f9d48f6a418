// Who listens at a Unix socket as a daemon does that is stopped: nobody is let in.
#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <vector>

#include "host/apps/daemon/unix_socket.hpp"

namespace octoskin::testing_support {

/// What is done with who knocks is the test's.
class StoppedListener {
  public:
    explicit StoppedListener(const std::filesystem::path& file)
        : descriptor_(bind_unix_socket(file, SOCK_STREAM).value().descriptor), file_(file) {}
    ~StoppedListener() {
        for (const int waiting : waiting_) ::close(waiting);
        ::close(descriptor_);
    }
    StoppedListener(const StoppedListener&) = delete;
    StoppedListener& operator=(const StoppedListener&) = delete;
    [[nodiscard]] int descriptor() const { return descriptor_; }
    /// The next client, once it is there; -1 after 5 s without one. The caller closes it.
    [[nodiscard]] int accept() const {
        pollfd knocking{descriptor_, POLLIN, 0};
        (void)::poll(&knocking, 1, 5'000);
        return ::accept(descriptor_, nullptr, nullptr);
    }
    /// Until nobody else has room.
    void fill() {
        for (auto knocking = connect_unix_socket(file_, SOCK_STREAM, std::chrono::milliseconds{10}); knocking;
             knocking = connect_unix_socket(file_, SOCK_STREAM, std::chrono::milliseconds{10}))
            waiting_.push_back(*knocking);
    }

  private:
    int descriptor_;
    std::filesystem::path file_;
    std::vector<int> waiting_;
};

}  // namespace octoskin::testing_support
