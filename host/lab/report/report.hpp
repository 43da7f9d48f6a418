// report.html: one self-contained file that shows what the fused map contains beyond the camera's map.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/core/mapping/cone_model.hpp"
#include "host/core/mapping/update_model.hpp"
#include "host/lab/evaluation/results.hpp"
#include "host/lab/report/image.hpp"

namespace octoskin::report {

/// One map or the scene, from the robot's side and from the camera's.
struct PicturePair {
    std::string title;    ///< "Depth camera only"
    std::string caption;  ///< description, one or two sentences
    Image front;
    Image back;
};

/// A map for the view in three dimensions.
struct ViewedMap {
    std::string title;
    std::vector<std::string> payloads;  ///< the whole map as payloads of `watch` (docs/reference/watch.md)
};

/// The input counters of one kind of input: received = used + sum of rejected.
struct ReportCounters {
    std::string input;  ///< "ranges"
    std::uint64_t received = 0;
    std::uint64_t used = 0;
    std::vector<std::pair<std::string, std::uint64_t>> rejected;  ///< counter name, count
};

/// How the ranges of a run were mapped.
struct RangeCounting {
    bool has_rays = true;           ///< some are rays, with the update model's terms
    std::optional<ConeModel> cone;  ///< of beams that were counted, if there are any, and are whole cones
    std::optional<ConeModel> zone;  ///< the same of zones
    CountModel counts;
};

struct ReportInput {
    std::string title = "octoskin: what the camera cannot see";
    evaluation::Results results;
    std::size_t cameras = 1;  ///< of the rig; only several change a text
    /// The configuration of the headline and the pictures.
    std::string main_configuration = "fast";
    std::uint64_t picture_seed = 0;
    std::vector<PicturePair> pictures;  ///< scene first, then the maps
    std::vector<ViewedMap> viewed_maps = {};
    std::string view_script = {};  ///< JavaScript that shows them; empty: they are left out
    UpdateModel update_model;
    RangeCounting range_counting;
    std::vector<ReportCounters> inputs;
    std::vector<std::string> hidden_objects;  ///< what the scenario names as hidden: "cone", "crate"
    std::vector<std::string> idealisations;   ///< one sentence each
    std::vector<std::string> reproduce;       ///< shell commands
};

/// The whole document, UTF-8, without references to other files. Sections without input are left out: the
/// camera's figures if no camera map was judged, the paper's figures if this is another experiment. Text in
/// the input may hold any characters: it is escaped. Equal inputs give equal bytes.
[[nodiscard]] std::string report_html(const ReportInput& input);

}  // namespace octoskin::report
