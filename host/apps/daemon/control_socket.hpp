// The daemon's control socket: a Unix socket with one line of request, and one line of JSON back.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

class ControlSocket {
  public:
    /// Answers a request (without its line feed) with one line (without a line feed). Not called for a client
    /// that has gone, and at most once for each client in a turn of the loop.
    using Answer = std::function<std::string(const std::string& request)>;

    /// Accepts a request that needs time: returns true, and `reply` with the ticket follows from the loop's
    /// thread. Until then nothing more is read from that client, and it does not count as idle. `user`: the
    /// client's, the overflow user if it is not visible.
    using Later = std::function<bool(const std::string& request, std::uint64_t ticket, uid_t user)>;

    /// The number of clients served at once, besides those whose question waits. A new client beyond that
    /// takes the place of one that has asked nothing, or whose half request has stopped arriving; or of one
    /// whose question was answered, if that one's process has more places than the new one's. Else the new
    /// one is refused. Of several candidates the process with the most places loses one, the one that came
    /// first. Each gets a line with the refusal.
    static constexpr std::size_t kClientsMax = 16;
    /// The number of questions that wait at once, each of another client. A further question is refused, and
    /// its client stays connected. A question that waits is never dropped for another.
    static constexpr std::size_t kWaitingMax = 16;
    /// Of these, the maximum of one user: the others are for other users' programs.
    static constexpr std::size_t kWaitingOfUserMax = 4;
    /// The number of refused clients that may finish sending before they are closed.
    static constexpr std::size_t kRefusedMax = 16;
    /// The number of this process's descriptors that clients leave free, for its files, devices and saves. A
    /// third each of the rest is for clients that are served, wait, or were refused: at most as above, and at
    /// least one.
    static constexpr std::size_t kDescriptorsLeft = 40;
    [[nodiscard]] static std::size_t clients_of_each_kind(std::uint64_t descriptors) noexcept;
    /// A longer request is answered with an error as soon as this much has arrived, and its client is then
    /// dropped.
    static constexpr std::size_t kRequestMax = 48 << 10;
    /// Unread output of a client; beyond this it is dropped.
    static constexpr std::size_t kUnreadMax = 4 << 20;

    /// A client that has asked nothing for this long is dropped; checked four times in this period. If this
    /// process has no descriptor left, no new client is accepted until the next check.
    static constexpr std::chrono::milliseconds kIdleMax{10'000};

    /// Refuses descriptors that clients pass along (passed_descriptors.hpp). `option`: the command-line
    /// option that names another place.
    [[nodiscard]] static Result<std::unique_ptr<ControlSocket>, AppError> open(
        const std::filesystem::path& file, EventLoop& loop, Answer answer,
        std::chrono::milliseconds idle_max = kIdleMax, const std::string& option = "--socket");
    ~ControlSocket();
    ControlSocket(const ControlSocket&) = delete;
    ControlSocket& operator=(const ControlSocket&) = delete;

    /// Called with the ticket of an accepted request whose client has gone: its answer is no longer needed.
    using Gone = std::function<void(std::uint64_t ticket)>;

    /// Closes all clients and accepts no new ones, which frees their resources for the last save. The name
    /// stays until destruction.
    void close_clients();

    /// From now on `later` is called first; `answer` gets the requests that it does not accept.
    void answer_later(Later later, Gone gone) {
        later_ = std::move(later);
        gone_ = std::move(gone);
    }
    /// Takes over the connection of a client, with its request; false: it stays here, and `answer` gets the
    /// request.
    using HandOver = std::function<bool(const std::string& request, int connection)>;
    /// From now on called before all others.
    void hand_over(HandOver hand_over) { hand_over_ = std::move(hand_over); }
    /// Sends the answer, without a line feed, to an accepted request. Does nothing if the client has gone.
    void reply(std::uint64_t ticket, const std::string& line);

    /// Number of clients dropped: idle for too long, or one too many; too slow to read; or with a request
    /// without end.
    [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

  private:
    struct Client {
        int descriptor = -1;       ///< -1: it is handed over
        int process = 0;           ///< 0: not visible, as one of another container
        uid_t user = 0;            ///< the overflow user if it is not visible
        std::string request;       ///< the part received so far
        HostTime asked;            ///< the newest whole request
        std::uint64_t ticket = 0;  ///< of the answer that it waits for; 0: none
        bool has_asked = false;    ///< a whole request, at least once
        bool is_refused = false;   ///< it got the refusal: its further input is read and dropped
        EventSource readable;
    };
    ControlSocket(BoundSocket bound, EventLoop& loop, Answer answer, std::chrono::milliseconds idle_max);
    void watch();
    void accept();
    /// False if the client is to be dropped.
    [[nodiscard]] bool serve(Client& client);
    void make_room();
    [[nodiscard]] std::size_t served() const;
    [[nodiscard]] std::size_t places_of(int process) const;
    [[nodiscard]] Client* one_to_go();
    void refuse(Client& client, ExitCode exit, const Error& error);
    /// Sends its answer, or leaves it for later; false if the client is to be dropped.
    [[nodiscard]] bool answer(Client& client, const std::string& request);
    [[nodiscard]] bool send(const Client& client, std::string line) const;
    void watch(Client& client);
    void drop(int descriptor);
    void drop_idle();
    /// Drops clients that have gone. Nothing is read from a client that waits for an answer, so nothing else
    /// would show it, and no other client is to be refused in its place.
    void drop_gone();

    SocketFile file_;
    int descriptor_;
    EventLoop& loop_;
    Answer answer_;
    Later later_;
    Gone gone_;
    HandOver hand_over_;
    std::uint64_t tickets_ = 0;
    std::chrono::milliseconds idle_max_;
    std::size_t clients_max_;  ///< of each kind: served, waiting and refused
    EventSource acceptable_;
    EventSource idle_check_;
    std::list<Client> clients_;
    std::uint64_t dropped_ = 0;
    bool is_resting_ = false;  ///< no descriptor was left for a new client
};

}  // namespace octoskin
