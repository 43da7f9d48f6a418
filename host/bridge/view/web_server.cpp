#include "host/bridge/view/web_server.hpp"

// The only source with Boost: it takes half a minute to compile.
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <algorithm>
#include <utility>

namespace octoskin::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::uint32_t kHeaderBytesMax = 16U << 10U;
constexpr std::size_t kValueShown = 200;
constexpr const char* kPolicy =
    "default-src 'self'; connect-src 'self' ws://localhost:* ws://127.0.0.1:*; worker-src "
    "'self'; img-src 'self' data: blob:; style-src "
    "'self'; frame-ancestors 'none'";

/// Messages up to this size are one frame: few libraries are tested with fragments.
constexpr std::size_t kWholeBytes = std::size_t{1} << 20U;
constexpr std::size_t kFragmentBytes = std::size_t{64} << 10U;

/// A connection that Beast ends without waiting for the other end: a client that sends malformed frames and
/// stays would else be counted as silent, after the limit of silence.
class Stream : public beast::tcp_stream {
  public:
    using beast::tcp_stream::tcp_stream;
    explicit Stream(tcp::socket&& socket) : beast::tcp_stream(std::move(socket)) {}
};
template <class Handler>
void async_teardown(beast::role_type, Stream& stream, Handler&& handler) {
    error_code ignored;
    stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
    asio::post(stream.get_executor(),
               beast::bind_front_handler(std::forward<Handler>(handler), error_code()));
}

std::string_view value_of(beast::string_view value) {
    return {value.data(), value.size()};
}

/// What a WebSocket's error means; empty: the client has gone.
std::optional<Refusal> refusal_of(const error_code& error) {
    if (error == beast::error::timeout) return Refusal::silent;
    if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow)
        return Refusal::too_large;
    if (error == websocket::condition::protocol_violation || error == websocket::condition::handshake_failed)
        return Refusal::malformed;
    return std::nullopt;
}

}  // namespace

/// The server's state, which its sessions share.
class WebServer::Parts {
  public:
    class Session;

    Parts(WebOptions given, WebClients& served) : options(std::move(given)), clients(served) {}

    [[nodiscard]] Status<AppError> listen();
    void accept();
    void on_accepted(const error_code& error, tcp::socket socket);
    /// Makes room for one more connection: the oldest without a whole request is closed.
    void make_room();
    void turn(EventLoop& loop);
    void end_session(ClientId id);
    void refuse(Refusal why, std::string_view value) {
        clients.on_refused(why, std::string(value.substr(0, kValueShown)));
    }

    WebOptions options;
    WebClients& clients;
    asio::io_context io{1};
    tcp::acceptor acceptor{io};
    asio::steady_timer rest{io};
    std::optional<asio::posix::stream_descriptor> loop_ready;
    std::uint16_t port = 0;
    std::optional<Admission> admission;
    ClientId next_id = 1;
    std::map<ClientId, std::shared_ptr<Session>> waiting;  ///< without a whole request, or getting a file
    std::map<ClientId, std::shared_ptr<Session>> open;     ///< WebSockets
};

/// One connection: a request, and then a file or a WebSocket.
class WebServer::Parts::Session : public std::enable_shared_from_this<Session> {
  public:
    Session(Parts& parts, ClientId id, tcp::socket socket)
        : parts_(parts), id_(id), socket_(std::move(socket)) {}

    void begin();
    void pump();
    /// Ends the connection at once.
    void cut() { stream().close(); }
    void drop(Refusal why);
    [[nodiscard]] bool is_open() const noexcept { return is_open_; }

  private:
    using Response = http::response<http::string_body>;
    [[nodiscard]] Stream& stream() { return beast::get_lowest_layer(socket_); }
    void on_request(const error_code& error);
    void on_bad_request(const error_code& error);
    void take_request();
    [[nodiscard]] bool has_one(http::field field) const;
    [[nodiscard]] bool is_foreign();
    void upgrade();
    void on_upgraded(const error_code& error);
    void send_file();
    void refuse(http::status status, Refusal why, std::string_view value, const std::string& sentence);
    void respond(http::status status, const std::string& type, std::string content);
    void read();
    void on_read(const error_code& error);
    void close(Refusal why);
    void end(const error_code& error);

