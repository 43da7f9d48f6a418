// Keeps an import from filling the disk: a bag of some KB can become any amount of frames.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin::bridge {

class OutputRoom {
  public:
    static constexpr std::uint64_t kMiB = std::uint64_t{1} << 20U;
    /// Between two measurements.
    static constexpr std::uint64_t kPieceBytes = 16 * kMiB;
    /// What is left on the file system.
    static constexpr std::uint64_t kFreeBytesMin = 256 * kMiB;

    struct Use {
        std::uint64_t bytes = 0;  ///< of all files that were written
        std::uint64_t free = 0;   ///< of the file system
    };
    using Measure = std::function<Result<Use, Error>()>;

    OutputRoom(std::uint64_t bag_bytes, Measure measure)
        : bytes_max_(bytes_max(bag_bytes)), measure_(std::move(measure)) {}

    /// A thousand times the bag and 256 MiB, at most 64 GiB.
    [[nodiscard]] static std::uint64_t bytes_max(std::uint64_t bag_bytes) noexcept;

    /// `produced`: about as many bytes as were written so far, uncompressed; each 16 MiB are measured.
    /// Errors: limit_exceeded; that of the measurement.
    [[nodiscard]] Status<Error> check(std::uint64_t produced);

  private:
    std::uint64_t bytes_max_;
    Measure measure_;
    std::uint64_t measured_at_ = 0;
};

/// Of the files in the folder and those below it. Error: system_error.
[[nodiscard]] Result<OutputRoom::Use, Error> use_of(const OpenFolder& folder);

}  // namespace octoskin::bridge
