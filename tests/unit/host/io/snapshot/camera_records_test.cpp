// The memory of the depth camera in a snapshot: the same bit by bit, or an error.
#include "host/io/snapshot/camera_records.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <limits>
#include <string>
#include <vector>

#include "host/io/snapshot/snapshot.hpp"
#include "tests/support/snapshot/camera_memories.hpp"
#include "tests/support/snapshot/map_states.hpp"
#include "tests/support/snapshot/mended.hpp"

namespace octoskin {
namespace {

using namespace testing_support;

constexpr std::uint32_t kMapping = 0x12345678;

std::string encode(const std::vector<CameraMemory>& cameras) {
    return encode_snapshot({FusedMap(quickly_aging().map), {}, cameras}, {.mapping_crc32 = kMapping});
}

std::string encode(const CameraMemory& camera) {
    return encode(std::vector{camera});
}

Result<Snapshot, Error> decode(std::string_view bytes) {
    MappingConfig mapping = quickly_aging();
    mapping.map.memory_max_mib = 16;  // a Kinect's memory takes 5
    return decode_snapshot(bytes, mapping, kMapping);
}

std::array<std::uint32_t, 6> bits_of(const CameraMemory::Pixel& pixel) {
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
    return {bits(pixel.depth.mean_m), bits(pixel.depth.count), bits(pixel.depth.drift),
            pixel.end.key_xy,         pixel.end.key_z,         bits(pixel.end.depth_m)};
}

void expect_equal(const CameraMemory& a, const CameraMemory& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.T_map_camera.matrix(), b.T_map_camera.matrix());
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        ASSERT_EQ(bits_of(a.pixels[i]), bits_of(b.pixels[i])) << "pixel " << i;
}

TEST(CameraRecords, give_every_pixel_again_bit_by_bit) {
    struct Case {
        std::uint32_t width;
        std::uint32_t height;
        float share;
    };
    for (const auto& [width, height, share] :
         {Case{1, 1, 1.0F}, Case{1, 1, 0.0F}, Case{5, 4, 0.5F}, Case{16, 12, 0.97F}, Case{300, 200, 0.03F},
          Case{4096, 3, 0.9F}, Case{3, 4096, 0.9F}, Case{512, 424, 0.8F}}) {
        const CameraMemory camera = random_camera(width + height, width, height, share);
        const std::string bytes = encode(camera);
        const auto again = decode(bytes);
        ASSERT_TRUE(again) << again.error().message();
        ASSERT_EQ(again->state.cameras.size(), 1U);
        expect_equal(again->state.cameras.front(), camera);
        EXPECT_TRUE(encode(again->state.cameras) == bytes);
    }
}

TEST(CameraRecords, give_each_of_several_cameras_again_in_their_order) {
    std::vector<CameraMemory> cameras;
    for (const char* name : {"right", "left", "a-name.of_exactly-32-characters_"}) {
        cameras.push_back(random_camera(static_cast<unsigned>(cameras.size()) + 1, 7, 5));
        cameras.back().name = name;
    }
    const std::string bytes = encode(cameras);
    const auto again = decode(bytes);
    ASSERT_TRUE(again) << again.error().message();
    ASSERT_EQ(again->state.cameras.size(), cameras.size());
    for (std::size_t i = 0; i < cameras.size(); ++i) expect_equal(again->state.cameras[i], cameras[i]);
    EXPECT_TRUE(encode(again->state.cameras) == bytes);
}

TEST(CameraRecords, are_absent_without_a_memory) {
    const std::string bytes = encode(std::vector<CameraMemory>{});
    EXPECT_EQ(bytes.find("CAMR"), std::string::npos);
    const auto again = decode(bytes);
    ASSERT_TRUE(again);
    EXPECT_TRUE(again->state.cameras.empty());
}

TEST(CameraRecords, of_a_kinect_take_less_than_5_MB_at_most_and_nothing_for_empty_rows) {
    CameraMemory camera = random_camera(1, 512, 424, 1.0F);
    for (CameraMemory::Pixel& pixel : camera.pixels) {
        pixel.depth.count = 100.0F;
        pixel.end = seen_pixel().end;
    }
    EXPECT_LT(encode(camera).size(), 5'000'000U);
    for (CameraMemory::Pixel& pixel : camera.pixels) pixel = {};
    EXPECT_LT(encode(camera).size(), 424U * 2 + 500U);
}

/// The format as map-files.md has it, put together by hand.
class Payload {
  public:
    template <class Value>
    Payload& put(Value value) {
        snapshot::ByteWriter(bytes_).put(value);
        return *this;
    }
    Payload& byte(int value) { return put(static_cast<std::uint8_t>(value)); }
    Payload& named(const std::string& name) {
        byte(static_cast<int>(name.size()));
        for (const char c : name) put(c);
        return *this;
    }
    Payload& head(std::uint32_t width, std::uint32_t height, double scale = 1.0, double x_m = 0.5) {
        return named("").size(width, height, scale, x_m);
    }
    Payload& size(std::uint32_t width, std::uint32_t height, double scale = 1.0, double x_m = 0.5) {
        put(width).put(height);
        for (int i = 0; i < 9; ++i) put(i % 4 == 0 ? scale : 0.0);
        return put(x_m).put(0.0).put(-2.0);
    }
    Payload& value(float mean_m, float drift, int code) { return put(mean_m).put(drift).byte(code); }
    Payload& end(float depth_m) {
        return put(std::uint16_t{1}).put(std::uint16_t{0xFFFF}).put(std::uint16_t{3}).put(depth_m);
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
};

/// A snapshot of an empty map with these blocks of a camera.
std::string with_blocks(const std::vector<Payload>& payloads) {
    std::string blocks;
    for (const Payload& payload : payloads) {
        blocks += "CAMR....";
        snapshot::ByteWriter(blocks).put(static_cast<std::uint32_t>(payload.bytes().size()));
        blocks += payload.bytes() + "....";
    }
    std::string bytes = encode(std::vector<CameraMemory>{});
    return mended(bytes.insert(bytes.rfind("DONE"), blocks));
}

TEST(CameraRecords, are_of_the_format_described) {
    const Payload rows =
        Payload().byte(1).byte(2).value(1.25F, -0.5F, 4 * 31 + 2).value(64.0F, 1.5F, 5).end(9.0F);
    Payload whole = Payload().head(3, 2).byte(3);
    for (const char c : rows.bytes()) whole.put(c);
    CameraMemory camera{.width = 3, .height = 2, .T_map_camera = Eigen::Isometry3d::Identity(), .pixels = {}};
    camera.T_map_camera.translation() = Eigen::Vector3d(0.5, 0.0, -2.0);
    camera.pixels.resize(6);
    camera.pixels[4].depth = {.mean_m = 1.25F, .count = -31.0F, .drift = -0.5F};
    camera.pixels[5] = {.depth = {.mean_m = 64.0F, .count = 1.0F, .drift = 1.5F},
                        .end = {.key_xy = 0xFFFF'0001U, .key_z = 3, .depth_m = 9.0F}};
    const std::string bytes = with_blocks({whole});
    EXPECT_EQ(encode(camera), bytes);
    for (const auto& blocks :
         {std::vector{whole}, std::vector{Payload().head(3, 2), Payload().byte(3), rows}}) {
        const auto read = decode(with_blocks(blocks));
        ASSERT_TRUE(read) << read.error().message();
        expect_equal(read->state.cameras.at(0), camera);
    }
}

std::optional<ErrorCode> fault_of(const std::vector<Payload>& blocks,
                                  const MappingConfig& mapping = quickly_aging()) {
    const auto read = decode_snapshot(with_blocks(blocks), mapping, kMapping);
    return read ? std::nullopt : std::optional(read.error().code);
}

std::optional<ErrorCode> fault_of_pixel(float mean_m, float drift, int code, std::optional<float> end_m) {
    Payload payload = Payload().head(1, 1).byte(0).byte(1).value(mean_m, drift, code);
    if (end_m) payload.end(*end_m);
    return fault_of({payload});
}

TEST(CameraRecords, of_more_memory_than_the_map_may_take_are_refused) {
    MappingConfig mapping = quickly_aging();
    mapping.map.memory_max_mib = 12;  // 1024 x 512 pixels of 24 bytes
    const auto fault_of_size = [&](std::uint32_t width, std::uint32_t height) {
        std::vector<Payload> blocks = {Payload().head(width, height)};
        for (std::uint32_t row = 0; row < height; ++row) blocks.push_back(Payload().byte(0x80).byte(0x08));
        return fault_of(blocks, mapping);
    };
    EXPECT_FALSE(fault_of_size(1024, 512));
    EXPECT_EQ(fault_of_size(1024, 513), ErrorCode::too_large);
}

TEST(CameraRecords, of_one_name_twice_or_of_more_cameras_than_a_rig_has_are_refused) {
    const auto camera = [](const std::string& name) { return Payload().named(name).size(1, 1).byte(1); };
    EXPECT_FALSE(fault_of({camera("left"), camera("right")}));
    EXPECT_EQ(fault_of({camera("left"), camera("left")}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().head(1, 1).byte(1), Payload().head(1, 1).byte(1)}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({camera(std::string(33, 'x'))}), ErrorCode::damaged);
    EXPECT_FALSE(fault_of({camera(std::string(32, 'x'))}));
    std::vector<Payload> blocks;
    for (const char* name : {"1", "2", "3", "4", "5", "6", "7", "8"}) blocks.push_back(camera(name));
    EXPECT_FALSE(fault_of(blocks));
    blocks.push_back(camera("9"));
    EXPECT_EQ(fault_of(blocks), ErrorCode::damaged);
}

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

TEST(CameraRecords, with_a_pixel_that_no_camera_has_are_refused) {
    EXPECT_FALSE(fault_of_pixel(1.0F, 1.6F, 4, {}));
    EXPECT_FALSE(fault_of_pixel(100.0F, -1.6F, 4 * 30 + 3, 9.0F));
    for (const float mean_m : {0.0F, -1.0F, 100.1F, kNaN, kInfinite})
        EXPECT_EQ(fault_of_pixel(mean_m, 0.0F, 4, {}), ErrorCode::damaged) << mean_m;
    for (const float drift : {1.7F, -1.7F, kNaN, kInfinite})
        EXPECT_EQ(fault_of_pixel(1.0F, drift, 4, {}), ErrorCode::damaged) << drift;
    for (const float depth_m : {0.0F, -1.0F, kNaN, kInfinite})
        EXPECT_EQ(fault_of_pixel(1.0F, 0.0F, 5, depth_m), ErrorCode::damaged) << depth_m;
    for (const int code : {0, 2}) EXPECT_EQ(fault_of_pixel(1.0F, 0.0F, code, {}), ErrorCode::damaged) << code;
    const auto fault_of_count = [](std::uint64_t count, std::uint32_t count_max) {
        MappingConfig mapping = quickly_aging();
        mapping.depth_denoiser.count_max = count_max;
        std::string code;
        snapshot::ByteWriter(code).put_count(4 * count);
        Payload payload = Payload().head(1, 1).byte(0).byte(1).put(1.0F).put(0.0F);
        for (const char c : code) payload.put(c);
        return fault_of({payload}, mapping);
    };
    EXPECT_FALSE(fault_of_count(100, 100));
    EXPECT_FALSE(fault_of_count(10'000, 10'000));
    EXPECT_EQ(fault_of_count(101, 100), ErrorCode::damaged);
    EXPECT_EQ(fault_of_count(std::uint64_t{1} << 60U, 10'000), ErrorCode::damaged);
}

TEST(CameraRecords, of_another_number_of_pixels_are_refused) {
    const Payload row = Payload().byte(4);
    EXPECT_FALSE(fault_of({Payload().head(4, 2), row, row}));
    EXPECT_EQ(fault_of({Payload().head(4, 2)}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().head(4, 2), row}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().head(4, 2), row, row, row}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().head(4, 1), Payload().byte(5)}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().head(4, 1), Payload().byte(3)}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().head(4, 1), Payload().byte(3).byte(0).byte(1)}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().head(1, 1), Payload().byte(0).byte(2).value(1, 0, 4).value(1, 0, 4)}),
              ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().byte(1)}), ErrorCode::damaged) << "no head";
    EXPECT_FALSE(fault_of({Payload().head(4096, 1), Payload().byte(0x80).byte(0x20)}));
    EXPECT_EQ(fault_of({Payload().head(4097, 1), Payload().byte(0x81).byte(0x20)}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().head(1, 4097)}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().head(0, 1)}), ErrorCode::damaged);
    EXPECT_EQ(fault_of({Payload().head(1, 0)}), ErrorCode::damaged);
}

