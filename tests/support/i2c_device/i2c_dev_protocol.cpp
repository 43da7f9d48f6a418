#include "tests/support/i2c_device/i2c_dev_protocol.hpp"

#define FUSE_USE_VERSION 31
#include <cuse_lowlevel.h>
#include <fuse_lowlevel.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <sys/uio.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace octoskin::test {
namespace {

constexpr std::size_t kMessageBytesMax = 8192;  // i2c-dev's own limit
constexpr std::uint16_t kAddressMax = 0x7F;

using Bytes = std::vector<std::uint8_t>;

struct OpenFile {
    i2c::Address address = 0;
};

ServedBus& bus_of(fuse_req_t request) {
    return *static_cast<ServedBus*>(fuse_req_userdata(request));
}
OpenFile& file_of(const fuse_file_info* info) {
    return *reinterpret_cast<OpenFile*>(info->fh);
}

void open_file(fuse_req_t request, fuse_file_info* info) {
    auto* file = new OpenFile;
    info->fh = reinterpret_cast<std::uint64_t>(file);
    if (fuse_reply_open(request, info) != 0) delete file;
}

void release_file(fuse_req_t request, fuse_file_info* info) {
    delete &file_of(info);
    fuse_reply_err(request, 0);
}

void read_file(fuse_req_t request, std::size_t size, off_t, fuse_file_info* info) {
    Bytes bytes(std::min(size, kMessageBytesMax));
    const int error = bus_of(request).transfer(file_of(info).address, {}, bytes);
    if (error != 0) {
        fuse_reply_err(request, error);
    } else {
        fuse_reply_buf(request, reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
}

void write_file(fuse_req_t request, const char* data, std::size_t size, off_t, fuse_file_info* info) {
    const Bytes bytes(data, data + std::min(size, kMessageBytesMax));
    const int error = bus_of(request).transfer(file_of(info).address, bytes, {});
    if (error != 0) {
        fuse_reply_err(request, error);
    } else {
        fuse_reply_write(request, bytes.size());
    }
}

iovec caller_memory(const void* address, std::size_t size) {
    return {.iov_base = const_cast<void*>(address), .iov_len = size};
}

// The memory of an I2C_RDWR call. CUSE copies only requested parts of the caller's memory, so each round
// requests the parts that the one before gave the addresses of: the argument, then its messages, then their
// bytes.
struct CombinedTransfer {
    std::vector<i2c_msg> messages;
    std::vector<iovec> in;   // argument, messages, bytes of every write
    std::vector<iovec> out;  // bytes of every read

    [[nodiscard]] static std::size_t size(const std::vector<iovec>& parts) {
        std::size_t sum = 0;
        for (const iovec& part : parts) sum += part.iov_len;
        return sum;
    }
};

bool is_supported(const i2c_msg& message) {
    return (message.flags & ~I2C_M_RD) == 0 && message.addr <= kAddressMax && message.len <= kMessageBytesMax;
}

// Evaluates the `size` bytes of `data` received so far; 0 or an error number.
int understand(const void* argument, const char* data, std::size_t size, CombinedTransfer& transfer) {
    transfer.in.push_back(caller_memory(argument, sizeof(i2c_rdwr_ioctl_data)));
    if (size < sizeof(i2c_rdwr_ioctl_data)) return 0;
    i2c_rdwr_ioctl_data list{};
    std::memcpy(&list, data, sizeof list);
    if (list.nmsgs == 0 || list.nmsgs > I2C_RDWR_IOCTL_MAX_MSGS) return EINVAL;
    const std::size_t list_size = list.nmsgs * sizeof(i2c_msg);
    transfer.in.push_back(caller_memory(list.msgs, list_size));
    if (size < sizeof list + list_size) return 0;
    transfer.messages.resize(list.nmsgs);
    std::memcpy(transfer.messages.data(), data + sizeof list, list_size);
    for (const i2c_msg& message : transfer.messages) {
        if (!is_supported(message)) return EOPNOTSUPP;
        if (message.len == 0) continue;
        auto& parts = (message.flags & I2C_M_RD) != 0 ? transfer.out : transfer.in;
        parts.push_back(caller_memory(message.buf, message.len));
    }
    return 0;
}

// `written` is the bytes of all writes in a row; `answer` becomes those of all reads. 0 or an error number.
int run(ServedBus& bus, const std::vector<i2c_msg>& messages, std::span<const std::uint8_t> written,
        std::span<std::uint8_t> answer) {
    for (std::size_t i = 0; i < messages.size(); ++i) {
        const i2c_msg& first = messages[i];
        std::span<const std::uint8_t> write;
        std::span<std::uint8_t> read;
        const i2c_msg* reader = &first;
        if ((first.flags & I2C_M_RD) == 0) {
            write = written.first(first.len);
            written = written.subspan(first.len);
            const bool is_read_behind = i + 1 < messages.size() && messages[i + 1].flags == I2C_M_RD &&
                                        messages[i + 1].addr == first.addr;
            reader = is_read_behind ? &messages[++i] : nullptr;
        }
        if (reader != nullptr) {
            read = answer.first(reader->len);
            answer = answer.subspan(reader->len);
        }
        const int error = bus.transfer(static_cast<i2c::Address>(first.addr), write, read);
        if (error != 0) return error;
    }
    return 0;
}

void transfer_combined(fuse_req_t request, const void* argument, const void* in, std::size_t in_size,
                       std::size_t out_size) {
    CombinedTransfer transfer;
    const char* data = static_cast<const char*>(in);
    if (const int error = understand(argument, data, in_size, transfer); error != 0) {
        fuse_reply_err(request, error);
        return;
    }
    const std::size_t in_needed = CombinedTransfer::size(transfer.in);
    const std::size_t out_needed = CombinedTransfer::size(transfer.out);
    if (transfer.messages.empty() || in_size < in_needed || out_size < out_needed) {
        fuse_reply_ioctl_retry(request, transfer.in.data(), transfer.in.size(), transfer.out.data(),
                               transfer.out.size());
        return;
    }
    const std::size_t head = sizeof(i2c_rdwr_ioctl_data) + transfer.messages.size() * sizeof(i2c_msg);
    const Bytes written(data + head, data + in_needed);
    Bytes answer(out_needed);
    const int error = run(bus_of(request), transfer.messages, written, answer);
    if (error != 0) {
        fuse_reply_err(request, error);
    } else {
        fuse_reply_ioctl(request, static_cast<int>(transfer.messages.size()), answer.data(), answer.size());
    }
}

void report_functions(fuse_req_t request, const void* argument, std::size_t out_size) {
    const unsigned long functions = I2C_FUNC_I2C;
    if (out_size < sizeof functions) {
        const iovec out = caller_memory(argument, sizeof functions);
        fuse_reply_ioctl_retry(request, nullptr, 0, &out, 1);
    } else {
        fuse_reply_ioctl(request, 0, &functions, sizeof functions);
    }
}

void set_address(fuse_req_t request, const void* argument, const fuse_file_info* info) {
    const auto address = reinterpret_cast<std::uintptr_t>(argument);  // the argument itself, no pointer
    if (address > kAddressMax) {
        fuse_reply_err(request, EINVAL);
        return;
    }
    file_of(info).address = static_cast<i2c::Address>(address);
    fuse_reply_ioctl(request, 0, nullptr, 0);
}

void control_file(fuse_req_t request, int command, void* argument, fuse_file_info* info, unsigned flags,
                  const void* in, std::size_t in_size, std::size_t out_size) {
    if ((flags & FUSE_IOCTL_COMPAT) != 0) {
        fuse_reply_err(request, ENOSYS);  // a 32-bit program on a 64-bit kernel
        return;
    }
    switch (command) {
        case I2C_RDWR:
            transfer_combined(request, argument, in, in_size, out_size);
            return;
        case I2C_FUNCS:
            report_functions(request, argument, out_size);
            return;
        case I2C_SLAVE:
        case I2C_SLAVE_FORCE:
            set_address(request, argument, info);
            return;
        case I2C_RETRIES:
        case I2C_TIMEOUT:
            fuse_reply_ioctl(request, 0, nullptr, 0);  // nothing here is retried or takes long
            return;
        default:
            fuse_reply_err(request, ENOTTY);
            return;
    }
}

}  // namespace

void I2cDevice::EndSession::operator()(fuse_session* session) const noexcept {
    cuse_lowlevel_teardown(session);
}

I2cDevice::I2cDevice(const std::string& name, ServedBus& bus) {
    const std::string device = "DEVNAME=" + name;
    std::array<const char*, 1> device_info{device.c_str()};
    cuse_info info{};
    info.dev_info_argc = static_cast<unsigned>(device_info.size());
    info.dev_info_argv = device_info.data();
    info.flags = CUSE_UNRESTRICTED_IOCTL;
    cuse_lowlevel_ops operations{};
    operations.open = open_file;
    operations.release = release_file;
    operations.read = read_file;
    operations.write = write_file;
    operations.ioctl = control_file;
    std::string program = "i2c_device";
    std::string foreground = "-f";
    std::string single_thread = "-s";
    std::array<char*, 3> arguments{program.data(), foreground.data(), single_thread.data()};
    int is_multithreaded = 0;
    session_.reset(cuse_lowlevel_setup(static_cast<int>(arguments.size()), arguments.data(), &info,
                                       &operations, &is_multithreaded, &bus));
    if (!session_) throw std::runtime_error("/dev/" + name + " cannot be served through /dev/cuse");
}

void I2cDevice::serve() {
    fuse_session_loop(session_.get());
}

}  // namespace octoskin::test
