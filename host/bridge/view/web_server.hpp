// HTTP and WebSocket on one port: the page's files, and clients of a subprotocol. One thread, asynchronous;
// no client waits for another one.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/bridge/view/admission.hpp"

namespace octoskin::view {

using ClientId = std::uint64_t;

struct WebMessage {
    std::string head;                         ///< its first bytes
    std::shared_ptr<const std::string> body;  ///< what follows, shared by several clients; may be null
    bool is_binary = false;
};

/// What clients say and get. Called from the loop.
class WebClients {
  public:
    virtual ~WebClients() = default;
    virtual void on_open(ClientId client) = 0;
    /// Empty: go on; else the client is closed.
    [[nodiscard]] virtual std::optional<Refusal> on_message(ClientId client, std::string_view message,
                                                            bool is_binary) = 0;
    /// The next message for the client; empty: there is none until WebServer::wake. It is asked for when the
    /// message before has left: for a slow client, the caller drops what is out of date.
    [[nodiscard]] virtual std::optional<WebMessage> next(ClientId client) = 0;
    /// No further call has this client.
    virtual void on_close(ClientId client) = 0;
    /// A connection that was refused, or a client that was closed. `value`: the header's, at most 200 bytes.
    virtual void on_refused(Refusal why, const std::string& value) = 0;
};

/// A file of the page.
struct WebFile {
    std::string type;  ///< "text/css; charset=utf-8"
    std::string content;
};
using WebFiles = std::map<std::string, WebFile>;  ///< by path: "/page.css"

struct WebOptions {
    std::string host = "127.0.0.1";  ///< an address of this machine, or a name that has one
    std::uint16_t port = 8765;       ///< 0: any that is free
    std::vector<std::string> origins = {};
    WebFiles files = {};
    std::string file_missing = {};  ///< the answer if "/" is not among the files
    std::size_t clients_max = 16;
    /// Connections without a whole request. A further one replaces the oldest.
    std::size_t waiting_max = 64;
    std::size_t message_bytes_max = std::size_t{1} << 20U;
    std::chrono::milliseconds handshake_max{5'000};
    /// A client that sends nothing and answers no ping for so long is closed.
    std::chrono::milliseconds silence_max{120'000};
    int send_buffer_bytes = 256 << 10;  ///< the kernel's for each client: what is in it can not be replaced
};

class WebServer {
  public:
    /// Listens. The error names the address; `clients` must outlive the server.
    [[nodiscard]] static Result<std::unique_ptr<WebServer>, AppError> open(WebOptions options,
                                                                           WebClients& clients);
    ~WebServer();
    WebServer(const WebServer&) = delete;
    WebServer& operator=(const WebServer&) = delete;

    [[nodiscard]] std::uint16_t port() const noexcept;
    /// Serves clients, and turns `loop`, until `loop` is stopped. Throws std::bad_alloc, and what a callback
    /// of `loop` throws.
    void run(EventLoop& loop);
    /// There is a message for the client. Does nothing for one that has gone.
    void wake(ClientId client);
    /// Ends a client's connection without waiting for it; it is counted as refused. Does nothing for one that
    /// has gone.
    void drop(ClientId client, Refusal why);

    class Parts;

  private:
    explicit WebServer(std::unique_ptr<Parts> parts);
    std::unique_ptr<Parts> parts_;
};

}  // namespace octoskin::view
