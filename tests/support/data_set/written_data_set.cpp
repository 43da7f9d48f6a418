#include "tests/support/data_set/written_data_set.hpp"

#include <png.h>

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace octoskin::testing_support {
namespace {

/// libpng's default handler aborts the test on any error.
void write_rows(png_structp png, png_infop info, const Grey& image, int bits) {
    png_set_IHDR(png, info, image.width, image.height, bits, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    for (unsigned y = 0; y < image.height; ++y) {
        std::vector<png_byte> row;
        for (unsigned x = 0; x < image.width; ++x) {
            const std::uint16_t value = image.values.at(std::size_t{y} * image.width + x);
            row.push_back(static_cast<png_byte>(value >> 8U));  // the upper byte first
            if (bits == 16) row.push_back(static_cast<png_byte>(value & 0xFFU));
        }
        png_write_row(png, row.data());
    }
    png_write_end(png, info);
}

}  // namespace

void write_grey_png(const std::filesystem::path& file, const Grey& image, int bits) {
    std::FILE* const stream = std::fopen(file.c_str(), "wb");
    if (stream == nullptr) std::abort();
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, stream);
    write_rows(png, info, image, bits);
    png_destroy_write_struct(&png, &info);
    std::fclose(stream);
}

WrittenDataSet::WrittenDataSet(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::filesystem::create_directories(folder_ / "depth");
    add_line("depth.txt", "# depth maps\n# file: 'rgbd_dataset_freiburg1_xyz.bag'\n# timestamp filename");
    add_line("groundtruth.txt",
             "# ground truth trajectory\n# file: 'rgbd_dataset_freiburg1_xyz.bag'\n"
             "# timestamp tx ty tz qx qy qz qw");
}

void WrittenDataSet::add_image(const std::string& time, const Grey& image) {
    write_grey_png(this->image(time), image);
    add_line("depth.txt", time + " depth/" + time + ".png");
}

void WrittenDataSet::add_pose(const std::string& time, const std::string& pose) {
    add_line("groundtruth.txt", time + " " + pose);
}

void WrittenDataSet::add_line(const std::string& list, const std::string& line) {
    std::ofstream(folder_ / list, std::ios::app | std::ios::binary) << line << '\n';
}

std::filesystem::path WrittenDataSet::image(const std::string& time) const {
    return folder_ / "depth" / (time + ".png");
}

}  // namespace octoskin::testing_support
