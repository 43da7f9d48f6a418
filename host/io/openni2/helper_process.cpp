#include "host/io/openni2/helper_process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "host/io/helper_limits/helper_words.hpp"
#include "host/io/openni2/one_line.hpp"

namespace octoskin::openni2 {
namespace {

/// Room for a frame of 512 x 424; Linux allows half of the value.
constexpr int kSendBuffer = 1 << 20;
constexpr std::chrono::milliseconds kStep{5};

/// The attributes for posix_spawn. The calling thread may have blocked signals, and the program may ignore
/// some; the child would inherit both.
class Spawning {
  public:
    Spawning() {
        posix_spawn_file_actions_init(&actions_);
        posix_spawnattr_init(&attributes_);
        sigset_t signals;
        sigemptyset(&signals);
        posix_spawnattr_setsigmask(&attributes_, &signals);
        sigfillset(&signals);
        posix_spawnattr_setsigdefault(&attributes_, &signals);
        posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    }
    ~Spawning() {
        posix_spawn_file_actions_destroy(&actions_);
        posix_spawnattr_destroy(&attributes_);
    }
    Spawning(const Spawning&) = delete;
    Spawning& operator=(const Spawning&) = delete;

    void connect(int descriptor, int as) { posix_spawn_file_actions_adddup2(&actions_, descriptor, as); }
    void open_nothing_as(int descriptor) {
        posix_spawn_file_actions_addopen(&actions_, descriptor, "/dev/null", O_RDONLY, 0);
    }
    /// Returns 0, or the error number.
    int spawn(pid_t& process, std::string program, std::vector<std::string> arguments) const {
        std::vector<char*> pointers{program.data()};
        for (std::string& argument : arguments) pointers.push_back(argument.data());
        pointers.push_back(nullptr);
        return posix_spawn(&process, program.c_str(), &actions_, &attributes_, pointers.data(), environ);
    }

  private:
    posix_spawn_file_actions_t actions_{};
    posix_spawnattr_t attributes_{};
};

/// Killed helpers that the kernel has not ended in time, for example in the middle of a USB transfer. They
/// are checked whenever another helper begins or ends, so that only stuck ones remain.
class LeftBehind {
  public:
    void add(pid_t process) {
        const std::lock_guard lock(mutex_);
        processes_.push_back(process);
    }
    void reap() {
        const std::lock_guard lock(mutex_);
        std::erase_if(processes_, [](pid_t process) { return ::waitpid(process, nullptr, WNOHANG) != 0; });
    }

  private:
    std::mutex mutex_;
    std::vector<pid_t> processes_;
};
LeftBehind& left_behind() {
    static LeftBehind processes;
    return processes;
}

/// The exit status in words; empty: exit code 0.
std::optional<std::string> end_of(int status) {
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
        return "it needs more than " + std::to_string(kHelperProcessorSecondsPerFrame) +
               " s of processor time for a frame";
    }
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS)
        return "it made a system call that reading a file does not need, as a malicious file might cause";
    if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
    if (WEXITSTATUS(status) == kOutOfMemory)
        return "it needs more than " + std::to_string(kHelperMemoryMib) + " MiB of memory";
    if (WEXITSTATUS(status) != 0) return "exit code " + std::to_string(WEXITSTATUS(status));
    return std::nullopt;
}

}  // namespace

