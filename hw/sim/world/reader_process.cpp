#include "hw/sim/world/reader_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

extern char** environ;

namespace octoskin::sim {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMiB = 1U << 20U;

/// A process with its standard output as a pipe; the destructor kills it if it still runs. `folder`: its
/// working directory, or -1.
class Reader {
  public:
    Reader(std::vector<std::string> command, int folder) {
        std::array<int, 2> ends{-1, -1};
        if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
            error_ = errno;
            return;
        }
        output_ = ends[0];
        // Non-blocking: this pipe is read only after the process has ended, and the process must not wait for
        // it.
        std::array<int, 2> words{-1, -1};
        (void)!::pipe2(words.data(), O_CLOEXEC | O_NONBLOCK);
        words_ = words[0];
        error_ = spawn(std::move(command), {ends[1], words[1]}, folder);
        ::close(ends[1]);
        if (words[1] >= 0) ::close(words[1]);
    }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    ~Reader() {
        if (output_ >= 0) ::close(output_);
        if (process_ > 0) ::kill(process_, SIGKILL);
        (void)ended_by(Clock::now() + kPatienceForEnd);
        if (words_ >= 0) ::close(words_);
    }

    /// errno of a failed start; 0: it was started.
    [[nodiscard]] int error() const noexcept { return error_; }

    /// Up to `size` bytes of its output, none at its end; empty if there is no output until `until`.
    [[nodiscard]] std::optional<std::size_t> read(char* to, std::size_t size, Clock::time_point until) const {
        while (true) {
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
            if (left.count() <= 0) return std::nullopt;
            pollfd ready{output_, POLLIN, 0};
            if (::poll(&ready, 1, static_cast<int>(std::min<std::int64_t>(left.count(), 1000))) <= 0)
                continue;
            const ssize_t count = ::read(output_, to, size);
            if (count >= 0) return static_cast<std::size_t>(count);
            if (errno != EINTR) return 0;
        }
    }
    /// Its standard error, escaped: it may contain text of an untrusted file.
    [[nodiscard]] std::string words() const {
        std::string text(4096, '\0');
        const ssize_t count = words_ < 0 ? 0 : ::read(words_, text.data(), text.size());
        text.resize(count > 0 ? static_cast<std::size_t>(count) : 0U);
        return text;
    }
    /// Its status for waitpid(2)'s macros; empty if it has not ended by `until`.
    [[nodiscard]] std::optional<int> ended_by(Clock::time_point until) {
        constexpr std::chrono::milliseconds kStep{2};
        while (process_ > 0) {
            int status = 0;
            const pid_t ended = ::waitpid(process_, &status, WNOHANG);
            if (ended != 0 && !(ended < 0 && errno == EINTR)) {
                process_ = -1;
                return ended < 0 ? std::nullopt : std::optional(status);
            }
            if (Clock::now() >= until) return std::nullopt;
            std::this_thread::sleep_for(kStep);
        }
        return std::nullopt;
    }

    static constexpr std::chrono::seconds kPatienceForEnd{2};

