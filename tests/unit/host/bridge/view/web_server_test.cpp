// The web server against connections that are silent, half, too large or too slow: each is closed and
// counted.
#include "host/bridge/view/web_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

namespace octoskin::view {
namespace {

using namespace std::chrono_literals;

/// Sends what it is given to send, and notes what it hears.
class Listener final : public WebClients {
  public:
    void on_open(ClientId client) override {
        const std::lock_guard lock(mutex);
        open[client] = {};
    }
    std::optional<Refusal> on_message(ClientId client, std::string_view message, bool) override {
        const std::lock_guard lock(mutex);
        open[client].emplace_back(message);
        return message == "malformed" ? std::optional(Refusal::malformed) : std::nullopt;
    }
    std::optional<WebMessage> next(ClientId) override {
        const std::lock_guard lock(mutex);
        if (left == 0) return std::nullopt;
        --left;
        return WebMessage{"head ", body, false};
    }
    void on_close(ClientId client) override {
        const std::lock_guard lock(mutex);
        open.erase(client);
    }
    void on_refused(Refusal why, const std::string&) override {
        const std::lock_guard lock(mutex);
        ++refused[why];
    }
    [[nodiscard]] int count(Refusal why) {
        const std::lock_guard lock(mutex);
        return refused[why];
    }
    [[nodiscard]] std::size_t clients() {
        const std::lock_guard lock(mutex);
        return open.size();
    }

    std::mutex mutex;
    std::map<ClientId, std::vector<std::string>> open;
    std::map<Refusal, int> refused;
    int left = 0;
    std::shared_ptr<const std::string> body = std::make_shared<const std::string>("body");
};

/// A connection as bytes.
class Peer {
  public:
    explicit Peer(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        const timeval patience{.tv_sec = 20, .tv_usec = 0};
        ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
        sockaddr_in place{};
        place.sin_family = AF_INET;
        place.sin_port = htons(port);
        place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof(place)), 0);
    }
    ~Peer() { ::close(socket_); }
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;

    void send(const std::string& bytes) const {
        (void)::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    }
    /// Until this text is among what came, or the other end has closed.
    std::string until(const std::string& text) {
        while (heard_.find(text) == std::string::npos && take()) continue;
        return heard_;
    }
    /// Everything until the other end closes; false: it did not.
    bool until_closed() {
        while (take()) continue;
        return is_closed_;
    }
    [[nodiscard]] const std::string& heard() const { return heard_; }

  private:
    bool take() {
        std::array<char, 65536> bytes{};
        const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
        is_closed_ = count == 0 || (count < 0 && errno == ECONNRESET);
        if (count > 0) heard_.append(bytes.data(), static_cast<std::size_t>(count));
        return count > 0;
    }
    int socket_;
    std::string heard_;
    bool is_closed_ = false;
};

class WebServerTest : public ::testing::Test {
  protected:
    ~WebServerTest() override {
        is_over = true;
        if (thread.joinable()) thread.join();
    }
    void start() {
        options.port = 0;
        auto opened = WebServer::open(options, listener);
        ASSERT_TRUE(opened) << opened.error().message();
        server = std::move(opened).value();
        thread = std::thread([this] {
            EventLoop loop;
            const EventSource look = loop.every(5ms, [&] {
                if (is_over) loop.stop(0);
                if (const ClientId client = to_wake.exchange(0); client != 0) server->wake(client);
            });
            server->run(loop);
        });
    }
    [[nodiscard]] std::uint16_t port() const { return server->port(); }
    [[nodiscard]] std::string request(const std::string& line, const std::string& more = "") const {
        return line + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port()) + "\r\n" + more + "\r\n";
    }
    [[nodiscard]] std::string handshake() const {
        return request("GET /",
                       "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                       "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                       "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n");
    }
    /// A client that is open.
    std::unique_ptr<Peer> client() {
        auto peer = std::make_unique<Peer>(port());
        peer->send(handshake());
        EXPECT_EQ(peer->until("\r\n\r\n").substr(0, 12), "HTTP/1.1 101");
        return peer;
    }
    /// A connection is closed before it is counted.
    void expect_refused(Refusal why, int times) {
        (void)wait_for([&] { return listener.count(why) >= times; });
        EXPECT_EQ(listener.count(why), times);
    }
    template <class Condition>
    static bool wait_for(Condition condition) {
        for (int i = 0; i < 2'000 && !condition(); ++i) std::this_thread::sleep_for(5ms);
        return condition();
    }

    WebOptions options{.handshake_max = 300ms, .silence_max = 600ms};
    Listener listener;
    std::unique_ptr<WebServer> server;
    std::atomic<bool> is_over = false;
    std::atomic<ClientId> to_wake = 0;
    std::thread thread;
};

