// octoskin-bench: how long the work of a map takes, beside OctoMap, on the same data in the same run.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "tests/bench/clouds.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/frame_rows.hpp"
#include "tests/bench/map_rows.hpp"
#include "tests/bench/peer_rows.hpp"
#include "tests/bench/room_frames.hpp"
#include "tests/bench/task.hpp"
#include "tests/bench/verify.hpp"
#include "tests/bench/whole_rows.hpp"

namespace octoskin::bench {
namespace {

constexpr unsigned kFrames = 50;
/// OctoMap takes half a minute for a frame at 1 cm.
constexpr unsigned kOctomapFramesBelow15mm = 5;
/// What frames look like decides how long they take, so figures are compared only between such as these.
constexpr std::array kMeanDepth_m = {3.3, 3.5};
constexpr std::array kShareBeyond = {0.12, 0.18};

struct NamedCamera {
    const char* suffix;
    CameraIntrinsics camera;
    bool is_stationary = false;
};
constexpr CameraIntrinsics kCamera{
    .width = 512, .height = 424, .fx = 365.0, .fy = 365.0, .cx = 256.0, .cy = 212.0};
constexpr std::array kCameras = {
    NamedCamera{.suffix = "", .camera = kCamera},
    NamedCamera{.suffix = "_640x480",
                .camera = {.width = 640, .height = 480, .fx = 440.0, .fy = 440.0, .cx = 320.0, .cy = 240.0}},
    NamedCamera{.suffix = "_stands", .camera = kCamera, .is_stationary = true},
};

/// Removed at the end, with all that is in it.
class Folder {
  public:
    Folder() : path_((std::filesystem::temp_directory_path() / "octoskin-bench-XXXXXX").string()) {
        if (::mkdtemp(path_.data()) == nullptr)
            throw std::runtime_error(path_ + ": cannot make this folder for maps to save; set TMPDIR");
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    [[nodiscard]] std::filesystem::path path() const { return path_; }

  private:
    std::string path_;
};

/// Each run's times, milliseconds.
struct Times {
    std::vector<double> cpu;  ///< of all threads
    std::vector<double> clock;
};

class Gatherer : public benchmark::BenchmarkReporter {
  public:
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override {
        for (const Run& run : runs) {
            if (run.run_type != Run::RT_Iteration) continue;
            Times& times = times_[run.run_name.function_name];
            const auto iterations = static_cast<double>(run.iterations);
            times.cpu.push_back(1e3 * run.cpu_accumulated_time / iterations);
            times.clock.push_back(1e3 * run.real_accumulated_time / iterations);
        }
    }
    [[nodiscard]] const Times& of(const std::string& row) const { return times_.at(row); }

