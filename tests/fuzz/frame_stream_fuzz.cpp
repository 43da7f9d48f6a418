// A stream of depth frames, as a program feeds a camera with: what is read of it, written again, is its
// beginning.
#include <sys/mman.h>
#include <unistd.h>

#include <cassert>
#include <chrono>
#include <string>
#include <string_view>

#include "host/io/openni2/frame_pipe.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace octoskin::openni2 {
namespace {

constexpr std::chrono::milliseconds kNoWait{0};
constexpr std::size_t kSalvagedAt = 16;  ///< of the header: any number but 0 is a yes

/// A file in memory in place of a connection.
class Memory {
  public:
    explicit Memory(std::string_view bytes = {}) : descriptor_(::memfd_create("stream", MFD_CLOEXEC)) {
        assert(descriptor_ >= 0);
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        assert(written == static_cast<ssize_t>(bytes.size()));
        (void)written;
        ::lseek(descriptor_, 0, SEEK_SET);
    }
    ~Memory() { ::close(descriptor_); }
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    FramePipe pipe() const { return {descriptor_, kNoWait}; }
    std::string content() const {
        std::string bytes(static_cast<std::size_t>(::lseek(descriptor_, 0, SEEK_END)), '\0');
        const ssize_t read = ::pread(descriptor_, bytes.data(), bytes.size(), 0);
        assert(read == static_cast<ssize_t>(bytes.size()));
        (void)read;
        return bytes;
    }

  private:
    int descriptor_;
};

/// Writes the next frame of `from` to `to`; false if there is none.
bool copy_frame(FramePipe& from, FramePipe& to, FrameSize size) {
    const auto frame = from.read_frame(size);
    if (!frame) {
        assert(frame.error() == PipeError::closed);
        return false;
    }
    if (!frame->has_value()) {
        assert(to.write_end());
        return false;
    }
    const PipedFrame& read = **frame;
    assert(read.depth_mm.size() == (read.is_timed ? size.pixels() : 0));
    const auto written =
        read.is_timed ? to.write_frame(read.timestamp_us, read.depth_mm) : to.write_untimed_frame();
    assert(written);
    return static_cast<bool>(written);
}

}  // namespace
}  // namespace octoskin::openni2

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin::openni2;
    const std::string_view bytes = octoskin::fuzz::text_of({data, size});
    const Memory given(bytes);
    const Memory copy;
    FramePipe from = given.pipe();
    FramePipe to = copy.pipe();
    const auto header = from.read_header();
    if (!header) {
        assert(header.error() == PipeError::closed || header.error() == PipeError::wrong_format);
        return 0;
    }
    assert(header->size.pixels() > 0 && header->size.pixels() <= kPixelsMax);
    assert(to.write_header(*header));
    while (copy_frame(from, to, header->size)) continue;
    std::string written = copy.content();
    for (std::size_t i = kSalvagedAt; i < kSalvagedAt + sizeof(std::uint32_t); ++i) written[i] = bytes[i];
    assert(bytes.starts_with(written));
    return 0;
}