/// A masked frame with a mask of zeros; `length`: of the payload, up to 125.
std::string frame(const std::string& payload, char first = '\x81') {
    return std::string{first, static_cast<char>(0x80U | payload.size())} + std::string(4, '\0') + payload;
}

TEST_F(WebServerTest, sends_files_of_the_page_and_a_sentence_if_there_is_none) {
    options.files = {{"/page.css", {"text/css", "a{}"}}};
    options.file_missing = "no page";
    start();
    const auto get = [&](const std::string& line) {
        Peer peer(port());
        peer.send(request(line));
        EXPECT_TRUE(peer.until_closed());
        return peer.heard();
    };
    const std::string css = get("GET /page.css?a=1");
    EXPECT_TRUE(css.starts_with("HTTP/1.1 200"));
    EXPECT_TRUE(css.ends_with("\r\n\r\na{}"));
    EXPECT_NE(css.find("Content-Security-Policy: default-src 'self'"), std::string::npos);
    EXPECT_TRUE(get("HEAD /page.css").ends_with("\r\n\r\n"));
    EXPECT_TRUE(get("GET /").starts_with("HTTP/1.1 404"));
    EXPECT_TRUE(get("GET /").ends_with("no page\n"));
    EXPECT_TRUE(get("GET /../../etc/passwd").starts_with("HTTP/1.1 404"));
    EXPECT_TRUE(get("DELETE /page.css").starts_with("HTTP/1.1 405"));
}

TEST_F(WebServerTest, carries_messages_both_ways) {
    listener.left = 2;
    start();
    const auto peer = client();
    EXPECT_NE(peer->until("\x81\x09head body").find("\x81\x09head body"), std::string::npos);
    peer->send(frame("hello"));
    EXPECT_TRUE(wait_for([&] {
        const std::lock_guard lock(listener.mutex);
        return listener.open.begin()->second == std::vector<std::string>{"hello"};
    }));
    {
        const std::lock_guard lock(listener.mutex);
        listener.left = 1;
        listener.body = std::make_shared<const std::string>("woken");
        to_wake = listener.open.begin()->first;
    }
    EXPECT_NE(peer->until("head woken").find("head woken"), std::string::npos);
}

TEST_F(WebServerTest, closes_a_connection_without_a_whole_request) {
    start();
    for (const std::string& begun :
         {std::string(), std::string("GET / HTTP/1.1\r\nHost: "), handshake().substr(0, 80)}) {
        Peer peer(port());
        peer.send(begun);
        EXPECT_TRUE(peer.until_closed());
        EXPECT_TRUE(peer.heard().empty());
    }
    expect_refused(Refusal::silent, 3);
}

TEST_F(WebServerTest, has_room_for_a_client_among_any_number_of_silent_connections) {
    options.waiting_max = 8;
    options.handshake_max = 20s;
    start();
    std::vector<std::unique_ptr<Peer>> silent;
    for (int i = 0; i < 200; ++i) silent.push_back(std::make_unique<Peer>(port()));
    expect_refused(Refusal::silent, 192);
    const auto peer = client();
    EXPECT_TRUE(silent.front()->until_closed());
    EXPECT_TRUE(wait_for([&] { return listener.clients() == 1; }));
}

