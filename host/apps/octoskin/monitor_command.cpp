// octoskin monitor: the daemon's status on a terminal, until Ctrl-C or q.
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/monitor/screen.hpp"
#include "host/apps/monitor/scroll.hpp"
#include "host/apps/octoskin/commands.hpp"

namespace octoskin::app {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;
using namespace std::chrono_literals;

struct MonitorOptions {
    std::filesystem::path socket = default_control_socket();
    bool is_once = false;
};

volatile std::sig_atomic_t is_ended = 0;  // set by a signal handler, which may touch nothing else

/// The terminal's alternate screen, without cursor, with keys delivered as they are typed; restored in every
/// case.
class Terminal {
  public:
    Terminal() {
        struct sigaction end {};
        end.sa_handler = [](int) { is_ended = 1; };
        for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &end, nullptr);
        termios typed{};
        has_keys_ = ::tcgetattr(STDIN_FILENO, &typed) == 0;  // false: no terminal
        if (has_keys_) {
            before_ = typed;
            typed.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
            ::tcsetattr(STDIN_FILENO, TCSANOW, &typed);
        }
        write("\x1b[?1049h\x1b[?25l");
    }
    ~Terminal() {
        write("\x1b[?25h\x1b[?1049l");
        if (before_) ::tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    /// Clears the rest of the screen. The size is read each time.
    void show(std::vector<ScreenLine> lines) {
        lines_ = std::move(lines);
        show();
    }
    /// Waits until `end`, a signal or the key that ends it; scrolls meanwhile.
    void wait_until(Clock::time_point end) {
        while (is_ended == 0) {  // each round waits for `end` or a key
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
            if (left <= 0ms) return;
            pollfd typed{has_keys_ ? STDIN_FILENO : -1, POLLIN, 0};
            if (::poll(&typed, 1, static_cast<int>(left.count())) == 1) take_keys();
        }
    }

  private:
    static ScreenSize size_now() {
        winsize size{};
        const bool is_known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0;
        return is_known ? ScreenSize{size.ws_col, size.ws_row - 1U} : ScreenSize{};
    }
    void take_keys() {
        std::array<char, 64> keys{};
        const ssize_t count = ::read(STDIN_FILENO, keys.data(), keys.size());
        if (count <= 0) {  // standard input has ended
            has_keys_ = count < 0 && errno == EINTR;
            return;
        }
        const ScreenSize screen = size_now();
        const std::size_t lines = wrapped(lines_, screen.columns).size();
        scroll_.type({keys.data(), static_cast<std::size_t>(count)}, lines, rows_for(lines, screen));
        if (scroll_.is_ended()) is_ended = 1;
        show();
    }
    void show() const {
        const ScreenSize screen = size_now();
        const std::vector<ScreenLine> lines = wrapped(lines_, screen.columns);
        std::string text =
            to_terminal(lines, screen, true, scroll_.first(lines.size(), rows_for(lines.size(), screen)));
        for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 4)
            text.insert(at, "\x1b[K");
        write("\x1b[H" + text + "\x1b[J");
    }
    static void write(const std::string& text) {
        // The loss of the terminal ends it.
        if (::write(STDOUT_FILENO, text.data(), text.size()) < 0) is_ended = 1;
    }

    std::vector<ScreenLine> lines_;
    Scroll scroll_;
    bool has_keys_ = false;
    std::optional<termios> before_;
};

/// Two requests a second apart, so that rates are known.
void show_once(const MonitorOptions& options) {
    const auto before = ask_status(options.socket);
    if (!before) throw CommandFailure(before.error());
    const auto begun = Clock::now();
    std::this_thread::sleep_for(1s);
    const auto now = ask_status(options.socket);
    if (!now) throw CommandFailure(now.error());
    constexpr ScreenSize kWhole{1'000, 100'000};
    print_text(to_terminal(screen_of(*before, *now, Clock::now() - begun), kWhole, false));
}

void watch(const MonitorOptions& options) {
    if (::isatty(STDOUT_FILENO) == 0)
        throw CommandFailure(ExitCode::usage, {.code = ErrorCode::wrong_kind_of_file,
                                               .what = "is no terminal",
                                               .remedy = "use --once",
                                               .file = "standard output"});
    Terminal terminal;
    Json before;
    auto before_at = Clock::now();
    while (is_ended == 0) {  // until Ctrl-C or q
        const auto now = ask_status(options.socket);
        const auto now_at = Clock::now();
        if (now) {
            terminal.show(screen_of(before, *now, before.is_null() ? 0s : now_at - before_at));
            before = *now;
            before_at = now_at;
        } else {
            before = Json();
            terminal.show({{now.error().message(), Emphasis::bad}, {"waiting for it; q ends", {}}});
        }
        terminal.wait_until(now_at + 1s);
    }
}

}  // namespace

void add_monitor_command(CLI::App& app) {
    auto options = std::make_shared<MonitorOptions>();
    CLI::App* command = app.add_subcommand(
        "monitor", "Watch the daemon (`octoskin run`): nodes, sensors, rates, and why inputs are not used");
    command->add_flag("--once", options->is_once, "Print one screen as plain text, for a script or a pipe");
    command->add_option("--socket", options->socket, "Control socket of the daemon")->capture_default_str();
    command->footer(
        "Keys: arrows or j and k, Page keys or space and b, Home and End scroll; q or Ctrl-C ends.\n"
        "Exit codes: 0; 64 command line; 65 another program answers, 69 no daemon (--once).");
    command->callback([options] { options->is_once ? show_once(*options) : watch(*options); });
}

}  // namespace octoskin::app
