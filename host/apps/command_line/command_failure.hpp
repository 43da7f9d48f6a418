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
    explicit CommandFailure(AppError error) : std::runtime_error(error.message()), error_(std::move(error)) {}
    CommandFailure(ExitCode exit, Error error) : CommandFailure(AppError{exit, std::move(error)}) {}
    [[nodiscard]] const AppError& error() const noexcept { return error_; }

  private:
    AppError error_;
};

/// Returns the value of the result, or throws its error as CommandFailure.
template <class T>
[[nodiscard]] T value_or_fail(Result<T, AppError> result) {
    if (!result) throw CommandFailure(std::move(result).error());
    return std::move(result).value();
}

}  // namespace octoskin::app
