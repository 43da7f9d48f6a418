// A data set in exactly the layout of the TUM RGB-D benchmark, with the images and poses of a test.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace octoskin::testing_support {

/// Row-major.
struct Grey {
    unsigned width = 0;
    unsigned height = 0;
    std::vector<std::uint16_t> values;
};

/// As 16-bit grey PNG; `bits` 8: the upper halves, as an 8-bit one.
void write_grey_png(const std::filesystem::path& file, const Grey& image, int bits = 16);

class WrittenDataSet {
  public:
    /// Begins depth.txt and groundtruth.txt as the benchmark does, with three lines of comment.
    explicit WrittenDataSet(std::filesystem::path folder);

    /// `time`: as text, for instance "1305031102.160407". Values of 5000 a metre.
    void add_image(const std::string& time, const Grey& image);
    /// "tx ty tz qx qy qz qw".
    void add_pose(const std::string& time, const std::string& pose);
    void add_line(const std::string& list, const std::string& line);

    [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }
    [[nodiscard]] std::filesystem::path image(const std::string& time) const;

  private:
    std::filesystem::path folder_;
};

}  // namespace octoskin::testing_support
