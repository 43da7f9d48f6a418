// Requests to the daemon: a line to its control socket, and a line back.
#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// How long a daemon may take to accept a connection, however long its answer takes.
inline constexpr std::chrono::milliseconds kLetInMax{5'000};

/// Sends one request to a daemon, and waits at most `patience` in all until it accepts the connection and its
/// whole answer line has arrived. If `patience` exceeds `kLetInMax`, the daemon must first answer "hello"
/// within `kLetInMax`; an answer other than {"ok":true} is returned in place of the answer.
[[nodiscard]] Result<std::string, AppError> ask_daemon(const std::filesystem::path& socket,
                                                       const std::string& request,
                                                       std::chrono::milliseconds patience = kLetInMax);
/// The daemon's status: an answer with what `octoskin status` and `octoskin monitor` show first.
[[nodiscard]] Result<nlohmann::ordered_json, AppError> ask_status(const std::filesystem::path& socket);
/// True if JSON nests too deep for its reader and writer, which recurse for each level. A daemon's answers
/// have fewer than ten levels. O(bytes).
[[nodiscard]] bool is_nested_too_deep(std::string_view json);
/// The error for an answer that no daemon of this version gives.
[[nodiscard]] AppError foreign_answer(const std::filesystem::path& socket);

}  // namespace octoskin