TEST_F(WebServerTest, refuses_what_is_no_http_and_headers_that_are_too_long) {
    start();
    Peer noise(port());
    noise.send(std::string(64, '\x16') + "\r\n\r\n");
    EXPECT_TRUE(noise.until_closed());
    EXPECT_TRUE(noise.heard().starts_with("HTTP/1.1 400"));
    Peer endless(port());
    endless.send(request("GET /", "A: " + std::string(40'000, 'a') + "\r\n"));
    EXPECT_TRUE(endless.until("\r\n\r\n").starts_with("HTTP/1.1 431"));
    expect_refused(Refusal::malformed, 1);
    expect_refused(Refusal::too_large, 1);
}

TEST_F(WebServerTest, refuses_two_hosts_two_origins_and_a_frame_before_the_answer) {
    start();
    const auto answer_to = [&](const std::string& bytes) {
        Peer peer(port());
        peer.send(bytes);
        return peer.until("\r\n\r\n").substr(0, 12);
    };
    const std::string own = "http://127.0.0.1:" + std::to_string(port());
    EXPECT_EQ(answer_to(request("GET /", "Host: localhost\r\n")), "HTTP/1.1 403");
    EXPECT_EQ(answer_to(request("GET /", "Origin: " + own + "\r\nOrigin: " + own + "\r\n")), "HTTP/1.1 403");
    EXPECT_EQ(answer_to("GET / HTTP/1.0\r\n\r\n"), "HTTP/1.1 403");
    EXPECT_EQ(answer_to(handshake() + frame("early")), "HTTP/1.1 400");
    expect_refused(Refusal::host, 2);
    expect_refused(Refusal::origin, 1);
    expect_refused(Refusal::malformed, 1);
    EXPECT_EQ(listener.clients(), 0U);
}

TEST_F(WebServerTest, refuses_more_clients_than_there_are_places) {
    options.clients_max = 2;
    start();
    const auto first = client();
    auto second = client();
    Peer third(port());
    third.send(handshake());
    EXPECT_TRUE(third.until("\r\n\r\n").starts_with("HTTP/1.1 503"));
    expect_refused(Refusal::too_many, 1);
    second.reset();
    EXPECT_TRUE(wait_for([&] { return listener.clients() == 1; }));
    (void)client();
}

TEST_F(WebServerTest, closes_a_client_that_stops_in_the_middle_of_a_frame) {
    start();
    const auto peer = client();
    peer->send(frame("hello").substr(0, 4));
    EXPECT_TRUE(peer->until_closed());
    expect_refused(Refusal::silent, 1);
    EXPECT_EQ(listener.clients(), 0U);
}

TEST_F(WebServerTest, closes_a_client_whose_frame_or_message_is_malformed) {
    start();
    const std::vector<std::string> bad = {std::string("\x81\x05hello"),             // no mask
                                          frame("hello", '\xf1'),                   // reserved bits
                                          frame("hello", '\x83'),                   // a reserved opcode
                                          frame("hello", '\x80'),                   // continues nothing
                                          frame(std::string(100, '\xff'), '\x81'),  // no UTF-8
                                          frame("malformed")};
    for (const std::string& bytes : bad) {
        const auto peer = client();
        peer->send(bytes);
        EXPECT_TRUE(peer->until_closed());
    }
    expect_refused(Refusal::malformed, static_cast<int>(bad.size()));
    EXPECT_TRUE(wait_for([&] { return listener.clients() == 0; }));
}

TEST_F(WebServerTest, closes_a_client_whose_message_is_too_large) {
    options.message_bytes_max = 1'000;
    start();
    const auto whole = client();
    whole->send(std::string("\x82\xfe\x03\xe9\0\0\0\0", 8) + std::string(1'001, 'x'));
    EXPECT_TRUE(whole->until_closed());
    const auto in_parts = client();
    for (int i = 0; i < 20; ++i) in_parts->send(frame(std::string(100, 'x'), i == 0 ? '\x02' : '\0'));
    EXPECT_TRUE(in_parts->until_closed());
    const auto claimed = client();
    claimed->send(std::string("\x82\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14));
    EXPECT_TRUE(claimed->until_closed());
    expect_refused(Refusal::too_large, 3);
}

TEST_F(WebServerTest, asks_for_a_message_only_when_the_one_before_has_left) {
    options.silence_max = 60s;
    options.send_buffer_bytes = 16 << 10;
    listener.left = 1'000;
    listener.body = std::make_shared<const std::string>(std::size_t{1} << 20U, 'x');
    start();
    const auto peer = client();
    std::this_thread::sleep_for(200ms);
    const std::lock_guard lock(listener.mutex);
    EXPECT_GT(listener.left, 980) << "the rest of a megabyte waits for a client that reads nothing";
}

TEST_F(WebServerTest, ends_with_its_loop_while_clients_are_there) {
    start();
    const auto peer = client();
    Peer silent(port());
    is_over = true;
    thread.join();
    server.reset();
    EXPECT_TRUE(peer->until_closed());
}

TEST(WebServer, says_that_a_port_is_taken) {
    Listener listener;
    const auto first = WebServer::open({.port = 0}, listener);
    ASSERT_TRUE(first);
    const auto second = WebServer::open({.port = (*first)->port()}, listener);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().error.code, ErrorCode::in_use);
    EXPECT_EQ(second.error().exit, ExitCode::unavailable);
    const auto foreign = WebServer::open({.host = "192.0.2.1", .port = 0}, listener);
    ASSERT_FALSE(foreign);
    EXPECT_EQ(foreign.error().error.code, ErrorCode::system_error);
}

}  // namespace
}  // namespace octoskin::view
