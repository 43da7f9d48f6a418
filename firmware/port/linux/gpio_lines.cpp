#include "firmware/port/linux/gpio_lines.hpp"

#include <gpiod.h>

#include <cassert>
#include <cerrno>
#include <charconv>
#include <ctime>
#include <utility>

namespace octoskin::linux_port {
namespace {

constexpr const char* kConsumer = "octoskin-node";

/// Returns 0 or the kernel's error number. Where the chip has no pull-up, the line needs an external one.
int request_line(gpiod_line* line, GpioLine::Use use) {
    const bool is_done =
        use == GpioLine::Use::output_low
            ? ::gpiod_line_request_output(line, kConsumer, 0) == 0
            : ::gpiod_line_request_falling_edge_events_flags(line, kConsumer,
                                                             GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP) == 0 ||
                  (errno != EBUSY && ::gpiod_line_request_falling_edge_events(line, kConsumer) == 0);
    return is_done ? 0 : errno;
}

Result<std::vector<GpioLine>, StartFailure> request_all(std::span<const LineName> names, GpioLine::Use use) {
    std::vector<GpioLine> lines;
    for (const LineName& name : names) {
        auto line = GpioLine::request(name, use);
        if (!line) return unexpected(line.error());
        lines.push_back(std::move(*line));
    }
    return lines;
}

}  // namespace

std::optional<std::vector<LineName>> parse_lines(const std::string& text) {
    const std::size_t colon = text.rfind(':');
    if (colon == 0 || colon == std::string::npos) return std::nullopt;
    std::vector<LineName> lines;
    const char* at = text.data() + colon + 1;
    const char* const end = text.data() + text.size();
    while (true) {
        LineName line{.chip = text.substr(0, colon)};
        const auto [after, error] = std::from_chars(at, end, line.offset);
        if (error != std::errc{}) return std::nullopt;
        lines.push_back(std::move(line));
        if (after == end) return lines;
        if (*after != ',') return std::nullopt;
        at = after + 1;
    }
}

std::string text(const LineName& line) {
    return line.chip + ":" + std::to_string(line.offset);
}

Result<GpioLine, StartFailure> GpioLine::request(const LineName& name, Use use) {
    gpiod_chip* const chip = ::gpiod_chip_open_lookup(name.chip.c_str());
    if (chip == nullptr) return unexpected(device_failure("GPIO chip " + name.chip, errno));
    GpioLine line(chip, ::gpiod_chip_get_line(chip, name.offset));
    if (line.line_ == nullptr)
        return refuse(ExitCode::unavailable, text(name) + ": the chip has no such line");
    if (const int error_number = request_line(line.line_, use); error_number != 0)
        return unexpected(device_failure("GPIO line " + text(name), error_number));
    return line;
}

GpioLine::~GpioLine() {
    if (chip_ != nullptr) ::gpiod_chip_close(chip_);  // also releases the line
}

GpioLine::GpioLine(GpioLine&& other) noexcept
    : chip_(std::exchange(other.chip_, nullptr)), line_(std::exchange(other.line_, nullptr)) {}

GpioLine& GpioLine::operator=(GpioLine&& other) noexcept {
    std::swap(chip_, other.chip_);
    std::swap(line_, other.line_);
    return *this;
}

bool GpioLine::set(bool is_high) {
    return ::gpiod_line_set_value(line_, is_high ? 1 : 0) == 0;
}

int GpioLine::descriptor() const {
    return ::gpiod_line_event_get_fd(line_);
}

bool GpioLine::take_falls() {
    constexpr int kTurnsMax = 4;  // the kernel keeps 16 events per line
    constexpr timespec kNoWait{};
    bool has_fallen = false;
    for (int i = 0; i < kTurnsMax && ::gpiod_line_event_wait(line_, &kNoWait) == 1; ++i) {
        std::array<gpiod_line_event, 16> events{};
        if (::gpiod_line_event_read_multiple(line_, events.data(), events.size()) <= 0) break;
        has_fallen = true;
    }
    return has_fallen;
}

Result<XshutOutputs, StartFailure> XshutOutputs::request(std::span<const LineName> names) {
    auto lines = request_all(names, GpioLine::Use::output_low);
    if (!lines) return unexpected(lines.error());
    return XshutOutputs(std::move(*lines));
}

XshutOutputs::~XshutOutputs() {
    (void)set_all_low();
}

std::size_t XshutOutputs::set_all_low() {
    std::size_t refused = 0;
    for (GpioLine& line : lines_) refused += line.set(false) ? 0U : 1U;
    return refused;
}

void XshutOutputs::set(std::uint8_t line, bool is_high) {
    assert(line < lines_.size());
    if (!lines_[line].set(is_high)) ++failures_;
}

Result<DataReadyInputs, StartFailure> DataReadyInputs::request(std::span<const LineName> names) {
    auto lines = request_all(names, GpioLine::Use::falling_edges);
    if (!lines) return unexpected(lines.error());
    DataReadyInputs inputs;
    for (std::size_t i = 0; i < names.size(); ++i)
        inputs.inputs_.push_back({.line = std::move((*lines)[i]), .name = text(names[i])});
    return inputs;
}

bool DataReadyInputs::take_fall(std::uint8_t bus) {
    assert(bus < inputs_.size());
    Input& input = inputs_[bus];
    return std::exchange(input.has_fallen, false) || input.line.take_falls();
}

int DataReadyInputs::descriptor(std::size_t bus) const {
    if (bus >= inputs_.size() || inputs_[bus].has_fallen || inputs_[bus].is_gone) return -1;
    return inputs_[bus].line.descriptor();
}

void DataReadyInputs::on_readable(std::size_t bus) {
    Input& input = inputs_[bus];
    input.has_fallen = input.line.take_falls();  // the program waits only for a line that has not fallen
    input.is_gone = !input.has_fallen;
    if (input.is_gone) gone_.push_back(input.name);
}

}  // namespace octoskin::linux_port
