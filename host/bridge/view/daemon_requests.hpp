// Requests to the daemon's control socket that do not wait: each has a connection of its own and a time
// limit.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <list>
#include <string>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/apps/daemon/event_loop.hpp"

namespace octoskin::view {

class DaemonRequests {
  public:
    /// Connections at once: the daemon lets four questions of one user wait.
    static constexpr std::size_t kAtOnce = 4;
    static constexpr std::size_t kWaitingMax = 64;
    static constexpr std::size_t kAnswerBytesMax = std::size_t{2} << 20U;

    /// The line of the answer, or a sentence.
    using Done = std::function<void(Result<std::string, std::string>)>;

    /// `loop` must outlive it.
    DaemonRequests(EventLoop& loop, std::filesystem::path socket);
    ~DaemonRequests();
    DaemonRequests(const DaemonRequests&) = delete;
    DaemonRequests& operator=(const DaemonRequests&) = delete;

    /// `line`: without a line feed, at most 48 KiB. `done` is called once, from the loop or from here, within
    /// `patience` after it is sent. Waits at most a millisecond for a daemon that accepts no connection.
    void ask(std::string line, Nanoseconds patience, Done done);
    /// Ends requests whose time is over. Call it several times a second.
    void attend();

  private:
    struct Request {
        std::string line;
        Nanoseconds patience{0};
        Done done;
        HostTime end{0};
        int descriptor = -1;
        std::string answer = {};
        EventSource readable = {};
    };
    using Requests = std::list<Request>;
    void begin_waiting();
    void begin(Request request);
    void read(Requests::iterator request);
    void finish(Requests::iterator request, Result<std::string, std::string> outcome);

    EventLoop& loop_;
    std::filesystem::path socket_;
    std::deque<Request> waiting_;
    Requests running_;
};

}  // namespace octoskin::view
