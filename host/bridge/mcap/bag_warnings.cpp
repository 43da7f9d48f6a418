#include "host/bridge/mcap/bag_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace octoskin::bridge {
namespace {

using Sentences = std::vector<std::string>;

void add_damage(const mcap::McapReader& reader, Sentences& sentences) {
    constexpr auto kNames = names_of(mcap::Fault{});
    std::string text;
    for (std::size_t i = 0; i < kNames.size(); ++i)
        if (const auto count = reader.count(mcap::Fault{static_cast<std::uint8_t>(i)}); count > 0)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kNames[i], count);
    if (!text.empty()) sentences.push_back("parts of the file are damaged and not read: " + text);
}

/// What makes each reason go away.
std::string remedy_of(std::string_view reason, const JointStates& joints) {
    if (reason == "stamp_off")
        return "they are of another clock than the log's, for which --log-time helps, or years from the "
               "others: "
               "see docs/reference/mcap.md";
    if (reason == "other_type") return "the topic has another type: give the right topic";
    if (reason == "partial") return "they lack " + joints.missing();
    if (reason == "other_joints")
        return "they have other joints, as " + joints.other_names() + ": write these names into the rig";
    if (reason == "second_sender") return "several topics or publishers have them";
    if (reason == "wrong_size")
        return "they have another size than the rig's camera, or no position for each name";
    if (reason == "encoding")
        return "they are no depth images of 16UC1, mono16, 32FC1 or compressedDepth png";
    return "see docs/reference/mcap.md";
}

void add_losses(const ImportedBag& imported, const JointStates& joints, Sentences& sentences) {
    for (const auto& [topic, account] : imported.topics) {
        const std::uint64_t rejected = account.rejected_in_all();
        const bool is_loss = 2 * rejected > account.messages && !account.rejected.contains(kNotNeeded);
        if (!is_loss || account.rejected.contains("no_camera_info")) continue;
        const auto most = std::ranges::max_element(
            account.rejected, [](const auto& a, const auto& b) { return a.second < b.second; });
        sentences.push_back(fmt::format("{}: {} of {} messages are not used, most as {}: {}", topic, rejected,
                                        account.messages, most->first, remedy_of(most->first, joints)));
    }
}

void add_cameras(const ImportedBag& imported, const std::vector<BagCamera>& cameras, Sentences& sentences) {
    for (const BagCamera& camera : cameras) {
        if (!imported.topics.contains(camera.topic())) {
            sentences.push_back("the bag has no " + camera.topic() +
                                ", which the rig names for a camera: the map is made without its images");
        } else if (!camera.problem().empty()) {
            sentences.push_back(camera.topic() + ": no image is used: " + camera.problem());
        }
        if (camera.pixels_too_far() > 0)
            sentences.push_back(fmt::format("{}: {} pixels beyond 32.767 m are left out", camera.topic(),
                                            camera.pixels_too_far()));
    }
}

}  // namespace

Sentences warnings_about(const ImportedBag& imported, const mcap::McapReader& reader, const BagSurvey& survey,
                         const BagTopics& topics, const std::vector<BagCamera>& cameras,
                         const JointStates& joints, const BagLog& log) {
    Sentences sentences;
    add_damage(reader, sentences);
    if (survey.has_can && !survey.clock)
        sentences.emplace_back(
            "the CAN frames have no SYNC with its FOLLOW_UP of a host: their readings cannot be placed. "
            "Record "
            "the topic with all frames of the bus");
    if (survey.needs_can && !survey.has_can)
        sentences.push_back(fmt::format(
            "the bag has no CAN frames ({0}): no ranges; export with --also {1}, or record these topics",
            fmt::join(topics.can, ", "), fmt::join(topics.can, " --also ")));
    if (joints.has_local_source() && !imported.topics.contains(topics.joint_states))
        sentences.push_back("the bag has no " + topics.joint_states +
                            ", and its bus no joint states: give the topic with --joint-states");
    add_cameras(imported, cameras, sentences);
    add_losses(imported, joints, sentences);
    if (log.thinned() > 0)
        sentences.push_back(fmt::format(
            "{} joint samples are left out: they come faster than the rig's rate_hz", log.thinned()));
    return sentences;
}

}  // namespace octoskin::bridge
