// The canonical text, the two hashes, and what changes them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <string>

#include "common/config/node_config.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/support/errors/error_fields.hpp"

namespace octoskin::rig {
namespace {

const std::filesystem::path kSource = OCTOSKIN_SOURCE_DIR;

/// A rig that says everything a rig can say.
const std::string kFullRig = R"(name: full
robot:
  urdf: two-links.urdf
  base_link: base
  link_padding_m: {arm: 0.015625}
  fits_capsules: true
  attached_capsules:
    - {name: gripper, link: arm, from_m: [0, 0, 0.125], to_m: [0, 0.0625, 0.25], radius_m: 0.03, padding_m: 0.02}
    - {name: ball, link: arm, from_m: [0.5, 0, 0], radius_m: 0.04}
  links_without_body: [base]
  links_ignored_by_sensors: [arm]
  depth_self_margin_m: 0.0875
  range_self_margin_m: 0.125
T_map_base: {xyz_m: [0.002990, 0.020829, -0.001814], rpy_deg: [10, 20, 30]}
bus:
  protocol: can
  nominal_bitrate_bps: 500000
range_limits: {min_m: 0.05, max_m: 3.9, sigma_max_m: 0.15, time_uncertainty_max_ms: 2.5}
joints: {node_id: 9, rate_hz: 100.5, names: [elbow]}
camera:
  width_px: 64
  height_px: 48
  fx_px: 60.25
  fy_px: 60.5
  cx_px: 32.5
  cy_px: 24.5
  distortion: {k1: 0.125, k2: -0.25, p1: 0.001, p2: -0.002, k3: 0.0625}
  rate_hz: 15
  depth_min_m: 0.3
  depth_max_m: 4.25
  data_set: {depth_units_per_m: 1000, depth_no_value: 65535, pose_gap_max_ms: 150}
  link: arm
  pose: {xyz_m: [2.7, 0, 1.8], looking_at_m: [0.4, 0, 0.45]}
nodes:
  - name: board
    node_id: 1
    board: {name: odd, board_type: 7, i2c_bus_count: 2, xshut_line_count: 40, sensors_max: 34,
            sensors_per_bus_max: 5, supports_can_fd: true, has_data_ready_lines: true}
    i2c_hz: 390000
    io_level: 2v8
    reads_twice: true
    stream_gate: advanced
    aux_every: 4
    zone_guard_us: 900
    holds_phases: false
    pinned_build_id: 0x1a2b3c4d
    sensors:
      - name: front
        link: arm
        bus: 1
        xshut_line: 3
        address: 0x30
        pose: {xyz_m: [0.05, 0.01, 0.02], rpy_deg: [0, 89, 1]}
        distance_mode: long
        timing_budget_ms: 33
        inter_measurement_ms: 50
        phase_us: 700
        device_offset_mm: -3.25
        crosstalk_kcps: 1.5
        sigma_limit_mm: 45.25
        signal_limit_mcps: 0.75
        applies_gain_factor: false
        zones:
          - {centre_spad: 199, width_spads: 8, height_spads: 8, offset_m: 0.003}
          - {centre_spad: 151, width_spads: 4, height_spads: 6, offset_m: -0.002}
        cone: {sub_rays: 8, half_angle_deg: 13.25, sigma_deg: 6.1, blur_deg: 2.3}
)";

/// Writes a rig beside its URDF's copy and reads it.
class RigText : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(testing::TempDir()) /
                  (std::string("octoskin-") + testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
        std::filesystem::copy_file(kSource / "tests/data/rigs/two-links.urdf", folder_ / "two-links.urdf",
                                   std::filesystem::copy_options::overwrite_existing);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    Result<Rig, Error> read(const std::string& text) {
        std::ofstream(folder_ / "rig.yaml") << text;
        return read_rig(folder_ / "rig.yaml");
    }
    Rig read_good(const std::string& text) {
        auto rig = read(text);
        EXPECT_TRUE(rig) << rig.error().message();
        return std::move(rig).value();
    }

    std::filesystem::path folder_;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// The range before is read and the zone written in 3 ms, the guard is 0.9 ms, and the next range may begin
// 5 ms before its window of 33.
TEST_F(RigText, zones_need_a_pause_between_ranges_and_a_sensor_with_one_zone_does_not) {
    const auto with_period = [](const std::string& text, int period_ms) {
        return replaced(text, "inter_measurement_ms: 50",
                        "inter_measurement_ms: " + std::to_string(period_ms));
    };
    const std::string one_zone = replaced(
        kFullRig, "          - {centre_spad: 151, width_spads: 4, height_spads: 6, offset_m: -0.002}\n", "");
    EXPECT_EQ(read_good(with_period(kFullRig, 42)).nodes.at(0).config.sensors[0].inter_measurement_ms, 42);
    EXPECT_FALSE(read(with_period(kFullRig, 41)));
    EXPECT_FALSE(read(replaced(with_period(kFullRig, 42), "zone_guard_us: 900", "zone_guard_us: 1900")));
    EXPECT_EQ(read_good(with_period(one_zone, 41)).nodes.at(0).config.sensors[0].inter_measurement_ms, 41);
}

TEST_F(RigText, every_value_of_a_full_rig_arrives) {
    const Rig rig = read_good(kFullRig);
    EXPECT_EQ(rig.name, "full");
    EXPECT_EQ(rig.urdf, std::filesystem::absolute(folder_ / "two-links.urdf"));
    EXPECT_EQ(rig.link_padding_m.at("arm"), 0.015625);
    EXPECT_TRUE(rig.fits_capsules);
    ASSERT_EQ(rig.attached_capsules.size(), 2U);
    EXPECT_EQ(rig.attached_capsules[0].name, "gripper");
    EXPECT_EQ(rig.attached_capsules[0].link, "arm");
    EXPECT_EQ(rig.attached_capsules[0].p_link_a, Eigen::Vector3d(0, 0, 0.125));
    EXPECT_EQ(rig.attached_capsules[0].p_link_b, Eigen::Vector3d(0, 0.0625, 0.25));
    EXPECT_EQ(rig.attached_capsules[0].radius_m, 0.03);
    EXPECT_EQ(rig.attached_capsules[0].padding_m, 0.02);
    EXPECT_EQ(rig.attached_capsules[1].p_link_b, Eigen::Vector3d(0.5, 0, 0));
    EXPECT_EQ(rig.links_without_body, std::vector<std::string>{"base"});
    EXPECT_EQ(rig.range_limits.sigma_max_m, 0.15);
    EXPECT_EQ(rig.range_limits.time_uncertainty_max_ms, 2.5);
    EXPECT_EQ(rig.cameras.front().fy, 60.5);
    EXPECT_EQ(rig.cameras.front().lens,
              (LensDistortion{.k1 = 0.125, .k2 = -0.25, .p1 = 0.001, .p2 = -0.002, .k3 = 0.0625}));
    EXPECT_EQ(rig.cameras.front().link, "arm");
    EXPECT_EQ(rig.cameras.front().data_set,
              (DataSetKeys{.units_per_m = 1000.0, .no_value = 65'535, .pose_gap_max_ms = 150.0}));
    EXPECT_EQ(rig.joint_sources.at(0).rate_hz, 100.5);
    const Node& node = rig.nodes.at(0);
    EXPECT_EQ(node.pinned_build_id, 0x1A2B3C4DU);
    EXPECT_EQ(node.board.board_type, 7);
    EXPECT_EQ(node.config.board_type, 7);
    EXPECT_EQ(node.config.i2c_hz, 390'000U);
    EXPECT_EQ(node.config.aux_every, 4);
    EXPECT_EQ(node.config.zone_guard_us, 900);
    EXPECT_TRUE(node.board.has_data_ready_lines);
    EXPECT_EQ(node.config.data_ready_buses, 0);
    EXPECT_FALSE(node.config.uses_can_fd);
    EXPECT_EQ(node.config.nominal_bitrate, 500'000U);
    const SensorConfig& sensor = node.config.sensors[0];
    EXPECT_EQ(sensor.bus, 1);
    EXPECT_EQ(sensor.xshut_line, 3);
    EXPECT_EQ(sensor.address, 0x30);
    EXPECT_EQ(sensor.phase_us, 700);
    EXPECT_TRUE(sensor.has_offset);
    EXPECT_EQ(sensor.offset_quarter_mm, -13);
    EXPECT_EQ(sensor.crosstalk_raw, 768);
    EXPECT_EQ(sensor.sigma_limit_quarter_mm, 181);
    EXPECT_EQ(sensor.signal_limit_raw, 96);
    EXPECT_EQ(sensor.zone_count, 2);
    EXPECT_EQ(sensor.zones[1].centre_spad, 151);
    EXPECT_EQ(sensor.zones[1].width, 4);
    EXPECT_EQ(sensor.zones[1].height, 6);
    EXPECT_EQ(node.sensors[0].zone_offset_m, (std::vector<double>{0.003, -0.002}));
}

TEST_F(RigText, canonical_text_reads_back_to_the_same_text_and_the_same_numbers) {
    const Rig rig = read_good(kFullRig);
    const std::string text = canonical_text(rig, "two-links.urdf");
    const Rig again = read_good(text);
    EXPECT_EQ(canonical_text(again, "two-links.urdf"), text);
    EXPECT_TRUE(again.T_map_base.matrix() == rig.T_map_base.matrix());
    EXPECT_TRUE(again.cameras.front().T_link_camera.matrix() == rig.cameras.front().T_link_camera.matrix());
    EXPECT_EQ(again.cameras.front().lens, rig.cameras.front().lens);
    EXPECT_EQ(again.cameras.front().data_set, rig.cameras.front().data_set);
    EXPECT_TRUE(again.nodes[0].sensors[0].T_link_sensor.matrix() ==
                rig.nodes[0].sensors[0].T_link_sensor.matrix());
    EXPECT_EQ(again.nodes[0].config, rig.nodes[0].config);
    EXPECT_EQ(rig_hash(again), rig_hash(rig));
}

TEST_F(RigText, canonical_text_keeps_any_pose_to_the_last_bit) {
    std::mt19937 engine(11);
    std::normal_distribution<> normal;
    Rig rig = read_good(kFullRig);
    for (int draw = 0; draw < 40; ++draw) {
        Eigen::Quaterniond q(normal(engine), normal(engine), normal(engine), normal(engine));
        rig.T_map_base.linear() = q.normalized().toRotationMatrix();
        rig.T_map_base.translation() = Eigen::Vector3d(normal(engine), normal(engine), normal(engine)) * 1e-3;
        const Rig again = read_good(canonical_text(rig, "two-links.urdf"));
        ASSERT_TRUE(again.T_map_base.matrix() == rig.T_map_base.matrix()) << "draw " << draw;
    }
}

TEST_F(RigText, shipped_rigs_survive_the_round_trip) {
    for (const auto& entry : std::filesystem::directory_iterator(kSource / "hw/rigs")) {
        if (entry.path().extension() != ".yaml") continue;
        const auto rig = read_rig(entry.path());
        ASSERT_TRUE(rig) << rig.error().message();
        const std::string text = canonical_text(*rig, rig->urdf.shown().string());
        EXPECT_EQ(canonical_text(read_good(text), rig->urdf.shown().string()), text) << entry.path();
    }
}

TEST_F(RigText, negative_zero_is_zero) {
    const Rig rig = read_good(kFullRig);
    Rig negative = rig;
    Rig positive = rig;
    negative.T_map_base.translation().x() = -0.0;
    positive.T_map_base.translation().x() = 0.0;
    EXPECT_EQ(canonical_text(negative, "r"), canonical_text(positive, "r"));
}

TEST_F(RigText, place_of_the_urdf_is_written_as_given_and_is_not_in_the_hash) {
    Rig rig = read_good(kFullRig);
    EXPECT_NE(canonical_text(rig, "a \"robot\".urdf").find(R"(urdf: "a \"robot\".urdf")"), std::string::npos);
    const auto hash = rig_hash(rig);
    rig.urdf = "/elsewhere/robot.urdf";
    EXPECT_EQ(rig_hash(rig), hash);
}

struct Change {
    const char* from;
    const char* to;
    bool changes_node;
};
const Change kChanges[] = {
    // What the node's firmware uses.
    {"\n    node_id: 1", "\n    node_id: 2", true},
    {"board_type: 7", "board_type: 6", true},
    {"nominal_bitrate_bps: 500000", "nominal_bitrate_bps: 1000000", true},
    {"protocol: can", "protocol: can_fd\n  data_bitrate_bps: 5000000", true},
    {"i2c_hz: 390000", "i2c_hz: 400000", true},
    {"io_level: 2v8", "io_level: 1v8", true},
    {"reads_twice: true", "reads_twice: false", true},
    {"stream_gate: advanced", "stream_gate: differs", true},
    {"stream_gate: advanced", "stream_gate: off", true},
    {"aux_every: 4", "aux_every: 0", true},
    {"zone_guard_us: 900", "zone_guard_us: 901", true},
    {"holds_phases: false", "holds_phases: true", true},
    {"holds_phases: false", "holds_phases: false\n    ready_jitter_us: 31", true},
    {"holds_phases: false", "holds_phases: false\n    verification: {enabled: false}", true},
    {"holds_phases: false", "holds_phases: false\n    verification: {leave_out: [0x47]}", true},
    {"holds_phases: false", "holds_phases: false\n    refuses_commands: true", true},
    {"zone_guard_us: 900", "zone_guard_us: 900\n    data_ready_buses: [1]", true},
    {"bus: 1", "bus: 0", true},
    {"xshut_line: 3", "xshut_line: 2", true},
    {"address: 0x30", "address: 0x31", true},
    {"distance_mode: long", "distance_mode: short", true},
    {"distance_mode: long", "distance_mode: medium", true},
    {"timing_budget_ms: 33", "timing_budget_ms: 20", true},
    {"inter_measurement_ms: 50", "inter_measurement_ms: 51", true},
    {"phase_us: 700", "phase_us: 701", true},
    {"device_offset_mm: -3.25", "device_offset_mm: -3", true},
    {"device_offset_mm: -3.25", "device_offset_mm: ~", true},
    {"crosstalk_kcps: 1.5", "crosstalk_kcps: 1.25", true},
    {"sigma_limit_mm: 45.25", "sigma_limit_mm: 45.5", true},
    {"signal_limit_mcps: 0.75", "signal_limit_mcps: 1", true},
    {"applies_gain_factor: false", "applies_gain_factor: true", true},
    {"centre_spad: 151", "centre_spad: 159", true},
    {"width_spads: 4", "width_spads: 5", true},
    {"height_spads: 6", "height_spads: 5", true},
    // What only the host and the simulator use.
    {"sub_rays: 8", "sub_rays: 9", false},
    {"half_angle_deg: 13.25", "half_angle_deg: 13.5", false},
    {"sigma_deg: 6.1", "sigma_deg: 6.2", false},
    {"blur_deg: 2.3", "blur_deg: 2.4", false},
    {"cone: {sub_rays: 8, half_angle_deg: 13.25, sigma_deg: 6.1, blur_deg: 2.3}", "cone: ~", false},
    {"name: full", "name: other", false},
    {"arm: 0.015625", "arm: 0.02", false},
    {"fits_capsules: true", "fits_capsules: false", false},
    {"to_m: [0, 0.0625, 0.25]", "to_m: [0, 0.0625, 0.3]", false},
    {"padding_m: 0.02}", "padding_m: 0.03}", false},
    {"radius_m: 0.04", "radius_m: 0.05", false},
    {"name: ball", "name: bail", false},
    {"links_without_body: [base]", "links_without_body: []", false},
    {"links_ignored_by_sensors: [arm]", "links_ignored_by_sensors: []", false},
    {"depth_self_margin_m: 0.0875", "depth_self_margin_m: 0.09", false},
    {"range_self_margin_m: 0.125", "range_self_margin_m: 0.12", false},
    {"xyz_m: [0.002990", "xyz_m: [0.002991", false},
    {"max_m: 3.9", "max_m: 4", false},
    {"time_uncertainty_max_ms: 2.5", "time_uncertainty_max_ms: 2", false},
    {"rate_hz: 100.5", "rate_hz: 100", false},
    {"node_id: 9", "node_id: 8", false},
    {"fx_px: 60.25", "fx_px: 60", false},
    {"k1: 0.125", "k1: 0.126", false},
    {"k2: -0.25", "k2: -0.251", false},
    {"p1: 0.001", "p1: 0.0011", false},
    {"p2: -0.002", "p2: -0.0021", false},
    {"k3: 0.0625", "k3: 0", false},
    {"depth_units_per_m: 1000", "depth_units_per_m: 5000", false},
    {"depth_no_value: 65535", "depth_no_value: 65534", false},
    {"xyz_m: [2.7, 0, 1.8]", "xyz_m: [2.7, 0, 0.6]", false},
    {"name: board", "name: bord", false},
    {"pinned_build_id: 0x1a2b3c4d", "pinned_build_id: ~", false},
    {"name: front", "name: back", false},
    {"link: arm", "link: plate", false},
    {"xyz_m: [0.05, 0.01, 0.02]", "xyz_m: [0.05, 0.01, 0.021]", false},
    {"rpy_deg: [0, 89, 1]", "rpy_deg: [0, 89, 2]", false},
    {"offset_m: 0.003", "offset_m: 0.004", false},
};

TEST_F(RigText, of_a_camera_without_lens_and_scale_is_what_it_was_before_there_were_such_keys) {
    std::string plain =
        replaced(kFullRig, "  distortion: {k1: 0.125, k2: -0.25, p1: 0.001, p2: -0.002, k3: 0.0625}\n", "");
    plain = replaced(
        plain, "  data_set: {depth_units_per_m: 1000, depth_no_value: 65535, pose_gap_max_ms: 150}\n", "");
    const Rig rig = read_good(plain);
    EXPECT_TRUE(rig.cameras.front().lens.is_none());
    EXPECT_EQ(canonical_text(rig, "r").find("distortion"), std::string::npos);
    EXPECT_EQ(canonical_text(rig, "r").find("data_set"), std::string::npos);
    const Rig written_out = read_good(
        replaced(plain, "  rate_hz: 15\n",
                 "  distortion: {k1: 0}\n  data_set: {depth_units_per_m: 5000, pose_gap_max_ms: 50}\n"
                 "  rate_hz: 15\n"));
    EXPECT_EQ(rig_hash(written_out), rig_hash(rig));
}

TEST_F(RigText, data_ready_lines_arrive_and_survive_the_canonical_text) {
    const Rig rig =
        read_good(replaced(kFullRig, "zone_guard_us: 900", "zone_guard_us: 900\n    data_ready_buses: [1]"));
    EXPECT_EQ(rig.nodes.at(0).config.data_ready_buses, 0b10);
    const Rig again = read_good(canonical_text(rig, "two-links.urdf"));
    EXPECT_EQ(again.nodes.at(0).config, rig.nodes.at(0).config);
    EXPECT_EQ(rig_hash(again), rig_hash(rig));
}

TEST_F(RigText, node_hash_changes_with_what_firmware_uses_and_with_nothing_else_and_rig_hash_with_all) {
    const Rig before = read_good(kFullRig);
    for (const Change& change : kChanges) {
        const auto after = read(replaced(kFullRig, change.from, change.to));
        ASSERT_TRUE(after) << after.error().message();
        EXPECT_EQ(node_hash(after->nodes[0].config) != node_hash(before.nodes[0].config), change.changes_node)
            << change.to;
        EXPECT_NE(rig_hash(*after), rig_hash(before)) << change.to;
    }
}

// A saved map is stale where this changes.
TEST_F(RigText, placement_changes_with_what_says_where_a_measurement_lies_and_with_nothing_else) {
    const std::set<std::string> placing{
        "xyz_m: [0.002990",    "xyz_m: [2.7, 0, 1.8]",  "xyz_m: [0.05, 0.01, 0.02]",
        "rpy_deg: [0, 89, 1]", "offset_m: 0.003",       "fx_px: 60.25",
        "k1: 0.125",           "half_angle_deg: 13.25", "centre_spad: 151"};
    const std::set<std::string> other{"name: full",           "name: front",
                                      "rate_hz: 100.5",       "phase_us: 700",
                                      "timing_budget_ms: 33", "sigma_limit_mm: 45.25",
                                      "arm: 0.015625",        "max_m: 3.9",
                                      "node_id: 9",           "pinned_build_id: 0x1a2b3c4d"};
    const Rig before = read_good(kFullRig);
    std::size_t seen = 0;
    for (const Change& change : kChanges) {
        if (!placing.contains(change.from) && !other.contains(change.from)) continue;
        ++seen;
        const Rig after = read_good(replaced(kFullRig, change.from, change.to));
        EXPECT_EQ(placement_crc32(after, "robot") != placement_crc32(before, "robot"),
                  placing.contains(change.from))
            << change.from;
    }
    EXPECT_GE(seen, placing.size() + other.size());
    EXPECT_NE(placement_crc32(before, "another robot"), placement_crc32(before, "robot"));
}

// ST ULD 3.5.2's budgets, less the 500 ms that the wire cannot carry; in medium mode, which it lacks, those
// that the datasheet allows there.
TEST_F(RigText, each_mode_takes_its_own_budgets_and_no_other) {
    const std::map<std::string, std::set<int>> budgets_ms{{"short", {15, 20, 33, 50, 100, 200}},
                                                          {"medium", {33, 50, 100, 200}},
                                                          {"long", {20, 33, 50, 100, 200}}};
    const std::string slow = replaced(kFullRig, "inter_measurement_ms: 50", "inter_measurement_ms: 300");
    for (const auto& [mode, known] : budgets_ms) {
        const std::string text = replaced(slow, "distance_mode: long", "distance_mode: " + mode);
        for (const int ms : {14, 15, 16, 19, 20, 21, 32, 33, 34, 49, 50, 51, 99, 100, 101, 199, 200}) {
            const auto rig =
                read(replaced(text, "timing_budget_ms: 33", fmt::format("timing_budget_ms: {}", ms)));
            EXPECT_EQ(static_cast<bool>(rig), known.contains(ms)) << mode << ' ' << ms;
        }
    }
}

TEST_F(RigText, damaged_text_never_does_more_than_be_refused) {
    std::ifstream file(kSource / "hw/rigs/bench_one_board.yaml");
    const std::string bench = replaced(std::string(std::istreambuf_iterator<char>(file), {}),
                                       "../robots/panda.urdf", (kSource / "hw/robots/panda.urdf").string());
    const std::string good = replaced(bench, "../boards", (kSource / "hw/boards").string());
    ASSERT_TRUE(read(good));
    std::mt19937 engine(5);
    const std::string letters = "0123456789-.:[]{}#&*!'\"\n\t ~abcxyz\x01\xff";
    int refused = 0;
    for (int draw = 0; draw < 90; ++draw) {
        std::string text = good;
        const auto at = [&](std::size_t size) {
            return std::uniform_int_distribution<std::size_t>(0, size - 1)(engine);
        };
        if (draw % 3 == 0) text.resize(at(text.size()));
        for (int flip = 0; flip < 1 + draw % 4 && !text.empty(); ++flip)
            text[at(text.size())] = letters[at(letters.size())];
        const auto rig = read(text);
        if (rig) continue;
        ++refused;
        EXPECT_TRUE(testing_support::has_its_fields(rig.error()));
    }
    EXPECT_GT(refused, 30);
}

}  // namespace
}  // namespace octoskin::rig