    Parts& parts_;
    ClientId id_;
    websocket::stream<Stream> socket_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::empty_body>> parser_{std::in_place};
    Response response_;
    WebMessage sending_;
    bool is_sending_ = false;
    bool is_open_ = false;
    bool is_closing_ = false;
};

using Session = WebServer::Parts::Session;

void Session::begin() {
    stream().expires_after(parts_.options.handshake_max);
    parser_->header_limit(kHeaderBytesMax);
    http::async_read_header(
        stream(), buffer_, *parser_,
        [self = shared_from_this()](const error_code& error, std::size_t) { self->on_request(error); });
}

void Session::on_request(const error_code& error) {
    if (error) return on_bad_request(error);
    take_request();
}

void Session::on_bad_request(const error_code& error) {
    if (error == beast::error::timeout) parts_.refuse(Refusal::silent, "");
    if (error == http::error::header_limit || error == http::error::buffer_overflow)
        return refuse(http::status::request_header_fields_too_large, Refusal::too_large, "headers",
                      "The headers are too long.");
    const bool is_http = error.category() == http::make_error_code(http::error::bad_method).category();
    if (is_http && error != http::error::end_of_stream && error != http::error::partial_message)
        return refuse(http::status::bad_request, Refusal::malformed, error.message(), "This is no HTTP.");
    parts_.end_session(id_);
}

bool Session::has_one(http::field field) const {
    return parser_->get().count(field) == 1;
}

/// Whether another machine's name or another page's origin leads here; then it is answered.
bool Session::is_foreign() {
    const auto& request = parser_->get();
    const std::string_view host = value_of(request[http::field::host]);
    if (!has_one(http::field::host) || !parts_.admission->takes_host(host)) {
        refuse(http::status::forbidden, Refusal::host, host,
               "The name in the address is not one of this server: use localhost, 127.0.0.1 or what "
               "--host names, with the server's port.");
        return true;
    }
    const bool has_origin = request.count(http::field::origin) > 0;
    const std::string_view origin = value_of(request[http::field::origin]);
    if (request.count(http::field::origin) > 1 ||
        !parts_.admission->takes_origin(has_origin ? std::optional(origin) : std::nullopt)) {
        refuse(http::status::forbidden, Refusal::origin, origin,
               "Pages of this origin are not accepted. To accept it: octoskin view --allow-origin ORIGIN");
        return true;
    }
    return false;
}

void Session::take_request() {
    if (is_foreign()) return;
    if (buffer_.size() > 0)  // a client waits for the answer before it says more
        return refuse(http::status::bad_request, Refusal::malformed, "bytes behind the headers",
                      "A request must have no body.");
    websocket::is_upgrade(parser_->get()) ? upgrade() : send_file();
}

void Session::upgrade() {
    const auto& request = parser_->get();
    const std::string_view offered = value_of(request[http::field::sec_websocket_protocol]);
    const auto subprotocol = Admission::subprotocol(offered);
    if (!subprotocol)
        return refuse(http::status::bad_request, Refusal::subprotocol, offered,
                      "The subprotocol must be foxglove.sdk.v1 or foxglove.websocket.v1.");
    if (parts_.open.size() >= parts_.options.clients_max)
        return refuse(http::status::service_unavailable, Refusal::too_many, "",
                      "All places for clients are taken: close another one.");
    parts_.open.emplace(id_, shared_from_this());
    parts_.waiting.erase(id_);
    stream().expires_never();  // from here on the WebSocket has its own limits
    socket_.set_option(
        websocket::stream_base::timeout{parts_.options.handshake_max, parts_.options.silence_max, true});
    socket_.set_option(websocket::stream_base::decorator([name = *subprotocol](auto& response) {
        response.set(http::field::sec_websocket_protocol, name);
        response.set(http::field::server, "octoskin");
    }));
    socket_.read_message_max(parts_.options.message_bytes_max);
    socket_.write_buffer_bytes(kFragmentBytes);
    socket_.async_accept(request,
                         [self = shared_from_this()](const error_code& error) { self->on_upgraded(error); });
}

void Session::on_upgraded(const error_code& error) {
    if (error) return end(error);
    parser_.reset();
    is_open_ = true;
    parts_.clients.on_open(id_);
    pump();
    read();
}

