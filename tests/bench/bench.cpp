// octoskin-bench: how long one depth frame takes, beside OctoMap, on the same frames in the same run.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>

#include "host/core/mapping/depth_integrator.hpp"
#include "tests/bench/clouds.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/room_frames.hpp"
#include "tests/bench/verify.hpp"

namespace octoskin::bench {
namespace {

constexpr double kRangeMax_m = 4.0;
constexpr CameraIntrinsics kCamera{
    .width = 512, .height = 424, .fx = 365.0, .fy = 365.0, .cx = 256.0, .cy = 212.0};

/// A map and what integrates frames into it, one after the other.
class Integrator {
  public:
    virtual ~Integrator() = default;
    /// Makes ready what the next frame needs that is not part of integrating it.
    virtual void prepare(const RoomFrame&) {}
    virtual void integrate(const RoomFrame& frame) = 0;
    virtual void tell(Figures& figures) const = 0;
};

class OctomapIntegrator final : public Integrator {
  public:
    OctomapIntegrator(const std::string& resolution, bool is_lazy)
        : tree_(std::stod(resolution)), is_lazy_(is_lazy) {}
    void prepare(const RoomFrame& frame) override { cloud_ = cloud_of(frame, kCamera); }
    void integrate(const RoomFrame& frame) override {
        // Lazy evaluation leaves inner nodes to be worked out once: that is part of it.
        tree_.insertPointCloud(cloud_, origin_of(frame), kRangeMax_m, is_lazy_, is_lazy_);
        if (is_lazy_) tree_.updateInnerOccupancy();
    }
    void tell(Figures& figures) const override {
        figures.heap_bytes = tree_.memoryUsage();
        figures.leaves = tree_.getNumLeafNodes();
        for (auto leaf = tree_.begin_leafs(), end = tree_.end_leafs(); leaf != end; ++leaf) {
            figures.voxels += std::size_t{1} << (3 * (tree_.getTreeDepth() - leaf.getDepth()));
        }
    }

  private:
    octomap::OcTree tree_;
    octomap::Pointcloud cloud_;
    bool is_lazy_;
};

class ExactIntegrator final : public Integrator {
  public:
    explicit ExactIntegrator(const MappingConfig& config) : integrator_(config, kCamera), map_(config.map) {}
    void integrate(const RoomFrame& frame) override {
        const auto result = integrator_.integrate(frame.image, frame.T_map_camera);
        if (!result) throw std::runtime_error("a frame was refused");
        map_.apply(result->updates);
    }
    void tell(Figures& figures) const override {
        figures.heap_bytes = map_.memory_bytes();
        figures.voxels = map_.known_voxels();
    }

  private:
    DepthIntegrator integrator_;
    FusedMap map_;
};

struct Row {
    std::string resolution;
    std::string name;
    unsigned frames = 0;
    std::unique_ptr<Integrator> integrator;
    std::size_t next_frame = 0;
};

void integrate_next(benchmark::State& state, Row& row, const RoomFrames& room) {
    const RoomFrame& frame = room.frames[row.next_frame++ % room.frames.size()];
    row.integrator->prepare(frame);
    for (auto _ : state) row.integrator->integrate(frame);
}

/// Gathers each frame's CPU time.
class Gatherer : public benchmark::BenchmarkReporter {
  public:
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override {
        for (const Run& run : runs) {
            if (run.run_type == Run::RT_Iteration) {
                times_[run.run_name.function_name].push_back(1e3 * run.cpu_accumulated_time /
                                                             static_cast<double>(run.iterations));
            }
        }
    }
    [[nodiscard]] const std::vector<double>& of(const Row& row) const {
        return times_.at(row.resolution + "/" + row.name);
    }

  private:
    std::map<std::string, std::vector<double>> times_;
};

std::vector<std::unique_ptr<Row>> rows_of(const std::string& resolution, unsigned frames) {
    // OctoMap takes half a minute for a frame at 1 cm.
    const unsigned few = std::stod(resolution) < 0.015 ? std::min(frames, 5U) : frames;
    std::vector<std::unique_ptr<Row>> rows;
    const auto add = [&](const std::string& name, unsigned count, std::unique_ptr<Integrator> integrator) {
        rows.push_back(std::make_unique<Row>(Row{resolution, name, count, std::move(integrator)}));
    };
    add("octomap", few, std::make_unique<OctomapIntegrator>(resolution, false));
    add("octomap_lazy", few, std::make_unique<OctomapIntegrator>(resolution, true));
    add("exact", frames, std::make_unique<ExactIntegrator>(exact_mapping(resolution, kRangeMax_m)));
    return rows;
}

void measure(const RoomFrames& room, const std::string& resolution, unsigned frames, AllFigures& all) {
    const auto rows = rows_of(resolution, frames);
    benchmark::ClearRegisteredBenchmarks();
    for (const auto& row : rows) {
        const std::string name = resolution + "/" + row->name;
        benchmark::RegisterBenchmark(name.c_str(),
                                     [&](benchmark::State& state) { integrate_next(state, *row, room); })
            ->Iterations(1)
            ->Repetitions(static_cast<int>(row->frames));
    }
    Gatherer gatherer;
    benchmark::RunSpecifiedBenchmarks(&gatherer);
    for (const auto& row : rows) {
        Figures& figures = all[resolution][row->name];
        figures.frame_ms = gatherer.of(*row);
        row->integrator->tell(figures);
    }
}

int run(int argc, char** argv) {
    CLI::App app("How long a depth frame takes, beside OctoMap, on the same frames in the same run.");
    std::vector<std::string> resolutions = {"0.04", "0.02", "0.01"};
    unsigned frames = 50;
    std::string json;
    bool verifies = false;
    app.add_option("--resolution", resolutions, "Of the maps, metres")->capture_default_str();
    app.add_option("--frames", frames, "Of each row; OctoMap has 5 at most below 1.5 cm")
        ->capture_default_str();
    app.add_option("--json", json, "Write the figures to this file, too");
    app.add_flag("--verify", verifies, "Compare the voxels with OctoMap's, key by key, and measure nothing");
    CLI11_PARSE(app, argc, argv);

    const auto room = render_room(OCTOSKIN_ROOM, kCamera, 50, kRangeMax_m);
    if (!room) {
        fmt::print(stderr, "{}\n", room.error().message());
        return 1;
    }
    fmt::print("{} frames of {} x {}: mean depth {:.2f} m, {:.1f} % beyond {} m\n", room->frames.size(),
               kCamera.width, kCamera.height, room->mean_depth_m, 100.0 * room->share_beyond, kRangeMax_m);
    if (verifies) {
        bool is_equal = true;
        for (const std::string& resolution : resolutions)
            is_equal &= verify(*room, resolution, frames, kRangeMax_m);
        return is_equal ? 0 : 1;
    }
    // Repetitions of all rows in random order: what else the machine does meets each of them alike.
    std::string interleaving = "--benchmark_enable_random_interleaving=true";
    std::vector<char*> arguments = {argv[0], interleaving.data(), nullptr};
    int count = 2;
    benchmark::Initialize(&count, arguments.data());
    AllFigures all;
    for (const std::string& resolution : resolutions) measure(*room, resolution, frames, all);
    print(all);
    if (!json.empty() && !write_json(all, json)) {
        fmt::print(stderr, "{}: cannot write\n", json);
        return 1;
    }
    return 0;
}

}  // namespace
}  // namespace octoskin::bench

int main(int argc, char** argv) {
    return octoskin::bench::run(argc, argv);
}