  private:
    struct Ends {
        int output;
        int words;  ///< for its standard error; -1: that of this process
    };
    /// Starts it with no open descriptor of this process but the pipes, and with no signal blocked or
    /// ignored. `folder`: descriptor of its working directory, the folder opened here; -1: that of this
    /// process.
    [[nodiscard]] int spawn(std::vector<std::string> command, Ends ends, int folder) {
        posix_spawn_file_actions_t actions{};
        posix_spawnattr_t attributes{};
        posix_spawn_file_actions_init(&actions);
        posix_spawnattr_init(&attributes);
        posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_adddup2(&actions, ends.output, STDOUT_FILENO);
        if (ends.words >= 0) posix_spawn_file_actions_adddup2(&actions, ends.words, STDERR_FILENO);
        if (folder >= 0) posix_spawn_file_actions_addfchdir_np(&actions, folder);
        posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
        sigset_t signals{};
        ::sigemptyset(&signals);
        posix_spawnattr_setsigmask(&attributes, &signals);
        ::sigfillset(&signals);
        posix_spawnattr_setsigdefault(&attributes, &signals);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
        std::vector<char*> pointers;
        for (std::string& word : command) pointers.push_back(word.data());
        pointers.push_back(nullptr);
        const int failed =
            ::posix_spawn(&process_, pointers.front(), &actions, &attributes, pointers.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        posix_spawnattr_destroy(&attributes);
        return failed;
    }

    pid_t process_ = -1;
    int output_ = -1;
    int words_ = -1;
    int error_ = 0;
};

/// Beside the running program, or in ../libexec/octoskin/ of one in a folder bin: another user may be able to
/// create a program in any other folder. Empty if it is not found.
std::filesystem::path find_reader() {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    if (self.is_absolute() && std::filesystem::exists(self / kWorldReader, error)) return self / kWorldReader;
    const auto libexec = self.parent_path() / "libexec" / "octoskin";
    const bool is_there = self.filename() == "bin" && std::filesystem::exists(libexec / kWorldReader, error);
    return is_there ? libexec / kWorldReader : std::filesystem::path();
}

Error refusal(const std::string& limit) {
    return {.code = ErrorCode::too_large,
            .what = "needs more than " + limit + " to be read",
            .remedy = "give a world of fewer models, or coarser meshes"};
}

/// The fault for its exit status; empty if it was successful.
std::optional<Error> fault_of(int status, const ReadLimits& limits) {
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        return refusal(std::to_string(limits.processor_s) + " s of processor time");
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS) {
        return Error{.code = ErrorCode::damaged,
                     .what = "the reader made a forbidden system call and was ended",
                     .remedy = "the file, or one of its meshes, may be an attack; do not use it"};
    }
    if (WIFSIGNALED(status)) {
        return Error{.code = ErrorCode::damaged,
                     .what = "the reader was ended by signal " + std::to_string(WTERMSIG(status)),
                     .remedy = "the file, or one of its meshes, is damaged; take it out, or save it anew"};
    }
    if (WEXITSTATUS(status) == kOutOfMemory)
        return refusal(std::to_string(limits.memory_mib) + " MiB of memory");
    if (WEXITSTATUS(status) != 0)
        return Error{ErrorCode::damaged,
                     "the reader ended with exit code " + std::to_string(WEXITSTATUS(status))};
    return std::nullopt;
}

}  // namespace

Result<std::string, Error> read_in_process(const FilePlace& sdf, const ReadLimits& limits,
                                           const std::filesystem::path& program_given) {
    const auto until = Clock::now() + limits.patience;
    const auto program = program_given.empty() ? find_reader() : program_given;
    if (program.empty()) {
        return unexpected(Error{.code = ErrorCode::no_program,
                                .what = std::string("the reader of SDF files is not there, ") + kWorldReader +
                                        " is neither beside this program nor in libexec",
                                .remedy = "build octoskin_programs, or install octoskin anew"});
    }
    std::vector<std::string> command{program.string(), std::to_string(limits.memory_mib),
                                     std::to_string(limits.processor_s), sdf.name().string()};
    std::optional<OpenFolder> folder;
    if (const NamedFolder* const named = sdf.folder()) {
        auto opened = named->open();
        if (!opened) return unexpected(to_error(opened.error()));
        folder = std::move(*opened);
        command.emplace_back(kBeneath);
    }
    Reader reader(std::move(command), folder ? folder->descriptor() : -1);
    if (reader.error() != 0) {
        return unexpected(
            Error{ErrorCode::no_program, "the reader of SDF files cannot be started: " + program.string() +
                                             ": " + std::strerror(reader.error())});
    }
    std::string bytes;
    std::vector<char> part(kMiB);
    while (true) {
        const auto count = reader.read(part.data(), part.size(), until);
        if (!count) return unexpected(refusal(std::to_string(limits.patience.count()) + " s"));
        if (*count == 0) break;
        if (bytes.size() + *count > limits.result_mib * kMiB)
            return unexpected(refusal(std::to_string(limits.result_mib) + " MiB for its triangles"));
        bytes.append(part.data(), *count);
    }
    const auto status = reader.ended_by(std::max(until, Clock::now() + Reader::kPatienceForEnd));
    if (!status) return unexpected(Error{ErrorCode::time_limit, "the reader did not end"});
    if (auto fault = fault_of(*status, limits)) {
        const std::string words = reader.words();
        if (!words.empty()) fault->others = "Its output: " + words;
        return unexpected(*std::move(fault));
    }
    return bytes;
}

}  // namespace octoskin::sim