void Session::send_file() {
    const auto& request = parser_->get();
    if (request.method() != http::verb::get && request.method() != http::verb::head)
        return respond(http::status::method_not_allowed, "text/plain", "Only GET and HEAD.\n");
    const std::string_view target = value_of(request.target());
    const std::string path(target.substr(0, target.find('?')));
    const auto file = parts_.options.files.find(path);
    if (file != parts_.options.files.end())
        return respond(http::status::ok, file->second.type, file->second.content);
    const bool is_page = path == "/" && !parts_.options.file_missing.empty();
    respond(http::status::not_found, "text/plain; charset=utf-8",
            (is_page ? parts_.options.file_missing : "There is no such file.") + "\n");
}

void Session::refuse(http::status status, Refusal why, std::string_view value, const std::string& sentence) {
    parts_.refuse(why, value);
    respond(status, "text/plain; charset=utf-8", sentence + "\n");
}

/// The last thing on this connection.
void Session::respond(http::status status, const std::string& type, std::string content) {
    const bool has_body = parser_->get().method() != http::verb::head;
    response_ = Response(status, 11);
    response_.set(http::field::server, "octoskin");
    response_.set(http::field::content_type, type);
    response_.set(http::field::cache_control, "no-cache");
    response_.set("Content-Security-Policy", kPolicy);
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set("Referrer-Policy", "no-referrer");
    response_.keep_alive(false);
    response_.content_length(content.size());
    if (has_body) response_.body() = std::move(content);
    stream().expires_after(parts_.options.handshake_max);
    http::async_write(stream(), response_, [self = shared_from_this()](const error_code&, std::size_t) {
        error_code ignored;
        self->stream().socket().shutdown(tcp::socket::shutdown_send, ignored);
        self->parts_.end_session(self->id_);
    });
}

void Session::read() {
    socket_.async_read(
        buffer_, [self = shared_from_this()](const error_code& error, std::size_t) { self->on_read(error); });
}

void Session::on_read(const error_code& error) {
    if (error) return end(error);
    const auto bytes = buffer_.data();
    const auto refused = parts_.clients.on_message(
        id_, {static_cast<const char*>(bytes.data()), bytes.size()}, socket_.got_binary());
    constexpr std::size_t kKept = std::size_t{64} << 10U;
    buffer_.consume(buffer_.size());
    if (buffer_.capacity() > kKept) buffer_.shrink_to_fit();
    refused ? close(*refused) : read();
}

void Session::pump() {
    if (!is_open_ || is_sending_ || is_closing_) return;
    auto message = parts_.clients.next(id_);
    if (!message) return;
    sending_ = std::move(*message);
    is_sending_ = true;
    const std::string_view body = sending_.body ? std::string_view(*sending_.body) : std::string_view();
    socket_.binary(sending_.is_binary);
    // Between the fragments of a large file there is room for the ping of a client that is slow.
    socket_.auto_fragment(sending_.head.size() + body.size() > kWholeBytes);
    socket_.async_write(std::array{asio::const_buffer(sending_.head.data(), sending_.head.size()),
                                   asio::const_buffer(body.data(), body.size())},
                        [self = shared_from_this()](const error_code& failed, std::size_t) {
                            self->is_sending_ = false;
                            self->sending_ = {};
                            if (!failed) self->pump();  // else the read fails, too
                        });
}

void Session::close(Refusal why) {
    is_closing_ = true;
    parts_.refuse(why, "");
    const auto code =
        why == Refusal::malformed ? websocket::close_code::bad_payload : websocket::close_code::policy_error;
    socket_.async_close(code, [self = shared_from_this()](const error_code& error) { self->end(error); });
}

void Session::drop(Refusal why) {
    if (std::exchange(is_closing_, true)) return;
    parts_.refuse(why, "");
    cut();  // ends the read, too
}

void Session::end(const error_code& error) {
    const auto refused = refusal_of(error);
    if (refused && !is_closing_) parts_.refuse(*refused, error.message());
    cut();
    parts_.end_session(id_);
}

void WebServer::Parts::end_session(ClientId id) {
    waiting.erase(id);
    const auto found = open.find(id);
    if (found == open.end()) return;
    const bool is_client = found->second->is_open();
    open.erase(found);
    if (is_client) clients.on_close(id);
}

