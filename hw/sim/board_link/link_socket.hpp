// One end of a Unix socket that preserves message boundaries.
#pragma once

#include <optional>

#include "hw/sim/board_link/message.hpp"

namespace octoskin::sim {

class LinkSocket {
  public:
    /// Takes over an open SOCK_SEQPACKET descriptor.
    explicit LinkSocket(int descriptor) : descriptor_(descriptor) {}
    ~LinkSocket();
    LinkSocket(LinkSocket&& other) noexcept;
    LinkSocket& operator=(LinkSocket&&) = delete;

    /// Throws BoardLinkError if the other side is gone.
    void send(const BoardMessage& message);
    /// The next message; empty if the other side closed the socket. Throws BoardLinkError after 60 s without
    /// a message; the longest turn takes milliseconds.
    [[nodiscard]] std::optional<BoardMessage> receive();

  private:
    int descriptor_;
};

}  // namespace octoskin::sim
