// In place of the daemon, for octoskin-bridge: the README.md of this folder.
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/io/openni2/frame_pipe.hpp"
#include "host/io/watch/watch_frame.hpp"
#include "tests/bench/bridge/sheets.hpp"

namespace octoskin::bridge_bench {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

struct Options {
    std::string socket;
    std::string description;
    std::size_t occupied = 300'000;
    double resolution_m = 0.02;
    double rate_hz = 5.0;
    double share = 0.01;
};

constexpr std::size_t kMapBytes = std::size_t{1} << 20U;
const std::string kStatus = R"({"ok":true,"reloads":{"count":0},"problems":[]})";

void print(const Json& event) {
    static std::mutex mutex;
    const std::scoped_lock lock(mutex);
    std::cout << event.dump() << std::endl;
}

/// False: the other end has gone.
bool send_all(int connection, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (count <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
}

/// Of a request; empty at the end.
std::string read_line(int connection) {
    std::string line;
    char next = 0;
    while (::recv(connection, &next, 1, 0) == 1) {
        if (next == '\n') return line;
        line += next;
    }
    return {};
}

/// The daemon's side of `watch`, with a map that changes.
class Watched {
  public:
    Watched(int connection, const Options& options)
        : connection_(connection), options_(options), sheets_(options.occupied, options.resolution_m) {}

    void run() {
        missing_.add(watch::bricks_of(sheets_.map()));
        print({{"event", "map"}, {"bricks", sheets_.bricks()}, {"known", sheets_.known()}});
        const auto period = std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(1.0 / options_.rate_hz));
        Clock::time_point next = Clock::now();
        Clock::time_point next_status = next;
        bool is_there = send_all(connection_, R"({"ok":true,"watch":1})"
                                              "\n") &&
                        send_frame({.kind = watch::FrameKind::reload}, watch::reload_payload(0)) &&
                        send_map(true);
        while (is_there) {
            if (next >= next_status) {
                is_there = send_frame({.kind = watch::FrameKind::status}, kStatus);
                next_status += std::chrono::seconds(1);
            }
            std::this_thread::sleep_until(next += period);
            missing_.add(sheets_.change(options_.share));
            is_there = is_there && send_map(false);
        }
    }

  private:
    bool send_map(bool begins) {
        const FusedMap map = sheets_.map();
        bool is_there = true;
        do {
            const std::string payload = missing_.take(map, kMapBytes);
            const unsigned flags =
                (begins ? watch::kBegins : 0U) | (missing_.empty() ? watch::kComplete : 0U);
            begins = false;
            is_there = send_frame({.kind = watch::FrameKind::map, .flags = static_cast<std::uint8_t>(flags)},
                                  payload);
        } while (is_there && !missing_.empty());
        return is_there;
    }

    bool send_frame(watch::FrameHeader header, const std::string& payload) {
        header.bytes = static_cast<std::uint32_t>(payload.size());
        header.number = number_++;
        header.time = monotonic_now();
        std::string bytes;
        watch::put_header(bytes, header);
        return send_all(connection_, bytes + payload);
    }

    int connection_;
    const Options& options_;
    Sheets sheets_;
    watch::MissingBricks missing_;
    std::uint64_t number_ = 0;
};

Json latencies(std::vector<double> ms) {
    if (ms.empty()) return nullptr;
    std::ranges::sort(ms);
    const auto at = [&ms](std::size_t percent) { return ms[(ms.size() - 1) * percent / 100]; };
    return {{"min", ms.front()}, {"p50", at(50)}, {"p90", at(90)}, {"p99", at(99)}, {"max", ms.back()}};
}

/// Takes a camera's images; at their end prints how long after their capture they were there.
void take_images(int connection) {
    if (!send_all(connection, "{\"ok\":true}\n")) return;
    openni2::FramePipe pipe(connection, std::chrono::seconds(60));
    const auto header = pipe.read_header();
    if (!header) return;
    std::vector<double> ms;
    std::vector<unsigned> numbers;
    for (;;) {
        const auto frame = pipe.read_frame(header->size);
        if (!frame || !*frame) break;
        const std::int64_t captured_ns = static_cast<std::int64_t>((*frame)->timestamp_us) * 1000;
        ms.push_back(static_cast<double>(monotonic_now().ns - captured_ns) * 1e-6);
        numbers.push_back((*frame)->depth_mm.at(0));
    }
    print({{"event", "images"}, {"count", ms.size()}, {"latency_ms", latencies(ms)}, {"numbers", numbers}});
}

std::string content_of(const std::string& file) {
    std::ifstream stream(file);
    return Json::parse(stream).dump();
}

void serve(int connection, const Options& options) {
    for (std::string line = read_line(connection); !line.empty(); line = read_line(connection)) {
        if (line.starts_with("watch")) {
            Watched(connection, options).run();
            break;
        }
        if (line.starts_with("camera")) {
            take_images(connection);
            break;
        }
        if (!send_all(connection, (line == "describe" ? content_of(options.description) : kStatus) + "\n"))
            break;
    }
    ::close(connection);
}

int listen(const Options& options) {
    const auto bound = bind_unix_socket(options.socket, SOCK_STREAM);
    if (!bound) {
        std::cerr << bound.error().message() << '\n';
        return 1;
    }
    const int flags = ::fcntl(bound->descriptor, F_GETFL);
    (void)::fcntl(bound->descriptor, F_SETFL, flags & ~O_NONBLOCK);
    for (;;) {
        const int connection = ::accept4(bound->descriptor, nullptr, nullptr, SOCK_CLOEXEC);
        if (connection < 0) return 1;
        std::thread([connection, &options] { serve(connection, options); }).detach();
    }
}

}  // namespace
}  // namespace octoskin::bridge_bench

int main(int count, char** words) {
    octoskin::bridge_bench::Options options;
    CLI::App app("In place of the daemon: a map that changes, and a camera's images.");
    app.add_option("socket", options.socket, "control socket")->required();
    app.add_option("description", options.description, "JSON that answers 'describe'")->required();
    app.add_option("--occupied", options.occupied, "occupied voxels")->capture_default_str();
    app.add_option("--resolution", options.resolution_m, "metres")->capture_default_str();
    app.add_option("--rate", options.rate_hz, "changes of the map a second")->capture_default_str();
    app.add_option("--share", options.share, "of the bricks that change")->capture_default_str();
    CLI11_PARSE(app, count, words);
    return octoskin::bridge_bench::listen(options);
}
