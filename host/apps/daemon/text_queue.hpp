// Text for a file that another thread writes: adding to it never waits for the disk.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <utility>

namespace octoskin {

class TextQueue {
  public:
    /// Beyond this many bytes no more text is accepted.
    explicit TextQueue(std::size_t bytes_max) : bytes_max_(bytes_max) {}

    /// False if there was no room: none of it will be written.
    [[nodiscard]] bool add(const std::string& text) {
        const std::lock_guard lock(mutex_);
        if (text_.size() + text.size() > bytes_max_) return false;
        text_ += text;
        return true;
    }
    /// All waiting text.
    [[nodiscard]] std::string take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(text_, {});
    }

  private:
    std::size_t bytes_max_;
    std::mutex mutex_;
    std::string text_;
};

}  // namespace octoskin
