// Frames of `watch`: what is written is read back, and other bytes are refused.
#include "host/io/watch/watch_frame.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/support/cases.hpp"

namespace octoskin::watch {
namespace {

std::string bytes_of(const FrameHeader& header) {
    std::string bytes;
    put_header(bytes, header);
    return bytes;
}

TEST(WatchFrame, has_a_header_of_32_bytes_that_reads_back) {
    const FrameHeader header{.bytes = 4711,
                             .kind = FrameKind::map,
                             .flags = kBegins | kComplete,
                             .number = 1ULL << 40U,
                             .time = {-3},
                             .lost = 9};
    const std::string bytes = bytes_of(header);
    EXPECT_EQ(bytes.size(), kHeaderBytes);
    EXPECT_EQ(parse_header(bytes), header);
    EXPECT_EQ(parse_header(bytes + "more"), header);
    for (std::size_t cut = 0; cut < bytes.size(); ++cut) EXPECT_FALSE(parse_header(bytes.substr(0, cut)));
}

TEST(WatchFrame, refuses_another_version_kind_or_flag_and_a_payload_that_is_too_long) {
    EXPECT_FALSE(parse_header(bytes_of({.kind = static_cast<FrameKind>(0)})));
    EXPECT_FALSE(parse_header(bytes_of({.kind = static_cast<FrameKind>(8)})));
    EXPECT_FALSE(parse_header(bytes_of({.kind = FrameKind::map, .flags = 4})));
    EXPECT_FALSE(parse_header(bytes_of({.kind = FrameKind::range, .flags = kBegins})));
    EXPECT_FALSE(parse_header(bytes_of({.kind = FrameKind::reload, .flags = kBegins})));
    EXPECT_FALSE(parse_header(bytes_of({.bytes = kPayloadMax + 1})));
    std::string other = bytes_of({});
    other[4] = 2;
    EXPECT_FALSE(parse_header(other));
}

TEST(WatchFrame, has_the_number_of_a_reload_that_reads_back_and_refuses_every_cut) {
    const std::string reload = reload_payload(0x0102030405060708U);
    EXPECT_EQ(reload, "\x08\x07\x06\x05\x04\x03\x02\x01");
    EXPECT_EQ(parse_reload(reload), 0x0102030405060708U);
    for (std::size_t cut = 0; cut < reload.size(); ++cut) EXPECT_FALSE(parse_reload(reload.substr(0, cut)));
    EXPECT_FALSE(parse_reload(reload + 'x'));
}

TEST(WatchFrame, has_ranges_and_joints_that_read_back_and_refuses_every_cut) {
    Beam beam;
    beam.source = {3, 5, 2};
    beam.range_m = 1.25;
    beam.sigma_m = 0.01;
    beam.p_map_sensor = {1, 2, 3};
    beam.direction_map = {0, -1, 0};
    const std::string range = range_payload(beam);
    const auto read = parse_range(range);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->source, beam.source);
    EXPECT_EQ(read->range_m, 1.25);
    EXPECT_EQ(read->sigma_m, 0.01);
    EXPECT_EQ(read->p_map_sensor, beam.p_map_sensor);
    EXPECT_EQ(read->direction_map, beam.direction_map);
    beam.range_m.reset();
    EXPECT_EQ(parse_range(range_payload(beam))->range_m, std::nullopt);
    JointMeasurement joints{.sampled = {1}, .source = 1};
    joints.position_rad = {0.5, -0.25, 7.0};
    const std::string sample = joints_payload(joints, 2);
    ASSERT_TRUE(parse_joints(sample));
    EXPECT_EQ(parse_joints(sample)->source, 1);
    EXPECT_EQ(parse_joints(sample)->position, (std::vector<double>{0.5, -0.25}));
    for (std::size_t cut = 0; cut < range.size(); ++cut) EXPECT_FALSE(parse_range(range.substr(0, cut)));
    for (std::size_t cut = 0; cut < sample.size(); ++cut) EXPECT_FALSE(parse_joints(sample.substr(0, cut)));
    EXPECT_FALSE(parse_range(range + 'x'));
    EXPECT_FALSE(parse_joints(sample + 'x'));
    beam.p_map_sensor.x() = std::nan("");
    EXPECT_FALSE(parse_range(range_payload(beam)));
}

TEST(WatchFrame, has_images_reduced_to_whole_pixels_that_read_back_and_refuses_every_cut) {
    for (const auto& [width, height, step] : {std::array{640U, 480U, 4U}, std::array{160U, 120U, 1U},
                                              std::array{161U, 4U, 2U}, std::array{3U, 250U, 3U}}) {
        DepthFrame frame;
        frame.width = width;
        frame.height = height;
        frame.camera = 2;
        for (std::uint32_t i = 0; i < width * height; ++i)
            frame.depth_mm.push_back(static_cast<std::uint16_t>(i));
        const std::string bytes = image_payload(frame);
        const auto image = parse_image(bytes);
        ASSERT_TRUE(image);
        EXPECT_EQ(image->camera, 2);
        EXPECT_EQ(image->width, width / step);
        EXPECT_EQ(image->height, height / step);
        for (std::uint32_t v = 0; v < image->height; ++v)
            for (std::uint32_t u = 0; u < image->width; ++u)
                ASSERT_EQ(image->depth_mm[v * image->width + u], frame.depth_mm[v * step * width + u * step]);
        EXPECT_FALSE(parse_image(bytes + "x"));
        for (std::size_t cut = 0; cut < bytes.size(); cut += 97)
            EXPECT_FALSE(parse_image(bytes.substr(0, cut)));
    }
    EXPECT_FALSE(parse_image(std::string("\0\xff\xff\xff\xff", 5)));
}

}  // namespace
}  // namespace octoskin::watch
