// A board that runs one of the tiny programs, without sensors.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "hw/sim/stm32g474/nucleo_board.hpp"

namespace octoskin::sim::stm32 {

class TinyBoard {
  public:
    explicit TinyBoard(const std::string& program, const NucleoOptions& options = {})
        : image_(ElfImage::load(std::string(OCTOSKIN_TINY_PROGRAMS) + "/" + program + ".elf").value()),
          board_(std::make_unique<NucleoBoard>(options, image_, std::span<const std::uint8_t>{})) {}

    [[nodiscard]] NucleoBoard& board() { return *board_; }
    void jump(const std::string& function) { board_->jump(function); }
    /// Runs until the program says so, at most `limit_us` of simulated time. Whether it did.
    bool run_until_finished(std::uint32_t stage = 1, std::int64_t limit_us = 1'000'000) {
        const std::int64_t end = board_->now().us + limit_us;
        while (board_->now().us < end && state() != stage) board_->run_until({board_->now().us + 20});
        return state() == stage;
    }
    [[nodiscard]] std::uint32_t result(std::uint32_t index) const {
        return board_->ram_word(image_.address_of("result").value() + 4 * index);
    }
    [[nodiscard]] std::uint32_t state() const {
        return board_->ram_word(image_.address_of("is_finished").value());
    }
    [[nodiscard]] std::string violations() const {
        std::string text;
        for (const Violation& violation : board_->log().all())
            text += std::string(name_of(violation.rule)) + ": " + violation.what + "\n";
        return text;
    }

  private:
    ElfImage image_;
    std::unique_ptr<NucleoBoard> board_;
};

}  // namespace octoskin::sim::stm32
