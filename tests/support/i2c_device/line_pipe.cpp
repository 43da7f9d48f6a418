#include "tests/support/i2c_device/line_pipe.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace octoskin::test {

// Opened for writing too, so that it has no end when a writer closes it.
LinePipe::LinePipe(const std::string& path) : pipe_(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
    if (pipe_ < 0) throw std::runtime_error(path + ": " + std::strerror(errno));
}

LinePipe::~LinePipe() {
    ::close(pipe_);
}

std::optional<std::string> LinePipe::next() {
    std::array<char, 256> bytes{};
    const ssize_t count = ::read(pipe_, bytes.data(), bytes.size());
    if (count > 0) read_.append(bytes.data(), static_cast<std::size_t>(count));
    const std::size_t end = read_.find('\n');
    if (end == std::string::npos) return std::nullopt;
    std::string line = read_.substr(0, end);
    read_.erase(0, end + 1);
    return line;
}

}  // namespace octoskin::test
