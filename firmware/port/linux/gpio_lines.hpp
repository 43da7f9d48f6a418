// GPIO lines of Linux through libgpiod 1.6: the node's XSHUT outputs and its data-ready inputs.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/result.hpp"
#include "firmware/core/ports.hpp"
#include "firmware/port/linux/start_failure.hpp"

struct gpiod_chip;
struct gpiod_line;

namespace octoskin::linux_port {

/// One line of one chip.
struct LineName {
    std::string chip;  ///< "gpiochip0", or a path
    unsigned offset = 0;
    friend bool operator==(const LineName&, const LineName&) = default;
};

/// "gpiochip0:17,27" is two lines. Empty: not understood.
[[nodiscard]] std::optional<std::vector<LineName>> parse_lines(const std::string& text);
/// "gpiochip0:17".
[[nodiscard]] std::string text(const LineName& line);

/// A line that is ours until the end.
class GpioLine {
  public:
    enum class Use : std::uint8_t {
        output_low,     ///< push-pull, low from the first moment on
        falling_edges,  ///< an input with the chip's pull-up, where it has one; each fall is kept by the
                        ///< kernel
    };
    [[nodiscard]] static Result<GpioLine, StartFailure> request(const LineName& name, Use use);
    ~GpioLine();
    GpioLine(GpioLine&& other) noexcept;
    GpioLine& operator=(GpioLine&& other) noexcept;

    /// Of an output. False: the kernel refused.
    [[nodiscard]] bool set(bool is_high);
    /// Of falling edges: readable while there are some.
    [[nodiscard]] int descriptor() const;
    /// Takes away all falls that there are; whether there were any.
    [[nodiscard]] bool take_falls();

  private:
    GpioLine(gpiod_chip* chip, gpiod_line* line) noexcept : chip_(chip), line_(line) {}
    gpiod_chip* chip_ = nullptr;
    gpiod_line* line_ = nullptr;
};

/// All low from the request on, and again at the end: sensors are in reset whenever no node looks after them.
class XshutOutputs final : public node::XshutLines {
  public:
    /// In the order of the configuration's `xshut_line`.
    [[nodiscard]] static Result<XshutOutputs, StartFailure> request(std::span<const LineName> names);
    ~XshutOutputs();
    XshutOutputs(XshutOutputs&&) noexcept = default;
    XshutOutputs& operator=(XshutOutputs&&) = delete;

    void set(std::uint8_t line, bool is_high) override;
    /// How many the kernel refused to set.
    [[nodiscard]] std::size_t set_all_low();
    /// Times that the kernel refused to set one.
    [[nodiscard]] std::uint64_t failures() const noexcept { return failures_; }

  private:
    explicit XshutOutputs(std::vector<GpioLine> lines) noexcept : lines_(std::move(lines)) {}
    std::vector<GpioLine> lines_;
    std::uint64_t failures_ = 0;
};

/// One input a bus. Listened to from one question of the core's to the next fall, so that a line that
/// chatters costs nothing.
class DataReadyInputs final : public node::DataReadyLines {
  public:
    /// In the order of the buses.
    [[nodiscard]] static Result<DataReadyInputs, StartFailure> request(std::span<const LineName> names);

    [[nodiscard]] bool take_fall(std::uint8_t bus) override;

    /// To wait for, of bus `bus`; -1 while it is not listened to, or has no line, or is gone.
    [[nodiscard]] int descriptor(std::size_t bus) const;
    /// Its descriptor is readable. Where there is no fall to be read all the same the line is gone with its
    /// chip: the descriptor would be readable for good.
    void on_readable(std::size_t bus);
    /// Those that are gone, in the order in which they went; as "gpiochip0:17".
    [[nodiscard]] const std::vector<std::string>& gone() const noexcept { return gone_; }

  private:
    struct Input {
        GpioLine line;
        std::string name;
        bool has_fallen = false;
        bool is_gone = false;
    };
    std::vector<Input> inputs_;
    std::vector<std::string> gone_;
};

}  // namespace octoskin::linux_port