  private:
    std::map<std::string, Times> times_;
};

struct Options {
    std::vector<std::string> resolutions = {"0.04", "0.02", "0.01"};
    std::vector<std::string> rows;
    unsigned runs = kFrames;
    std::string frames;
    std::string json;
    bool verifies = false;
    bool lists = false;
};

std::vector<Row> rows_of(const std::vector<RoomFrames>& rooms, const std::string& resolution,
                         const Options& options, const std::filesystem::path& folder) {
    const unsigned octomap_runs =
        std::stod(resolution) < 0.015 ? std::min(options.runs, kOctomapFramesBelow15mm) : options.runs;
    std::vector<Row> rows;
    const auto append = [&](std::vector<Row> more) { std::ranges::move(more, std::back_inserter(rows)); };
    for (std::size_t i = 0; i < rooms.size(); ++i) {
        const std::string suffix = kCameras[i].suffix;
        append(peer_rows(rooms[i], resolution, options.runs, octomap_runs, suffix));
        append(whole_rows(rooms[i], resolution, options.runs, suffix));
        if (!rooms[i].is_stationary) append(frame_rows(rooms[i], resolution, options.runs, suffix));
    }
    append(map_rows(rooms.front(), resolution, options.runs, folder));
    return rows;
}

/// The blocks that a run has freed the allocator merges and sorts at the next large requests, whoever makes
/// them: after OctoMap's, a million blocks, more than 10 ms. Not to be charged to the run that comes next.
void settle_heap() {
    // glibc: from 1 KiB on a request is large; each sorts 10,000 blocks at most.
    constexpr std::size_t kLargeRequest = 4096;
    constexpr int kRequests = 200;
    std::vector<std::unique_ptr<char[]>> blocks;  // NOLINT: of bytes
    for (int i = 0; i < kRequests; ++i)
        blocks.push_back(std::make_unique_for_overwrite<char[]>(kLargeRequest));
}

std::string check(const std::vector<Row>& rows, const std::vector<std::string>& asked) {
    for (const std::string& name : asked) {
        if (std::ranges::find(rows, name, &Row::name) == rows.end())
            return fmt::format("--row: there is no row '{}'; --list names them", name);
    }
    return {};
}

void measure(const std::vector<Row>& rows, const Options& options, std::map<std::string, Figures>& all) {
    benchmark::ClearRegisteredBenchmarks();
    std::map<std::string, std::unique_ptr<Task>> tasks;
    std::set<std::string> by_clock;
    for (const Row& row : rows) {
        if (!options.rows.empty() && std::ranges::find(options.rows, row.name) == options.rows.end())
            continue;
        Task& task = *(tasks[row.name] = row.make());
        all[row.name].peer = row.peer;
        if (row.is_by_clock) by_clock.insert(row.name);
        benchmark::RegisterBenchmark(row.name.c_str(),
                                     [&task](benchmark::State& state) {
                                         task.prepare();
                                         settle_heap();
                                         for (auto _ : state) task.run();
                                     })
            ->Iterations(1)
            ->MeasureProcessCPUTime()
            ->Repetitions(static_cast<int>(row.runs));
    }
    Gatherer gatherer;
    benchmark::RunSpecifiedBenchmarks(&gatherer);
    for (const auto& [name, task] : tasks) {
        all[name].run_ms = by_clock.contains(name) ? gatherer.of(name).clock : gatherer.of(name).cpu;
        task->tell(all[name]);
    }
}

void tell_frames(const RoomFrames& room) {
    fmt::print("{} frames of {} x {}{}: mean depth {:.2f} m, {:.1f} % beyond {} m\n", room.frames.size(),
               room.camera.width, room.camera.height, room.is_stationary ? " from one place" : "",
               room.mean_depth_m, 100.0 * room.share_beyond, kRangeMax_m);
}

/// Says on the error stream if the frames are not what they should be.
bool check_room(const RoomFrames& room) {
    const auto is_within = [](double value, const std::array<double, 2>& range) {
        return value >= range[0] && value <= range[1];
    };
    if (room.without_return == 0 && is_within(room.mean_depth_m, kMeanDepth_m) &&
        is_within(room.share_beyond, kShareBeyond)) {
        return true;
    }
    fmt::print(
        stderr,
        "{}: its figures could not be compared: every pixel should return ({} do not), mean depth be {} to "
        "{} m, and {:.0f} to {:.0f} % be beyond {} m\n",
        OCTOSKIN_ROOM, room.without_return, kMeanDepth_m[0], kMeanDepth_m[1], 100.0 * kShareBeyond[0],
        100.0 * kShareBeyond[1], kRangeMax_m);
    return false;
}

/// Not 0: an exit code, already told why.
int render(std::vector<RoomFrames>& rooms) {
    for (const NamedCamera& named : kCameras) {
        auto room = render_room(OCTOSKIN_ROOM, named.camera, named.is_stationary, kFrames, kRangeMax_m);
        if (!room) {
            fmt::print(stderr, "{}\n", room.error().message());
            return 1;
        }
        tell_frames(*room);
        if (!check_room(*room)) return 1;
        rooms.push_back(std::move(*room));
    }
    return 0;
}

/// Likewise; one camera, that of the data set.
int read(const std::string& folder, std::vector<RoomFrames>& rooms) {
    auto room = read_frames(folder, kFrames, kRangeMax_m);
    if (!room) {
        fmt::print(stderr, "{}\n", room.error().message());
        return 1;
    }
    tell_frames(*room);
    rooms.push_back(std::move(*room));
    return 0;
}

/// Frames without images: the names of the rows depend on nothing else.
std::vector<RoomFrames> rooms_of(const Options& options) {
    if (!options.frames.empty()) return std::vector<RoomFrames>(1);
    std::vector<RoomFrames> rooms;
    for (const NamedCamera& named : kCameras)
        rooms.push_back({.camera = named.camera, .frames = {}, .is_stationary = named.is_stationary});
    return rooms;
}

std::optional<DataSetFrames> data_set_of(const std::vector<RoomFrames>& rooms, const Options& options) {
    if (options.frames.empty()) return std::nullopt;
    const RoomFrames& room = rooms.front();
    return DataSetFrames{options.frames, room.camera.width, room.camera.height, room.mean_depth_m};
}

std::string check_resolution(const std::string& text) {
    char* end = nullptr;
    const double value_m = std::strtod(text.c_str(), &end);
    if (end != text.c_str() + text.size() || !(value_m >= 0.005 && value_m <= 1.0))
        return "'" + text + "' is no number of metres from 0.005 to 1";
    return {};
}

int measure_all(const std::vector<RoomFrames>& rooms, const Options& options) {
    const auto data_set = data_set_of(rooms, options);
    // Better now than after an hour.
    AllFigures all;
    if (!options.json.empty() && !write_json(all, data_set, options.json)) {
        fmt::print(stderr, "{}: cannot write\n", options.json);
        return 1;
    }
    const Folder folder;
    for (const std::string& resolution : options.resolutions)
        measure(rows_of(rooms, resolution, options, folder.path()), options, all[resolution]);
    print(all);
    if (!options.json.empty() && !write_json(all, data_set, options.json)) {
        fmt::print(stderr, "{}: cannot write\n", options.json);
        return 1;
    }
    return 0;
}

int run_with(const Options& options, char* program) {
    std::vector<RoomFrames> rooms;
    const std::vector<RoomFrames> unseen = rooms_of(options);
    const std::vector<Row> rows = rows_of(unseen, "1", options, {});
    if (options.lists) {
        for (const Row& row : rows) fmt::print("{:<32} {}\n", row.name, row.peer == row.name ? "" : row.peer);
        return 0;
    }
    if (const std::string fault = check(rows, options.rows); !fault.empty()) {
        fmt::print(stderr, "{}\n", fault);
        return 2;
    }
    const int code = options.frames.empty() ? render(rooms) : read(options.frames, rooms);
    if (code != 0) return code;
    if (options.verifies) {
        bool is_equal = true;
        for (const std::string& resolution : options.resolutions)
            is_equal &= verify(rooms.front(), resolution, options.runs);
        return is_equal ? 0 : 1;
    }
    // Repetitions of all rows in random order: what else the machine does meets each of them alike.
    std::string interleaving = "--benchmark_enable_random_interleaving=true";
    std::array<char*, 3> arguments = {program, interleaving.data(), nullptr};
    int count = 2;
    benchmark::Initialize(&count, arguments.data());
    return measure_all(rooms, options);
}

int run(int argc, char** argv) {
    CLI::App app(
        "How long the work of a map takes, beside OctoMap, on the same data in the same run: CPU times, but "
        "of rows of several threads and their peers the clock's.");
    Options options;
    app.add_option("--resolution", options.resolutions, "Of the maps, metres")
        ->capture_default_str()
        ->check(CLI::Validator(check_resolution, "METRES"));
    app.add_option("--row", options.rows, "Measure these rows only; a ratio needs OctoMap's row, too");
    app.add_flag("--list", options.lists, "Name the rows, each with OctoMap's that it is compared with");
    app.add_option("--frames", options.frames,
                   "Take the images of this data set (TUM RGB-D, ICL-NUIM, ETH3D or 7-Scenes layout)");
    app.add_option("--runs", options.runs, "Runs of each row; 5 at most of OctoMap's frames below 1.5 cm")
        ->capture_default_str()
        ->check(CLI::Range(1U, 10'000U));
    app.add_option("--json", options.json, "Write the figures to this file, too");
    app.add_flag("--verify", options.verifies,
                 "Compare the voxels with OctoMap's, key by key, and measure nothing");
    CLI11_PARSE(app, argc, argv);
    return run_with(options, argv[0]);
}

}  // namespace
}  // namespace octoskin::bench

int main(int argc, char** argv) {
    try {
        return octoskin::bench::run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "octoskin-bench: {}\n", error.what());
        return 1;
    }
}
