// The exception of a command that fails.
#pragma once

#include <stdexcept>
#include <utility>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin::app {

/// Thrown by a command; run_program() turns it into a message and an exit code.
class CommandFailure : public std::runtime_error {
  public:
    explicit CommandFailure(const AppError& error) : std::runtime_error(error.message), code_(error.code) {}
    [[nodiscard]] ExitCode code() const noexcept { return code_; }

  private:
    ExitCode code_;
};

/// Returns the value of the result, or throws its error as CommandFailure.
template <class T>
[[nodiscard]] T value_or_fail(Result<T, AppError> result) {
    if (!result) throw CommandFailure(result.error());
    return std::move(result).value();
}

}  // namespace octoskin::app
