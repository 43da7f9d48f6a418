// Runs independent tasks on several threads and returns their results in order.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "common/result.hpp"

namespace octoskin {

/// The results of `work(0)` to `work(count - 1)`, in that order, computed by up to `jobs` threads (at least
/// one). After the first error or exception no new task begins. It is returned, or rethrown here, after the
/// running tasks have ended.
template <class T, class E>
[[nodiscard]] Result<std::vector<T>, E> work_in_parallel(
    std::size_t count, unsigned jobs, const std::function<Result<T, E>(std::size_t index)>& work) {
    std::mutex mutex;  // guards all below except `next`
    std::vector<std::optional<T>> results(count);
    std::optional<E> error;
    std::exception_ptr exception;
    std::atomic<std::size_t> next{0};

    const auto take_results = [&] {
        for (std::size_t index = next++; index < count; index = next++) {
            try {
                Result<T, E> result = work(index);
                const std::lock_guard lock(mutex);
                if (result) {
                    results[index].emplace(std::move(*result));
                } else {
                    if (!error) error = result.error();
                    next = count;
                }
            } catch (...) {  // an exception must not leave its thread
                const std::lock_guard lock(mutex);
                if (!exception) exception = std::current_exception();
                next = count;
            }
        }
    };
    {
        std::vector<std::jthread> threads;
        const std::size_t used = std::min<std::size_t>(std::max(jobs, 1U), count);
        for (std::size_t i = 0; i < used; ++i) threads.emplace_back(take_results);
    }
    if (exception) std::rethrow_exception(exception);
    if (error) return unexpected(std::move(*error));
    std::vector<T> done;
    for (std::optional<T>& result : results) done.push_back(std::move(*result));
    return done;
}

}  // namespace octoskin
