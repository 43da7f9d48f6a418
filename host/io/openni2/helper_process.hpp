// Starts a helper program with a pipe to or from it. Every wait for it is limited.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/result.hpp"

namespace octoskin::openni2 {

/// The helper's standard stream at the other end of the pipe.
enum class HelperPipe : std::uint8_t { its_input, its_output };

/// The destination of its standard error.
enum class HelperComplaints : std::uint8_t {
    on_our_standard_error,  ///< copied when it ends, in the form of helper_lines(); an excess is lost
    kept,                   ///< for `complaint`; more than a pipe holds is lost
};

/// The helper's own limits (host/io/helper_limits). Beyond them it ends with this exit code, or by SIGXCPU.
inline constexpr unsigned kHelperMemoryMib = 2048;
inline constexpr unsigned kHelperProcessorSecondsPerFrame = 5;
inline constexpr int kOutOfMemory = 70;

/// Additional start time of a helper for a recording of this size, all of which it reads first: a second for
/// each 20 MB.
[[nodiscard]] constexpr std::chrono::milliseconds time_to_check(std::uintmax_t bytes) {
    return std::chrono::milliseconds(bytes / 20'000);
}

class HelperProcess {
  public:
    static constexpr int kInherited = 3;

    /// Starts `program` with `arguments`, with no signal blocked or ignored. The error message contains the
    /// reason. `inherited`: a file or folder that the helper receives as its descriptor kInherited for its
    /// lifetime; -1: none.
    [[nodiscard]] static Result<HelperProcess, std::string> start(
        const std::filesystem::path& program, const std::vector<std::string>& arguments, HelperPipe pipe,
        HelperComplaints complaints = HelperComplaints::on_our_standard_error, int inherited = -1);
    HelperProcess(HelperProcess&& other) noexcept;
    HelperProcess& operator=(HelperProcess&& other) noexcept;
    /// Ends a helper that still runs. If the kernel does not end it within a second, it is left, and reaped
    /// when another helper begins or ends.
    ~HelperProcess();

    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    /// Closes this end of the pipe: a helper that reads then sees the end of its input.
    void close_pipe();
    /// Waits for the helper to end. Empty: exit code 0. Otherwise the reason in words: "exit code 1", "signal
    /// 11", "did not end in time" (it is then killed), or the limit that it reached.
    [[nodiscard]] std::optional<std::string> wait(std::chrono::milliseconds patience);

    /// The last line of its standard error so far, if that is kept; empty if there is none. The text read so
    /// far is discarded.
    [[nodiscard]] std::string complaint();

  private:
    HelperProcess(int process, int descriptor, int complaints, std::string shown_as)
        : process_(process),
          descriptor_(descriptor),
          complaints_(complaints),
          shown_as_(std::move(shown_as)) {}
    void end();
    void show_complaints() const;

    int process_ = -1;
    int descriptor_ = -1;
    int complaints_ = -1;
    std::string shown_as_;  ///< its name, if its standard error is copied to this program's
};

/// The path of a helper program: `in_its_place`, or the one beside the running executable, or, for an
/// executable in a folder bin, the one in ../libexec/octoskin/. Never the path of the build. The error
/// message contains the remedy.
[[nodiscard]] Result<std::filesystem::path, std::string> find_helper(
    const std::string& name, const std::optional<std::filesystem::path>& in_its_place = {});

}  // namespace octoskin::openni2
