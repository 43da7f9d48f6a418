#include "host/lab/depth_study/seen_study.hpp"

#include <algorithm>

#include "host/lab/depth_study/depth_mapper.hpp"
#include "host/lab/depth_study/noisy_camera.hpp"
#include "host/lab/study/study.hpp"

namespace octoskin::depth_study {
namespace {

class SeenStudy {
  public:
    explicit SeenStudy(const DepthCase& of) : of_(of) {
        for (const Contender& contender : of.contenders)
            mappers_.emplace_back(of.camera, of.T_map_base, contender.mapping);
    }

    Status<AppError> take(const DepthFrame& frame) {
        for (DepthMapper& mapper : mappers_)
            if (auto taken = mapper.take(frame); !taken) return taken;
        return Done{};
    }

    /// By what the camera sees from where it is.
    Status<AppError> look_from(const rig::Camera& camera) {
        const auto config = truth_config_of(of_.scenario, of_.contenders.front().mapping.map.resolution_m);
        auto truth = evaluation::seen_truth(of_.world, {&camera, 1}, config, of_.T_map_base);
        if (!truth) return fail(ExitCode::bad_config, of_.scenario.error("region", std::move(truth.error())));
        truth_ = std::move(*truth);
        return Done{};
    }

    void judge(std::uint32_t frame) {
        for (std::size_t i = 0; i < mappers_.size(); ++i)
            figures_.push_back(
                {subject_of(of_, of_.contenders[i]), frame / of_.camera.rate_hz,
                 evaluation::seen_metrics(mappers_[i].map(), truth_.value()),
                 evaluation::free_calibration(mappers_[i].map(), miss_units(of_.contenders[i].mapping),
                                              truth_->surface)});
    }

    [[nodiscard]] std::vector<SeenFigures> figures() { return std::move(figures_); }

  private:
    const DepthCase& of_;
    std::vector<DepthMapper> mappers_;
    std::optional<evaluation::SeenTruth> truth_;
    std::vector<SeenFigures> figures_;
};

/// Ascending, each once.
std::vector<std::uint32_t> frames_at(const std::vector<double>& times_s, double rate_hz) {
    std::vector<std::uint32_t> frames;
    for (const double t_s : times_s) frames.push_back(frame_at(t_s, rate_hz));
    std::ranges::sort(frames);
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    return frames;
}

}  // namespace

Subject subject_of(const DepthCase& of, const Contender& contender) {
    return {of.scenario.name,       of.noise.name,     contender.configuration,
            contender.sigma_factor, contender.label(), of.seed};
}

Result<std::vector<SeenFigures>, AppError> study_stationary(const DepthCase& of,
                                                            const std::vector<double>& times_s) {
    SeenStudy study(of);
    if (auto seen = study.look_from(of.camera); !seen) return unexpected(seen.error());
    const NoisyCamera camera(of.world, of.camera, of.noise.noise, of.seed);
    std::uint32_t next = 0;
    for (const std::uint32_t judged : frames_at(times_s, of.camera.rate_hz)) {
        for (; next <= judged; ++next)
            if (auto taken = study.take(camera.frame(next)); !taken) return unexpected(taken.error());
        study.judge(judged);
    }
    return study.figures();
}

Result<std::vector<SeenFigures>, AppError> study_moving(const DepthCase& of, double end_s) {
    SeenStudy study(of);
    const std::uint32_t last = frame_at(end_s, of.camera.rate_hz);
    for (std::uint32_t i = 0; i <= last; ++i) {
        rig::Camera camera = of.camera;
        camera.T_link_camera = circling(of.camera.T_link_camera, i / of.camera.rate_hz);
        DepthFrame frame = NoisyCamera(of.world, camera, of.noise.noise, of.seed).frame(i);
        frame.T_map_camera = of.T_map_base * camera.T_link_camera;
        if (auto taken = study.take(frame); !taken) return unexpected(taken.error());
        if (i != 0 && i != last) continue;
        if (auto seen = study.look_from(camera); !seen) return unexpected(seen.error());
        study.judge(i);
    }
    return study.figures();
}

}  // namespace octoskin::depth_study
