#include "tests/bench/map_rows.hpp"

#include <octomap/octomap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>

#include "host/core/mapping/depth_integrator.hpp"
#include "host/core/mapping/ray_model.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/mapfile/octomap_mirror.hpp"
#include "host/io/mapfile/octomap_tree.hpp"
#include "tests/bench/arm_capsules.hpp"
#include "tests/bench/clouds.hpp"
#include "tests/bench/planner_rows.hpp"
#include "tests/bench/reading_rows.hpp"
#include "tests/bench/sizes.hpp"

namespace octoskin::bench {
namespace {

constexpr std::size_t kFramesOfMap = 10;
constexpr std::size_t kQueries = 100'000;
constexpr unsigned kBeams = 34;

/// The same voxels, ours and as OctoMap holds them. Made once for all rows of a resolution.
class Maps {
  public:
    Maps(const RoomFrames& room, const std::string& resolution) : room_(room), resolution_(resolution) {}
    [[nodiscard]] const FusedMap& ours() {
        if (!ours_) fill();
        return *ours_;
    }
    [[nodiscard]] octomap::OcTree& octomap() {
        if (!octomap_) octomap_ = to_octomap(ours());
        return *octomap_;
    }

  private:
    void fill() {
        const MappingConfig config = bench_mapping(resolution_, DepthUpdate::paper);
        DepthIntegrator integrator(config, room_.camera);
        ours_.emplace(config.map);
        for (std::size_t i = 0; i < std::min(kFramesOfMap, room_.frames.size()); ++i) {
            const auto result = integrator.integrate(room_.frames[i].image, room_.frames[i].T_map_camera);
            if (!result) throw std::runtime_error("a frame was refused");
            ours_->apply(result->terms);
        }
    }
    const RoomFrames& room_;
    std::string resolution_;
    std::optional<FusedMap> ours_;
    std::unique_ptr<octomap::OcTree> octomap_;
};

/// A task of two functions, the first of which need not be there.
class FunctionTask final : public Task {
  public:
    FunctionTask(std::function<void()> run, std::function<void(Figures&)> tell)
        : run_(std::move(run)), tell_(std::move(tell)) {}
    void run() override { run_(); }
    void tell(Figures& figures) const override { tell_(figures); }

  private:
    std::function<void()> run_;
    std::function<void(Figures&)> tell_;
};

/// Beams out of two rings round a link in the midst of the room, which turns on from cycle to cycle, as far
/// as the range sensors see.
class BeamCycles {
  public:
    [[nodiscard]] std::vector<Beam> next() {
        const double turn = 0.05 * cycle_++;
        std::vector<Beam> beams;
        for (unsigned i = 0; i < kBeams; ++i) {
            const double angle = turn + 2.0 * std::numbers::pi * i / kBeams;
            const double tilt = (i % 2 == 0 ? 0.3 : -0.3);
            Beam beam;
            beam.direction_map = {std::cos(tilt) * std::cos(angle), std::cos(tilt) * std::sin(angle),
                                  std::sin(tilt)};
            beam.p_map_sensor = Eigen::Vector3d(0.911, -0.123, 1.317) + 0.06 * beam.direction_map;
            beam.range_m = range_m_(random_);
            beams.push_back(beam);
        }
        return beams;
    }

  private:
    unsigned cycle_ = 0;
    std::mt19937 random_{2};
    std::uniform_real_distribution<double> range_m_{0.3, 3.0};
};

class OurBeams final : public Task {
  public:
    OurBeams(const std::string& resolution, bool keeps_times)
        : config_(bench_mapping(resolution, DepthUpdate::robust)), model_(config_), map_(config_.map) {
        if (keeps_times) map_.advance_time(HostTime{0});
    }
    void prepare() override { beams_ = cycles_.next(); }
    void run() override {
        for (const Beam& beam : beams_) {
            const auto evidence = model_.find(beam);
            if (!evidence) throw std::runtime_error("a beam was refused");
            map_.apply((*evidence)->terms);
        }
    }
    void tell(Figures& figures) const override { tell_size(map_, figures); }

  private:
    MappingConfig config_;
    RayModel model_;
    FusedMap map_;
    BeamCycles cycles_;
    std::vector<Beam> beams_;
};

class OctomapBeams final : public Task {
  public:
    explicit OctomapBeams(const std::string& resolution) : tree_(std::stod(resolution)) {}
    void prepare() override {
        beams_.clear();
        for (const Beam& beam : cycles_.next()) {
            const Eigen::Vector3f origin = beam.p_map_sensor.cast<float>();
            const Eigen::Vector3f end =
                (beam.p_map_sensor + *beam.range_m * beam.direction_map).cast<float>();
            octomap::Pointcloud cloud;
            cloud.push_back(end.x(), end.y(), end.z());
            beams_.emplace_back(cloud, octomap::point3d(origin.x(), origin.y(), origin.z()));
        }
    }
    void run() override {
        for (const auto& [cloud, origin] : beams_) tree_.insertPointCloud(cloud, origin);
    }
    void tell(Figures& figures) const override { tell_size(tree_, figures); }

