// How programs of this machine ask the daemon: a Unix socket, one line of request, one line of JSON back.
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
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

class ControlSocket {
  public:
    /// Answers a request (without its line feed) with one line (without a line feed). Is not asked for a
    /// client that has gone by then, and of each client once in a turn of the loop.
    using Answer = std::function<std::string(const std::string& request)>;

    /// Takes a request that needs time: true, and `reply` with the ticket will follow, from the loop's
    /// thread. Until then nothing more is read of that client, which is not idle either. `user`: the
    /// client's, the overflow user where it cannot be seen.
    using Later = std::function<bool(const std::string& request, std::uint64_t ticket, uid_t user)>;

    /// So many are served at once, beside those whose question waits. Who comes beyond that takes the place
    /// of one that has asked nothing, or has sent half a request and no more just now; or of one whose
    /// question was answered, if that one's process has more places than the new one's. Else the new one is
    /// refused. Of several the process with the most places gives one up, the one that came first. Each is
    /// refused with a line that says so.
    static constexpr std::size_t kClientsMax = 16;
    /// So many questions wait at once, each of another client; a further one is refused, and its client
    /// served on. A question that waits is never given up for another.
    static constexpr std::size_t kWaitingMax = 16;
    /// Of them so many of one user: the others are for other users' programs.
    static constexpr std::size_t kWaitingOfUserMax = 4;
    /// So many of those who were refused may still finish what they are sending before they are closed.
    static constexpr std::size_t kRefusedMax = 16;
    /// Of the descriptors that this process may have, clients take none of so many: its files, its devices
    /// and its saves need them. Of the rest a third each is for clients that are served, wait and were
    /// refused, at most as above and at least one.
    static constexpr std::size_t kDescriptorsLeft = 40;
    [[nodiscard]] static std::size_t clients_of_each_kind(std::uint64_t descriptors) noexcept;
    /// A longer request is answered with an error, once so much of it is here, and its client then dropped.
    static constexpr std::size_t kRequestMax = 48 << 10;
    /// What a client has not read yet; beyond, it is dropped.
    static constexpr std::size_t kUnreadMax = 4 << 20;

    /// Whoever has asked nothing for so long is dropped. Looked after four times meanwhile; so long nobody
    /// new is let in while this process has no descriptor left.
    static constexpr std::chrono::milliseconds kIdleMax{10'000};

    /// Takes no descriptors that come along (passed_descriptors.hpp).
    [[nodiscard]] static Result<std::unique_ptr<ControlSocket>, AppError> open(
        const std::filesystem::path& file, EventLoop& loop, Answer answer,
        std::chrono::milliseconds idle_max = kIdleMax);
    ~ControlSocket();
    ControlSocket(const ControlSocket&) = delete;
    ControlSocket& operator=(const ControlSocket&) = delete;

    /// Is told the ticket of a request that was taken, and whose client has gone: nobody waits for its
    /// answer.
    using Gone = std::function<void(std::uint64_t ticket)>;

    /// Closes all who are there, and lets nobody new in: what they hold is free for the last save. The name
    /// stays until this goes.
    void close_clients();

    /// From now on asked before `answer`, which gets what it does not take.
    void answer_later(Later later, Gone gone) {
        later_ = std::move(later);
        gone_ = std::move(gone);
    }
    /// The answer, without a line feed, to a request that was taken. Nothing if the client has gone.
    void reply(std::uint64_t ticket, const std::string& line);

    /// Clients that were dropped: idle for too long, or one of too many; too slow to read; a request without
    /// end.
    [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

  private:
    struct Client {
        int descriptor = -1;
        int process = 0;           ///< 0: cannot be seen, as one of another container
        uid_t user = 0;            ///< the overflow user, where it cannot be seen
        std::string request;       ///< as much of it as is here
        HostTime asked;            ///< newest whole request
        std::uint64_t ticket = 0;  ///< of what it waits for; 0: nothing
        bool has_asked = false;    ///< a whole request, at least once
        bool is_refused = false;   ///< it was told why: what it still sends is read and forgotten
        EventSource readable;
    };
    ControlSocket(std::filesystem::path file, int descriptor, EventLoop& loop, Answer answer,
                  std::chrono::milliseconds idle_max);
    void watch();
    void accept();
    /// False if the client is to be dropped.
    [[nodiscard]] bool serve(Client& client);
    void make_room();
    [[nodiscard]] std::size_t served() const;
    [[nodiscard]] std::size_t places_of(int process) const;
    [[nodiscard]] Client* one_to_go();
    void refuse(Client& client, const std::string& error, ExitCode code);
    /// Its answer, or nothing yet: false if the client is to be dropped.
    [[nodiscard]] bool answer(Client& client, const std::string& request);
    [[nodiscard]] bool send(const Client& client, std::string line) const;
    void watch(Client& client);
    void drop(int descriptor);
    void drop_idle();
    /// Those who have gone: nothing is read of who waits for an answer, which would tell it, and nobody else
    /// is to be refused for them.
    void drop_gone();

    std::filesystem::path file_;
    int descriptor_;
    EventLoop& loop_;
    Answer answer_;
    Later later_;
    Gone gone_;
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
