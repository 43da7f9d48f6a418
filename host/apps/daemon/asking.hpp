// How a program asks the daemon: a line to its control socket, and a line back.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// How long a daemon may take at most until it lets us in, however long it may take to answer.
inline constexpr std::chrono::milliseconds kLetInMax{5'000};

/// Asks a daemon one thing, and waits so long at most, in all, until it lets us in and its whole line is
/// here. With more patience than `kLetInMax` a daemon that is there is asked for a sign of life first, which
/// it has so long for: what it says instead is the answer.
[[nodiscard]] Result<std::string, AppError> ask_daemon(const std::filesystem::path& socket,
                                                       const std::string& request,
                                                       std::chrono::milliseconds patience = kLetInMax);
/// What came from there is not what a daemon of this version answers.
[[nodiscard]] AppError foreign_answer(const std::filesystem::path& socket);

}  // namespace octoskin