  private:
    octomap::OcTree tree_;
    BeamCycles cycles_;
    std::vector<std::pair<octomap::Pointcloud, octomap::point3d>> beams_;
};

/// From the ten frames' map on, one frame after the other: what each changes, into a tree that shows the
/// rest.
class ExportChanges final : public Task {
  public:
    ExportChanges(const RoomFrames& room, const std::string& resolution, const FusedMap& ten_frames)
        : room_(room),
          integrator_(bench_mapping(resolution, DepthUpdate::paper), room.camera),
          map_(ten_frames.copy()),
          mirror_(map_.config()) {
        (void)mirror_.update(map_);
    }
    void prepare() override {
        const RoomFrame& frame = room_.frames[next_++ % room_.frames.size()];
        const auto result = integrator_.integrate(frame.image, frame.T_map_camera);
        if (!result) throw std::runtime_error("a frame was refused");
        map_.apply(result->terms);
    }
    void run() override {
        if (mirror_.update(map_) == 0) throw std::runtime_error("a frame changed nothing");
    }
    void tell(Figures& figures) const override { tell_size(mirror_.tree(), figures); }

  private:
    const RoomFrames& room_;
    DepthIntegrator integrator_;
    FusedMap map_;
    OctomapMirror mirror_;
    std::size_t next_ = kFramesOfMap;
};

std::vector<Eigen::Vector3d> points_in(const Eigen::AlignedBox3d& box) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(box.min().x(), box.max().x());
    std::uniform_real_distribution<double> y(box.min().y(), box.max().y());
    std::uniform_real_distribution<double> z(box.min().z(), box.max().z());
    std::vector<Eigen::Vector3d> points(kQueries);
    for (Eigen::Vector3d& point : points) point = {x(random), y(random), z(random)};
    return points;
}

std::size_t occupied_of(const FusedMap& map, const std::vector<Eigen::Vector3d>& points) {
    std::size_t occupied = 0;
    for (const Eigen::Vector3d& point : points) {
        const auto key = map.key_of(point);
        if (key && map.occupancy(*key) == Occupancy::occupied) ++occupied;
    }
    return occupied;
}

std::size_t occupied_of(const octomap::OcTree& tree, const std::vector<Eigen::Vector3d>& points) {
    std::size_t occupied = 0;
    for (const Eigen::Vector3d& point : points) {
        const octomap::OcTreeNode* node = tree.search(point.x(), point.y(), point.z());
        if (node != nullptr && tree.isNodeOccupied(node)) ++occupied;
    }
    return occupied;
}

/// What fills the maps comes from `maps` when a row is made, and so is not timed.
class MapRows {
  public:
    MapRows(std::shared_ptr<Maps> maps, unsigned runs) : maps_(std::move(maps)), runs_(runs) {}

    void add_ours(const std::string& name, const std::string& peer,
                  std::function<void(const FusedMap&)> run) {
        rows.push_back({name, peer, runs_, [maps = maps_, run = std::move(run)] {
                            const FusedMap& map = maps->ours();
                            return std::make_unique<FunctionTask>(
                                [&map, run] { run(map); },
                                [&map](Figures& figures) { tell_size(map, figures); });
                        }});
    }
    void add_octomap(const std::string& name, std::function<void(octomap::OcTree&)> run) {
        rows.push_back({name, name, runs_, [maps = maps_, run = std::move(run)] {
                            octomap::OcTree& tree = maps->octomap();
                            return std::make_unique<FunctionTask>(
                                [&tree, run] { run(tree); },
                                [&tree](Figures& figures) { tell_size(tree, figures); });
                        }});
    }

    std::vector<Row> rows;

