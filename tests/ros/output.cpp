#include "tests/ros/output.hpp"

#include <csignal>
#include <cstdio>
#include <mutex>

namespace octoskin::ros {
namespace {

volatile std::sig_atomic_t told_to_end = 0;

}  // namespace

void print(const Json& event) {
    static std::mutex mutex;
    const std::string text = line(event) + "\n";
    const std::lock_guard lock(mutex);
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
}

bool is_told_to_end() {
    static const bool is_installed = [] {
        struct sigaction action {};  // interrupts a read from standard input
        action.sa_handler = [](int) { told_to_end = 1; };
        sigaction(SIGINT, &action, nullptr);
        sigaction(SIGTERM, &action, nullptr);
        return true;
    }();
    return is_installed && told_to_end != 0;
}

}  // namespace octoskin::ros
