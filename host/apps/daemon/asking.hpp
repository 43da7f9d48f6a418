// How a program asks the daemon: a line to its control socket, and a line back.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// Asks a daemon one thing, and waits so long at most, in all, until it lets us in and its whole line is
/// here.
[[nodiscard]] Result<std::string, AppError> ask_daemon(
    const std::filesystem::path& socket, const std::string& request,
    std::chrono::milliseconds patience = std::chrono::seconds{5});
/// What came from there is not what a daemon of this version answers.
[[nodiscard]] AppError foreign_answer(const std::filesystem::path& socket);

}  // namespace octoskin