TEST(CameraRecords, of_no_pose_or_of_a_mapping_without_a_memory_are_refused) {
    const Payload pixel = Payload().byte(1);
    EXPECT_FALSE(fault_of({Payload().head(1, 1), pixel}));
    for (const double scale : {1.001, 0.0, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_EQ(fault_of({Payload().head(1, 1, scale), pixel}), ErrorCode::damaged) << scale;
    for (const double x_m : {static_cast<double>(kNaN), static_cast<double>(kInfinite)})
        EXPECT_EQ(fault_of({Payload().head(1, 1, 1.0, x_m), pixel}), ErrorCode::damaged) << x_m;
    for (const DepthUpdate update : {DepthUpdate::paper, DepthUpdate::robust, DepthUpdate::fast}) {
        MappingConfig mapping = quickly_aging();
        mapping.depth_update = update;
        EXPECT_EQ(fault_of({Payload().head(1, 1), pixel}, mapping), ErrorCode::damaged);
        EXPECT_FALSE(fault_of({}, mapping));
    }
}

TEST(CameraRecords, are_refused_with_any_byte_changed_and_at_any_length) {
    const std::string bytes = encode(random_camera(3, 7, 5));
    ASSERT_TRUE(decode(bytes));
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::string changed = bytes;
        for (const unsigned bit : {1U, 0x10U, 0x80U, 0xFFU}) {
            changed[at] = static_cast<char>(static_cast<std::uint8_t>(bytes[at]) ^ bit);
            ASSERT_FALSE(decode(changed)) << at;
        }
        ASSERT_FALSE(decode(std::string_view(bytes).substr(0, at))) << at;
    }
}

TEST(CameraRecords, with_bytes_changed_and_right_checksums_are_a_possible_memory_or_refused) {
    const std::string bytes = encode(random_camera(4, 7, 5));
    int accepted = 0;
    std::mt19937 random(5);
    for (int round = 0; round < 20'000; ++round) {
        std::string changed = bytes;
        changed[snapshot::kMagic.size() + random() % (bytes.size() - snapshot::kMagic.size())] =
            static_cast<char>(random());
        const auto read = decode(mended(changed));
        if (!read) continue;
        ++accepted;
        const std::string written = encode_snapshot(read->state, read->origin);
        const auto again = decode(written);
        ASSERT_TRUE(again) << again.error().message();
        ASSERT_EQ(encode_snapshot(again->state, again->origin), written);
    }
    EXPECT_GT(accepted, 1000);
    EXPECT_LT(accepted, 19'000);
}

}  // namespace
}  // namespace octoskin
