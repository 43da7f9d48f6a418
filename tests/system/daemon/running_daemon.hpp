// `octoskin run` as a process of its own, on one end of a socketpair.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/scratch_folder.hpp"

namespace octoskin::test {

inline constexpr const char* kExperiment = OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml";

class RunningDaemon {
  public:
    /// `descriptor`: its end of the bus; closed here once the process has it.
    RunningDaemon(const testing_support::ScratchFolder& folder, int descriptor,
                  const std::vector<std::string>& more_arguments = {},
                  const std::filesystem::path& rig = kExperiment);
    ~RunningDaemon();
    RunningDaemon(const RunningDaemon&) = delete;
    RunningDaemon& operator=(const RunningDaemon&) = delete;

    [[nodiscard]] pid_t process() const { return process_; }
    void signal(int number) const;
    /// Its exit code, or -signal; empty if it still runs after `patience`.
    [[nodiscard]] std::optional<int> wait(std::chrono::milliseconds patience);
    /// What `octoskin status --json` is made of; null if it does not answer.
    [[nodiscard]] nlohmann::json status() const;
    /// Asks until `holds`, for `patience` at most; how long that took, or empty.
    [[nodiscard]] std::optional<std::chrono::milliseconds> wait_until(
        const std::function<bool(const nlohmann::json&)>& holds, std::chrono::milliseconds patience) const;
    [[nodiscard]] std::string log() const;

    [[nodiscard]] std::filesystem::path joints() const { return folder_ / "joints"; }
    [[nodiscard]] std::filesystem::path maps() const { return folder_ / "maps"; }

  private:
    const testing_support::ScratchFolder& folder_;
    pid_t process_ = -1;
};

}  // namespace octoskin::test
