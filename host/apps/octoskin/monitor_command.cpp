// octoskin monitor: what the daemon says of itself, on a terminal, until Ctrl-C.
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/monitor/screen.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/octoskin/standard_output.hpp"

namespace octoskin::app {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;
using namespace std::chrono_literals;

struct MonitorOptions {
    std::filesystem::path socket = default_control_socket();
    bool is_once = false;
};

volatile std::sig_atomic_t is_ended = 0;  // by a signal: nothing else may be touched there

/// The terminal's second screen, without cursor; given back at the end, however that comes.
class Terminal {
  public:
    Terminal() {
        struct sigaction end {};
        end.sa_handler = [](int) { is_ended = 1; };
        for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &end, nullptr);
        write("\x1b[?1049h\x1b[?25l");
    }
    ~Terminal() { write("\x1b[?25h\x1b[?1049l"); }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    /// From the top; what is right of and below the new text goes. The size is asked each time.
    void show(const std::vector<ScreenLine>& lines) const {
        winsize size{};
        const bool is_known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0;
        const ScreenSize screen = is_known ? ScreenSize{size.ws_col, size.ws_row - 1U} : ScreenSize{};
        std::string text = to_terminal(lines, screen, true);
        for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 4)
            text.insert(at, "\x1b[K");
        write("\x1b[H" + text + "\x1b[J");
    }

  private:
    static void write(const std::string& text) {
        // A terminal that is gone ends it.
        if (::write(STDOUT_FILENO, text.data(), text.size()) < 0) is_ended = 1;
    }
};

Result<Json, AppError> ask(const MonitorOptions& options) {
    const auto answer = ask_daemon(options.socket, "status");
    if (!answer) return unexpected(answer.error());
    Json status = Json::parse(*answer, nullptr, false);
    if (status.is_object()) return status;
    return unexpected(foreign_answer(options.socket));
}

/// Two questions a second apart, so that rates are known.
void show_once(const MonitorOptions& options) {
    const auto before = ask(options);
    if (!before) throw CommandFailure(before.error());
    const auto begun = Clock::now();
    std::this_thread::sleep_for(1s);
    const auto now = ask(options);
    if (!now) throw CommandFailure(now.error());
    constexpr ScreenSize kWhole{1'000, 100'000};
    print_text(to_terminal(screen_of(*before, *now, Clock::now() - begun), kWhole, false));
}

void watch(const MonitorOptions& options) {
    if (::isatty(STDOUT_FILENO) == 0)
        throw CommandFailure({ExitCode::usage, "standard output is no terminal: use --once"});
    const Terminal terminal;
    Json before;
    auto before_at = Clock::now();
    while (is_ended == 0) {  // until Ctrl-C
        const auto now = ask(options);
        const auto now_at = Clock::now();
        if (now) {
            terminal.show(screen_of(before, *now, before.is_null() ? 0s : now_at - before_at));
            before = *now;
            before_at = now_at;
        } else {
            before = Json();
            terminal.show({{now.error().message, Emphasis::bad}, {"waiting for it; Ctrl-C ends", {}}});
        }
        std::this_thread::sleep_for(1s);
    }
}

}  // namespace

void add_monitor_command(CLI::App& app) {
    auto options = std::make_shared<MonitorOptions>();
    CLI::App* command = app.add_subcommand(
        "monitor",
        "Watch the daemon (`octoskin run`): nodes, sensors, rates, and why what is not used is not");
    command->add_flag("--once", options->is_once, "One picture as plain text, for a script or a pipe");
    command->add_option("--socket", options->socket, "Where the daemon listens")->capture_default_str();
    command->callback([options] { options->is_once ? show_once(*options) : watch(*options); });
}

}  // namespace octoskin::app
