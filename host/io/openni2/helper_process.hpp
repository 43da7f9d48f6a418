// Starting a helper program with a pipe to or from it, and never waiting for it without a limit.
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

/// Which of the helper's standard streams is our end of the pipe.
enum class HelperPipe : std::uint8_t { its_input, its_output };

/// Where its standard error goes.
enum class HelperComplaints : std::uint8_t {
    on_our_standard_error,  ///< when it ends, each line as helper_lines() has it; what is too much is lost
    kept,                   ///< for `complaint`; what is too much for a pipe is lost
};

/// What a helper allows itself (host/io/helper_limits), and how it ends when that is not enough: with this
/// exit code, or by SIGXCPU.
inline constexpr unsigned kHelperMemoryMib = 2048;
inline constexpr unsigned kHelperProcessorSecondsPerFrame = 5;
inline constexpr int kOutOfMemory = 70;

/// How much longer a helper may take to begin for so many bytes of a recording, all of which it reads first:
/// a second for each 20 MB.
[[nodiscard]] constexpr std::chrono::milliseconds time_to_check(std::uintmax_t bytes) {
    return std::chrono::milliseconds(bytes / 20'000);
}

class HelperProcess {
  public:
    static constexpr int kInherited = 3;

    /// Starts `program` with `arguments`, with no signal blocked or ignored. The message says what failed.
    /// `inherited`: a file or folder of ours that the helper has, too, as its descriptor kInherited, for as
    /// long as it lives; -1: none.
    [[nodiscard]] static Result<HelperProcess, std::string> start(
        const std::filesystem::path& program, const std::vector<std::string>& arguments, HelperPipe pipe,
        HelperComplaints complaints = HelperComplaints::on_our_standard_error, int inherited = -1);
    HelperProcess(HelperProcess&& other) noexcept;
    HelperProcess& operator=(HelperProcess&& other) noexcept;
    /// Ends a helper that still runs. One that the kernel does not let go of within a second is left
    /// behind, and reaped when another helper begins or ends.
    ~HelperProcess();

    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    /// Our end: an input helper then sees its end of file.
    void close_pipe();
    /// Waits for the helper's own end. Empty: it exited with 0; else how it ended, in words ("exit code 1",
    /// "signal 11", "did not end in time": it is killed then; the limit that it reached).
    [[nodiscard]] std::optional<std::string> wait(std::chrono::milliseconds patience);

    /// The last line of its complaints so far, if they are kept; empty if there is none. Takes what was read.
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
    std::string shown_as_;  ///< its name, if its complaints are for our standard error
};

/// A helper program: `in_its_place`, or the one beside the running executable, or that in
/// ../libexec/octoskin/ of one in a folder bin; never one where it happened to be built. The message says
/// what to do about one that is nowhere.
[[nodiscard]] Result<std::filesystem::path, std::string> find_helper(
    const std::string& name, const std::optional<std::filesystem::path>& in_its_place = {});

}  // namespace octoskin::openni2
