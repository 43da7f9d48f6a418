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

/// "gpiochip0:17,27" gives two lines. Empty if the text cannot be parsed.
[[nodiscard]] std::optional<std::vector<LineName>> parse_lines(const std::string& text);
/// "gpiochip0:17".
[[nodiscard]] std::string text(const LineName& line);

/// One requested line, released by the destructor.
class GpioLine {
  public:
    enum class Use : std::uint8_t {
        output_low,     ///< push-pull, low from the request on
        falling_edges,  ///< input, with the chip's pull-up if it has one; the kernel records each falling
                        ///< edge
    };
    /// Errors: no such chip or line, no permission, or another process holds the line.
    [[nodiscard]] static Result<GpioLine, StartFailure> request(const LineName& name, Use use);
    ~GpioLine();
    GpioLine(GpioLine&& other) noexcept;
    GpioLine& operator=(GpioLine&& other) noexcept;

    /// For an output. False if the kernel refused.
    [[nodiscard]] bool set(bool is_high);
    /// For falling edges: a descriptor that is readable while edges are recorded.
    [[nodiscard]] int descriptor() const;
    /// Takes all recorded edges; returns whether there were any.
    [[nodiscard]] bool take_falls();

  private:
    GpioLine(gpiod_chip* chip, gpiod_line* line) noexcept : chip_(chip), line_(line) {}
    gpiod_chip* chip_ = nullptr;
    gpiod_line* line_ = nullptr;
};

/// The XSHUT outputs. All are low from the request on and again at the end, so that sensors are in reset
/// while no node runs.
class XshutOutputs final : public node::XshutLines {
  public:
    /// In the order of the configuration's `xshut_line`. Errors as for `GpioLine::request`.
    [[nodiscard]] static Result<XshutOutputs, StartFailure> request(std::span<const LineName> names);
    ~XshutOutputs();
    XshutOutputs(XshutOutputs&&) noexcept = default;
    XshutOutputs& operator=(XshutOutputs&&) = delete;

    void set(std::uint8_t line, bool is_high) override;
    /// Sets all lines low. Returns how many the kernel refused to set.
    [[nodiscard]] std::size_t set_all_low();
    /// Number of times that the kernel refused to set a line.
    [[nodiscard]] std::uint64_t failures() const noexcept { return failures_; }

  private:
    explicit XshutOutputs(std::vector<GpioLine> lines) noexcept : lines_(std::move(lines)) {}
    std::vector<GpioLine> lines_;
    std::uint64_t failures_ = 0;
};

/// One data-ready input per bus. After a falling edge, the program does not wait for the line again until the
/// core has called `take_fall`, so a line that toggles fast costs no more wake-ups.
class DataReadyInputs final : public node::DataReadyLines {
  public:
    /// In the order of the buses. Errors as for `GpioLine::request`.
    [[nodiscard]] static Result<DataReadyInputs, StartFailure> request(std::span<const LineName> names);

    [[nodiscard]] bool take_fall(std::uint8_t bus) override;

    /// Descriptor of bus `bus` to wait for; -1 while an edge is not yet taken, if the bus has no line, or if
    /// the line is gone.
    [[nodiscard]] int descriptor(std::size_t bus) const;
    /// Call when the descriptor is readable. If there is no edge to read, the line is gone with its chip: the
    /// descriptor would stay readable for ever.
    void on_readable(std::size_t bus);
    /// Lines that are gone, in the order of their loss; as "gpiochip0:17".
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