  private:
    std::shared_ptr<Maps> maps_;
    unsigned runs_;
};

/// How many capsules are in each state. Equal of two maps of the same voxels.
using States = std::array<std::size_t, 3>;

States states_of(const FusedMap& map, const std::vector<ArmCapsules>& postures) {
    States states{};
    for (const ArmCapsules& capsules : postures) {
        std::array<CapsuleAnswer, 7> answers;
        if (!worst_in(map, capsules, answers)) throw std::runtime_error("a capsule was refused");
        for (const CapsuleAnswer& answer : answers) ++states.at(static_cast<std::size_t>(answer.state));
    }
    return states;
}

States states_of(const octomap::OcTree& tree, const std::vector<ArmCapsules>& postures) {
    States states{};
    for (const ArmCapsules& capsules : postures) {
        for (const PosedCapsule& capsule : capsules)
            ++states.at(static_cast<std::size_t>(worst_in(tree, capsule).state));
    }
    return states;
}

void require(bool is_done, const char* what) {
    if (!is_done) throw std::runtime_error(what);
}

void add_files(MapRows& rows, const std::filesystem::path& folder, const std::string& resolution,
               const std::shared_ptr<Maps>& maps) {
    const std::string ours = folder / (resolution + ".ot");
    const std::string octomaps = folder / (resolution + ".octomap.ot");
    rows.add_octomap("octomap_save", [octomaps](const octomap::OcTree& tree) {
        require(tree.write(octomaps), "OctoMap cannot save");
    });
    rows.add_ours("save", "octomap_save", [ours](const FusedMap& map) {
        const auto saved = save_map(map, ours);
        if (!saved) throw std::runtime_error(saved.error().message());
    });
    // One file for both to load. Whether a row that saves comes first depends on the order of rows.
    const std::string loaded = folder / (resolution + ".loaded.ot");
    const auto provide = [maps, loaded] {
        if (std::filesystem::exists(loaded)) return;
        const auto saved = save_map(maps->ours(), loaded);
        if (!saved) throw std::runtime_error(saved.error().message());
    };
    const auto with_file = [&](Row row) {
        row.make = [provide, make = std::move(row.make)] {
            provide();
            return make();
        };
        return row;
    };
    rows.add_octomap("octomap_load", [loaded](const octomap::OcTree& tree) {
        // AbstractOcTree::read() tells each file on the error stream: its header is skipped by hand.
        std::ifstream file(loaded, std::ios::binary);
        for (std::string line; std::getline(file, line) && line != "data";) {
        }
        octomap::OcTree read(tree.getResolution());
        read.readData(file);
        require(read.size() == tree.size(), "OctoMap cannot load");
    });
    rows.rows.back() = with_file(std::move(rows.rows.back()));
    rows.add_ours("load", "octomap_load", [loaded](const FusedMap& map) {
        const auto read = load_map(loaded, {.map = map.config()});
        if (!read) throw std::runtime_error(read.error().message());
    });
    rows.rows.back() = with_file(std::move(rows.rows.back()));
}

/// Both must find the same states, of which each must occur.
void add_capsules(MapRows& rows, const RoomFrames& room) {
    const auto postures =
        std::make_shared<const std::vector<ArmCapsules>>(postures_of_arm(OCTOSKIN_RIG, room.T_map_arm));
    const auto states = std::make_shared<std::optional<States>>();
    const auto check = [states](const States& found) {
        require(std::ranges::find(found, 0U) == found.end(), "a state of capsules does not occur");
        if (!*states) *states = found;
        require(**states == found, "capsules are in other states than before, or in OctoMap");
    };
    rows.add_octomap("octomap_capsules",
                     [postures, check](const octomap::OcTree& tree) { check(states_of(tree, *postures)); });
    rows.add_ours("capsules", "octomap_capsules",
                  [postures, check](const FusedMap& map) { check(states_of(map, *postures)); });
}

}  // namespace

std::vector<Row> map_rows(const RoomFrames& room, const std::string& resolution, unsigned runs,
                          const std::filesystem::path& folder) {
    const auto maps = std::make_shared<Maps>(room, resolution);
    MapRows rows(maps, runs);
    rows.rows.push_back({"octomap_beams", "octomap_beams", runs,
                         [resolution] { return std::make_unique<OctomapBeams>(resolution); }});
    rows.rows.push_back({"beams", "octomap_beams", runs,
                         [resolution] { return std::make_unique<OurBeams>(resolution, false); }});
    rows.rows.push_back({"beams_dated", "beams", runs,
                         [resolution] { return std::make_unique<OurBeams>(resolution, true); }});
    rows.add_octomap("octomap_snapshot", [](const octomap::OcTree& tree) {
        const octomap::OcTree copy(tree);
        require(copy.size() == tree.size(), "OctoMap's copy differs");
    });
    rows.add_ours("snapshot", "octomap_snapshot", [](const FusedMap& map) {
        const FusedMap copy = map.copy();
        require(copy.known_voxels() == map.known_voxels(), "a copy differs");
    });
    rows.add_ours("export", "",
                  [](const FusedMap& map) { require(to_octomap(map)->size() > 1, "an export is empty"); });
    rows.rows.push_back({"export_changes", "export", runs, [&room, resolution, maps] {
                             return std::make_unique<ExportChanges>(room, resolution, maps->ours());
                         }});
    add_files(rows, folder, resolution, maps);
    const auto points = std::make_shared<const std::vector<Eigen::Vector3d>>(points_in(room.asked));
    rows.add_octomap("octomap_points", [points](const octomap::OcTree& tree) {
        require(occupied_of(tree, *points) > 0, "OctoMap finds nothing");
    });
    rows.add_ours("points", "octomap_points", [points](const FusedMap& map) {
        require(occupied_of(map, *points) > 0, "nothing is found");
    });
    add_capsules(rows, room);
    const auto map = [maps]() -> const FusedMap& { return maps->ours(); };
    for (Row& row : planner_rows(room, resolution, runs, map)) rows.rows.push_back(std::move(row));
    for (Row& row : reading_rows(std::filesystem::path(OCTOSKIN_RIG).parent_path(), resolution, runs, map))
        rows.rows.push_back(std::move(row));
    return std::move(rows.rows);
}

}  // namespace octoskin::bench