Status<AppError> WebServer::Parts::listen() {
    const auto failed = [this](ExitCode exit, ErrorCode code, const error_code& error,
                               const std::string& remedy) {
        return fail(exit, {.code = code,
                           .what = "cannot listen: " + error.message(),
                           .remedy = remedy,
                           .key = options.host + " port " + std::to_string(options.port)});
    };
    error_code error;
    const auto found =
        tcp::resolver(io).resolve(options.host, std::to_string(options.port), tcp::resolver::passive, error);
    if (error || found.empty())
        return failed(ExitCode::unavailable, ErrorCode::not_found, error,
                      "give an address of this machine with --host");
    const tcp::endpoint place = *found.begin();
    acceptor.open(place.protocol(), error);
    if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor.bind(place, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error == asio::error::address_in_use)
        return failed(ExitCode::unavailable, ErrorCode::in_use, error,
                      "another octoskin view may run there: stop it, or give another port with --port");
    if (error == asio::error::access_denied)
        return failed(ExitCode::no_permission, ErrorCode::no_permission, error,
                      "give a port above 1023 with --port");
    if (error)
        return failed(ExitCode::unavailable, ErrorCode::system_error, error,
                      "give an address of this machine with --host");
    port = acceptor.local_endpoint().port();
    admission.emplace(options.host, port, options.origins);
    accept();
    return Done{};
}

void WebServer::Parts::accept() {
    acceptor.async_accept(
        [this](const error_code& error, tcp::socket socket) { on_accepted(error, std::move(socket)); });
}

void WebServer::Parts::on_accepted(const error_code& error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) {  // no descriptor is left: some connection ends soon
        constexpr std::chrono::milliseconds kRest{100};
        rest.expires_after(kRest);
        return rest.async_wait([this](const error_code& ended) {
            if (!ended) accept();
        });
    }
    make_room();
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(options.send_buffer_bytes), ignored);
    const ClientId id = next_id++;
    auto session = std::make_shared<Session>(*this, id, std::move(socket));
    waiting.emplace(id, session);
    session->begin();
    accept();
}

void WebServer::Parts::make_room() {
    if (waiting.size() < options.waiting_max) return;
    const auto oldest = waiting.begin()->second;
    waiting.erase(waiting.begin());
    refuse(Refusal::silent, "");
    oldest->cut();
}

void WebServer::Parts::turn(EventLoop& loop) {
    switch (loop.turn()) {
        case EventLoop::Turn::over:
            io.stop();
            return;
        case EventLoop::Turn::more:
            asio::post(io, [this, &loop] { turn(loop); });
            return;
        case EventLoop::Turn::idle:
            loop_ready->async_wait(asio::posix::descriptor_base::wait_read,
                                   [this, &loop](const error_code& error) {
                                       if (!error) turn(loop);
                                   });
            return;
    }
}

Result<std::unique_ptr<WebServer>, AppError> WebServer::open(WebOptions options, WebClients& clients) {
    auto parts = std::make_unique<Parts>(std::move(options), clients);
    if (const auto listening = parts->listen(); !listening) return unexpected(listening.error());
    return std::unique_ptr<WebServer>(new WebServer(std::move(parts)));
}

WebServer::WebServer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
WebServer::~WebServer() = default;

std::uint16_t WebServer::port() const noexcept {
    return parts_->port;
}

void WebServer::run(EventLoop& loop) {
    parts_->loop_ready.emplace(parts_->io, loop.descriptor());
    struct Released {  // the descriptor is the loop's, also after an exception
        Parts& parts;
        ~Released() {
            (void)parts.loop_ready->release();
            parts.loop_ready.reset();
        }
    } const released{*parts_};
    asio::post(parts_->io, [this, &loop] { parts_->turn(loop); });
    parts_->io.run();
}

void WebServer::drop(ClientId client, Refusal why) {
    const auto found = parts_->open.find(client);
    if (found != parts_->open.end()) found->second->drop(why);
}

void WebServer::wake(ClientId client) {
    const auto found = parts_->open.find(client);
    if (found != parts_->open.end()) found->second->pump();
}

}  // namespace octoskin::view