Result<HelperProcess, std::string> HelperProcess::start(const std::filesystem::path& program,
                                                        const std::vector<std::string>& arguments,
                                                        HelperPipe pipe, HelperComplaints complaints,
                                                        int inherited) {
    left_behind().reap();
    std::array<int, 2> ends{-1, -1};
    // Sockets instead of a pipe: a write to a stuck helper must not block, and a write to a helper that has
    // ended must not raise SIGPIPE.
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
        return unexpected(std::string("no socket: ") + std::strerror(errno));
    const auto [ours, theirs] = ends;
    for (const int end : ends) ::setsockopt(end, SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof(kSendBuffer));
    std::array<int, 2> words{-1, -1};
    // Non-blocking: the pipe is read only after the helper ends, and the helper must not wait for that.
    (void)!::pipe2(words.data(), O_CLOEXEC | O_NONBLOCK);
    Spawning spawning;
    spawning.connect(theirs, pipe == HelperPipe::its_input ? STDIN_FILENO : STDOUT_FILENO);
    if (words[1] >= 0) spawning.connect(words[1], STDERR_FILENO);
    // Terminal input is not for the helper.
    if (pipe == HelperPipe::its_output) spawning.open_nothing_as(STDIN_FILENO);
    // Last: it may use the number of one of the descriptors above, which are duplicated before.
    if (inherited >= 0) spawning.connect(inherited, kInherited);
    pid_t process = -1;
    const int failed = spawning.spawn(process, program.string(), arguments);
    ::close(theirs);
    if (words[1] >= 0) ::close(words[1]);
    const bool is_shown = complaints == HelperComplaints::on_our_standard_error;
    HelperProcess helper(process, ours, words[0], is_shown ? program.filename().string() : std::string());
    if (failed != 0) return unexpected("cannot start " + program.string() + ": " + std::strerror(failed));
    return helper;
}

HelperProcess::HelperProcess(HelperProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      complaints_(std::exchange(other.complaints_, -1)),
      shown_as_(std::move(other.shown_as_)) {}

HelperProcess& HelperProcess::operator=(HelperProcess&& other) noexcept {
    std::swap(process_, other.process_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(complaints_, other.complaints_);
    std::swap(shown_as_, other.shown_as_);
    return *this;
}

HelperProcess::~HelperProcess() {
    end();
    if (complaints_ >= 0) ::close(complaints_);
}

void HelperProcess::close_pipe() {
    if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

void HelperProcess::show_complaints() const {
    if (!shown_as_.empty() && complaints_ >= 0) show_helper_words(shown_as_, complaints_);
}

void HelperProcess::end() {
    close_pipe();
    if (process_ < 0) return;
    show_complaints();
    ::kill(process_, SIGKILL);
    constexpr int kTries = 200;
    const pid_t process = std::exchange(process_, -1);
    for (int i = 0; i < kTries; ++i) {
        if (::waitpid(process, nullptr, WNOHANG) != 0) return left_behind().reap();
        std::this_thread::sleep_for(kStep);
    }
    left_behind().add(process);
}

std::string HelperProcess::complaint() {
    constexpr std::size_t kPipe = 64 << 10;
    std::string text(kPipe, '\0');
    const ssize_t count = complaints_ < 0 ? 0 : ::read(complaints_, text.data(), text.size());
    text.resize(count > 0 ? static_cast<std::size_t>(count) : 0U);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.pop_back();
    const std::size_t line = text.rfind('\n');
    return one_line(line == std::string::npos ? text : text.substr(line + 1));
}

std::optional<std::string> HelperProcess::wait(std::chrono::milliseconds patience) {
    for (std::chrono::milliseconds waited{0};; waited += kStep) {
        int status = 0;
        const pid_t ended = ::waitpid(process_, &status, WNOHANG);
        if (ended == process_) {
            process_ = -1;
            show_complaints();
            return end_of(status);
        }
        if (ended < 0) return std::string("no such process");
        if (waited >= patience) {
            end();
            return std::string("did not end in time");
        }
        std::this_thread::sleep_for(kStep);
    }
}

Result<std::filesystem::path, std::string> find_helper(
    const std::string& name, const std::optional<std::filesystem::path>& in_its_place) {
    if (in_its_place) return *in_its_place;
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    if (self.is_absolute() && std::filesystem::exists(self / name, error)) return self / name;
    const auto libexec = self.parent_path() / "libexec" / "octoskin";
    // A libexec above any other folder could belong to another user.
    if (self.filename() == "bin" && std::filesystem::exists(libexec / name, error)) return libexec / name;
    return unexpected(
        name +
        " is neither beside this program nor in libexec: build octoskin_programs, or install octoskin again");
}

}  // namespace octoskin::openni2
