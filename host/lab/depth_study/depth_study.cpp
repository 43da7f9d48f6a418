#include "host/lab/depth_study/depth_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <mutex>
#include <utility>

#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/reading.hpp"
#include "host/apps/version/version.hpp"
#include "host/lab/simulation/scene.hpp"
#include "host/lab/study/configurations.hpp"
#include "host/lab/study/parallel.hpp"
#include "host/lab/study/part_timer.hpp"

namespace octoskin::depth_study {
namespace {

using Say = std::function<void(const std::string&)>;

struct NoiseGround {
    NamedNoise noise;
    std::vector<Contender> contenders;
};

/// All inputs, read and checked before any image is made.
struct Ground {
    rig::Rig rig;
    std::vector<Scene> scenes;
    std::vector<NoiseGround> noises;
};

/// Why the study cannot use this rig. It looks at one camera in place of choosing one of several.
std::optional<Error> camera_fault(const rig::Rig& rig) {
    if (rig.cameras.size() > 1)
        return Error{.code = ErrorCode::unsupported,
                     .what = "expected a rig with one camera, which is on no link",
                     .value = fmt::format("{} cameras", rig.cameras.size()),
                     .remedy =
                         "give a rig with the camera to study only: one that `extends` this one, with "
                         "`cameras: ~` and a `camera`",
                     .key = "cameras"};
    if (rig.external_cameras().empty())
        return Error{.code = ErrorCode::missing_key,
                     .what = "expected a rig with a camera that is on no link",
                     .key = "camera"};
    return std::nullopt;
}

Result<rig::Rig, AppError> read_rig_with_camera(const DepthRequest& request) {
    auto rig = read_given_rig(request.rig);
    if (!rig) return rig;
    if (auto fault = camera_fault(*rig))
        return fail(ExitCode::bad_config, in_file(std::move(*fault), request.rig));
    return rig;
}

Result<std::vector<Scene>, AppError> read_scenes(const DepthRequest& request) {
    std::vector<Scene> scenes;
    for (const auto& scenario : request.scenarios) {
        auto scene = read_scene(scenario, {});
        if (!scene) return unexpected(scene.error());
        // The study itself moves the model `hand`.
        const bool moves_hand = request.scene == DepthScene::hand;
        if (auto still = check_stands_still(*scene); !still && !moves_hand) return unexpected(still.error());
        if (request.on_world_warning)
            for (const std::string& warning : scene->world.warnings()) request.on_world_warning(warning);
        scenes.push_back(std::move(*scene));
    }
    return scenes;
}

Result<std::vector<NoiseGround>, AppError> find_noises(const DepthRequest& request) {
    const auto configurations = find_configurations(request.configurations);
    if (!configurations) return unexpected(configurations.error());
    std::vector<NoiseGround> noises;
    for (const std::string& text : request.noises) {
        auto noise = named_noise(text);
        if (!noise) return unexpected(noise.error());
        auto contenders = contenders_of(*configurations, request.sigma_factors, noise->law);
        if (!contenders) return unexpected(contenders.error());
        noises.push_back({std::move(*noise), std::move(*contenders)});
    }
    return noises;
}

Result<Ground, AppError> read_ground(const DepthRequest& request) {
    if (auto checked = check_seeds(request.seeds); !checked) return unexpected(checked.error());
    auto noises = find_noises(request);
    if (!noises) return unexpected(noises.error());
    const auto lock = lock_reading();
    auto rig = read_rig_with_camera(request);
    if (!rig) return unexpected(rig.error());
    auto scenes = read_scenes(request);
    if (!scenes) return unexpected(scenes.error());
    return Ground{std::move(*rig), std::move(*scenes), std::move(*noises)};
}

struct CaseFigures {
    std::vector<SeenFigures> seen;
    std::vector<HandFigures> hand;
};

Result<CaseFigures, AppError> study_case(const DepthCase& of, const DepthRequest& request) {
    if (request.scene == DepthScene::hand) {
        auto hand = study_hand(of);
        if (!hand) return unexpected(hand.error());
        return CaseFigures{{}, std::move(*hand)};
    }
    auto seen = request.scene == DepthScene::stationary
                    ? study_stationary(of, request.times_s)
                    : study_moving(of, *std::ranges::max_element(request.times_s));
    if (!seen) return unexpected(seen.error());
    return CaseFigures{std::move(*seen), {}};
}

/// Numbers the cases: scenarios, then noises, then seeds.
class Cases {
  public:
    Cases(const DepthRequest& request, const Ground& ground, const Say& say)
        : request_(request), ground_(ground), say_(say) {}

    [[nodiscard]] std::size_t size() const {
        return ground_.scenes.size() * ground_.noises.size() * request_.seeds.size();
    }

    Result<CaseFigures, AppError> study(std::size_t index) {
        const std::uint64_t seed = request_.seeds[index % request_.seeds.size()];
        const std::size_t block = index / request_.seeds.size();
        const NoiseGround& noise = ground_.noises[block % ground_.noises.size()];
        const Scene& scene = ground_.scenes[block / ground_.noises.size()];
        Eigen::Isometry3d T_map_base = ground_.rig.T_map_base;
        T_map_base.pretranslate(scene.scenario.map_shift_m(seed));
        const PartTimer timer("");
        auto figures = study_case({.world = scene.world,
                                   .scenario = scene.scenario,
                                   .camera = ground_.rig.cameras.front(),
                                   .T_map_base = T_map_base,
                                   .noise = noise.noise,
                                   .seed = seed,
                                   .contenders = noise.contenders},
                                  request_);
        const std::lock_guard lock(say_mutex_);
        if (figures)
            say_(fmt::format("{}, noise {}, seed {} ({:.1f} s), {} of {}", scene.scenario.name,
                             noise.noise.name, seed, timer.stop().wall_s, ++done_, size()));
        return figures;
    }

  private:
    const DepthRequest& request_;
    const Ground& ground_;
    const Say& say_;
    std::mutex say_mutex_;  ///< guards the calls of `say_`, and the next
    std::size_t done_ = 0;
};

}  // namespace

Result<DepthResults, AppError> run_depth_study(const DepthRequest& request, const Say& say) {
    const auto ground = read_ground(request);
    if (!ground) return unexpected(ground.error());
    Cases cases(request, *ground, say);
    auto all = work_in_parallel<CaseFigures, AppError>(cases.size(), request.jobs,
                                                       [&](std::size_t index) { return cases.study(index); });
    if (!all) return unexpected(all.error());
    DepthResults results{.program = program_version(),
                         .rig = ground->rig.name,
                         .scene = request.scene,
                         .seen = {},
                         .hand = {}};
    for (CaseFigures& figures : *all) {
        std::ranges::move(figures.seen, std::back_inserter(results.seen));
        std::ranges::move(figures.hand, std::back_inserter(results.hand));
    }
    return results;
}

}  // namespace octoskin::depth_study
