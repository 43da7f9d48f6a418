// Depth images of data sets, one by one.
#include "host/io/tum/depth_png.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <ctime>
#include <random>
#include <string>

#include "tests/support/data_set/written_data_set.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::tum {
namespace {

using testing::StartsWith;
using testing_support::Grey;
using testing_support::ScratchFolder;

Grey noise(unsigned width, unsigned height, unsigned seed) {
    std::mt19937 random(seed);
    Grey image{width, height, {}};
    for (unsigned i = 0; i < width * height; ++i)
        image.values.push_back(static_cast<std::uint16_t>(random() & 0xFFFFU));
    return image;
}

class DepthPngTest : public testing::Test {
  protected:
    ScratchFolder scratch_;
};

TEST_F(DepthPngTest, every_value_comes_back_as_it_was_written) {
    Grey image{256, 256, {}};
    for (unsigned value = 0; value <= 0xFFFF; ++value)
        image.values.push_back(static_cast<std::uint16_t>(value));
    testing_support::write_grey_png(scratch_ / "all.png", image);
    const auto read = read_depth_png(scratch_ / "all.png");
    ASSERT_TRUE(read) << read.error();
    EXPECT_EQ(read->width, 256U);
    EXPECT_EQ(read->height, 256U);
    EXPECT_EQ(read->values, image.values);
}

TEST_F(DepthPngTest, cut_off_anywhere_it_is_refused) {
    testing_support::write_grey_png(scratch_ / "whole.png", noise(9, 7, 1));
    const std::string whole = ScratchFolder::read(scratch_ / "whole.png");
    ASSERT_TRUE(read_depth_png(scratch_ / "whole.png"));
    for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
        const auto read = read_depth_png(scratch_.write("cut.png", whole.substr(0, bytes)));
        ASSERT_FALSE(read) << bytes << " of " << whole.size() << " bytes";
        EXPECT_THAT(read.error(), StartsWith("cannot be read"));
    }
}

TEST_F(DepthPngTest, with_any_byte_changed_it_is_refused_or_gives_the_same_image) {
    const Grey image = noise(9, 7, 2);
    testing_support::write_grey_png(scratch_ / "whole.png", image);
    const std::string whole = ScratchFolder::read(scratch_ / "whole.png");
    for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
        const auto read = read_depth_png(scratch_.write("changed.png", bytes));
        EXPECT_TRUE(!read || read->values == image.values) << at;
    }
}

TEST_F(DepthPngTest, larger_than_4096_pixels_a_side_it_is_refused) {
    testing_support::write_grey_png(scratch_ / "wide.png", noise(4096, 1, 3));
    EXPECT_TRUE(read_depth_png(scratch_ / "wide.png"));
    testing_support::write_grey_png(scratch_ / "wide.png", noise(4097, 1, 3));
    EXPECT_FALSE(read_depth_png(scratch_ / "wide.png"));
}

std::string big_endian(std::uint32_t value) {
    std::string bytes;
    for (const unsigned shift : {24U, 16U, 8U, 0U}) bytes += static_cast<char>((value >> shift) & 0xFFU);
    return bytes;
}

std::string packed(const std::string& bytes) {
    uLongf size = ::compressBound(bytes.size());
    std::string packed(size, 0);
    EXPECT_EQ(::compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                         reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()),
              Z_OK);
    packed.resize(size);
    return packed;
}

/// `chunk`: its name and content.
std::string with_length_and_checksum(const std::string& chunk) {
    const auto crc =
        ::crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), static_cast<uInt>(chunk.size()));
    return big_endian(static_cast<std::uint32_t>(chunk.size() - 4)) + chunk +
           big_endian(static_cast<std::uint32_t>(crc));
}

/// A chunk of text that is 7 MB of blanks, in 7 KB.
std::string packed_text() {
    return with_length_and_checksum(std::string("zTXtComment\0\0", 13) + packed(std::string(7'000'000, ' ')));
}

double processor_s() {
    timespec used{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

// A thousand of them, which libpng takes by default, took a minute.
TEST_F(DepthPngTest, what_stands_beside_the_pixels_is_not_unpacked) {
    const Grey image = noise(9, 7, 4);
    testing_support::write_grey_png(scratch_ / "plain.png", image);
    const std::string plain = ScratchFolder::read(scratch_ / "plain.png");
    constexpr std::size_t kBehindHeader = 8 + 25;
    const double begun_s = processor_s();
    const std::string text = packed_text();
    const double packing_s = processor_s() - begun_s;
    std::string texts;
    for (int i = 0; i < 300; ++i) texts += text;
    for (const std::size_t at : {kBehindHeader, plain.size() - 12}) {  // before the pixels, and behind them
        const auto file = scratch_.write("texts.png", plain.substr(0, at) + texts + plain.substr(at));
        const double before_s = processor_s();
        const auto read = read_depth_png(file);
        const double took_s = processor_s() - before_s;
        ASSERT_TRUE(read) << read.error();
        EXPECT_EQ(read->values, image.values);
        EXPECT_LE(took_s, 5.0 * packing_s) << "so much as five of the 300 took to be packed";
    }
}

/// An image of one zero, with so many more of them packed behind it.
std::string with_zeros_behind(const std::string& one_pixel, std::size_t count) {
    constexpr std::size_t kBehindHeader = 8 + 25;
    return one_pixel.substr(0, kBehindHeader) +
           with_length_and_checksum("IDAT" + packed(std::string(3 + count, 0))) +
           one_pixel.substr(one_pixel.size() - 12);
}

// A gigabyte of them took 12 s.
TEST_F(DepthPngTest, more_pixels_than_it_says_are_skipped_if_few_and_refused_if_many) {
    testing_support::write_grey_png(scratch_ / "one.png", {1, 1, {0}});
    const std::string one_pixel = ScratchFolder::read(scratch_ / "one.png");
    EXPECT_TRUE(read_depth_png(scratch_.write("few.png", with_zeros_behind(one_pixel, 1'000'000))));
    const auto many = read_depth_png(scratch_.write("many.png", with_zeros_behind(one_pixel, 100'000'000)));
    ASSERT_FALSE(many);
    EXPECT_THAT(many.error(), StartsWith("cannot be read completely"));
}

}  // namespace
}  // namespace octoskin::tum
