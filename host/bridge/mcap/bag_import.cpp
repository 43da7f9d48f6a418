#include "host/bridge/mcap/bag_import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/apps/daemon/description.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/recording_draft.hpp"
#include "host/apps/recording/text_file.hpp"
#include "host/apps/robot/fitted_robot.hpp"
#include "host/apps/version/version.hpp"
#include "host/bridge/mcap/bag_camera.hpp"
#include "host/bridge/mcap/bag_joints.hpp"
#include "host/bridge/mcap/bag_log.hpp"
#include "host/bridge/mcap/bag_survey.hpp"
#include "host/bridge/mcap/bag_time.hpp"
#include "host/bridge/mcap/bag_warnings.hpp"
#include "host/bridge/mcap/camera_topics.hpp"
#include "host/bridge/mcap/can_messages.hpp"
#include "host/bridge/mcap/given_topics.hpp"
#include "host/bridge/mcap/output_room.hpp"
#include "host/bridge/robot/first_names.hpp"
#include "host/bridge/robot/robot_facts.hpp"
#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin::bridge {
namespace {

/// Before the first message of a bag without a bus: the bus has 48 bits of microseconds, 9 years.
constexpr Nanoseconds kBusTimeOfFirst{100'000'000'000};

constexpr const char* kJointStates = "/joint_states";

struct Setup {
    rig::Rig rig;
    HostSetup host;
    RobotFacts facts;
};

Result<Setup, AppError> read_setup(const BagRequest& request) {
    auto rig = read_rig_with_body(request.rig, request.robot, BodyFitting::if_needed);
    if (!rig) return unexpected(rig.error());
    auto host = make_host_setup(*rig);
    if (!host) return fail(ExitCode::bad_config, host.error());
    auto facts = robot_facts(description_json(*host, true, 0));
    if (!facts) return fail(ExitCode::failed, {ErrorCode::self_check, facts.error()});
    return Setup{std::move(*rig), std::move(*host), std::move(facts).value()};
}

BagTopics topics_of(const BagRequest& request, const RobotFacts& robot) {
    BagTopics topics{
        .joint_states = request.joint_states.empty() ? kJointStates : request.joint_states,
        .can = request.can.empty() ? std::vector<std::string>{kCanTopic, kCanFdTopic} : request.can,
        .images = {}};
    for (const CameraFacts& camera : robot.cameras) topics.images.push_back(image_topic_of(camera));
    return topics;
}

/// The rig with the sources whose samples come from the topic as local ones.
HostRig with_sources_of(HostRig rig, const BagSurvey& survey) {
    for (HostJointSource& source : rig.joint_sources)
        source.is_local = !survey.joint_nodes.contains(source.node_id);
    return rig;
}

std::vector<std::optional<LocalJoints>> converters_of(const HostRig& rig) {
    std::vector<std::optional<LocalJoints>> converters;
    for (const HostJointSource& source : rig.joint_sources)
        converters.push_back(
            source.is_local ? std::optional(LocalJoints(source.node_id, source.joints.size(), source.rate_hz))
                            : std::nullopt);
    return converters;
}

std::vector<BagCamera> cameras_of(const RobotFacts& robot, const BagTopics& topics, const BagSurvey& survey) {
    std::vector<BagCamera> cameras;
    for (std::size_t i = 0; i < robot.cameras.size(); ++i) {
        const auto info = survey.infos.find(topics.images[i]);
        cameras.emplace_back(robot.cameras[i], topics.images[i],
                             info == survey.infos.end() ? nullptr : &info->second);
    }
    return cameras;
}

BusClock clock_of(const BagSurvey& survey) {
    if (survey.clock) return *survey.clock;
    const std::int64_t first_ns = survey.first ? survey.first->ns : 0;
    return BusClock(Nanoseconds{first_ns} - kBusTimeOfFirst);
}

/// The second pass over the bag.
class Import {
  public:
    Import(const BagRequest& request, const Setup& setup, const BagSurvey& survey,
           const RecordingPaths& paths, candump::LogWriter log)
        : request_(request),
          topics_(topics_of(request, setup.facts)),
          clock_(clock_of(survey)),
          paths_(paths),
          rig_(with_sources_of(setup.host.rig, survey)),
          log_(std::move(log), clock_, !survey.clock, converters_of(rig_)),
          joints_(rig_, setup.host.robot.limits()),
          cameras_(cameras_of(setup.facts, topics_, survey)) {}

    Status<Error> take(const mcap::Message& message) {
        const std::string& topic = message.channel->topic;
        TopicAccount& account = imported_.topics[topic];
        if (message.schema != nullptr && account.type.empty()) account.type = message.schema->name;
        ++account.messages;
        if (!is_log_time(message.head.logged)) {
            account.note_rejected("stamp_off");
            return Done{};
        }
        log_.advance(message.head.logged);
        if (topics_.is_can(topic)) return take_frame(message, account);
        if (topic == topics_.joint_states) {
            joints_.take(message, clock_, request_.uses_log_time, log_, account);
            return Done{};
        }
        for (BagCamera& camera : cameras_) {
            if (camera.topic() != topic) continue;
            (void)log_.add(message.head.logged);
            return camera.take(message, paths_, clock_, request_.uses_log_time, account);
        }
        account.note_rejected(kNotNeeded);
        return Done{};
    }

    Result<ImportedBag, Error> finish() {
        if (auto closed = log_.close(); !closed) return unexpected(closed.error());
        for (BagCamera& camera : cameras_) {
            if (auto closed = camera.close(); !closed) return unexpected(closed.error());
            imported_.depth_frames += camera.frames();
        }
        if (const auto account = imported_.topics.find(topics_.joint_states);
            account != imported_.topics.end())
            joints_.finish(account->second);
        imported_.can_frames = log_.frames();
        if (log_.first() && log_.last())
            imported_.duration_s = static_cast<double>(log_.last()->ns - log_.first()->ns) * 1e-9;
        return std::move(imported_);
    }

    /// About as many bytes as were written so far.
    [[nodiscard]] std::uint64_t produced() const {
        constexpr std::uint64_t kLineBytes = 64;
        std::uint64_t bytes = kLineBytes * log_.frames();
        for (const BagCamera& camera : cameras_) bytes += camera.bytes();
        return bytes;
    }

    [[nodiscard]] const BagTopics& topics() const noexcept { return topics_; }
    [[nodiscard]] const std::vector<BagCamera>& cameras() const noexcept { return cameras_; }
    [[nodiscard]] const JointStates& joint_states() const noexcept { return joints_.states(); }
    [[nodiscard]] const BagLog& log() const noexcept { return log_; }

  private:
    Status<Error> take_frame(const mcap::Message& message, TopicAccount& account) {
        const auto frame = frame_of(message);
        if (!frame) {
            account.note_rejected(frame.error());
        } else if (!log_.add(message.head.logged, *frame)) {
            account.note_rejected("stamp_off");
        } else {
            ++account.used;
        }
        return Done{};
    }

    const BagRequest& request_;
    BagTopics topics_;
    BusClock clock_;
    const RecordingPaths& paths_;
    HostRig rig_;
    BagLog log_;
    BagJoints joints_;
    std::vector<BagCamera> cameras_;
    ImportedBag imported_;
};

Result<mcap::McapReader, AppError> open_bag(const BagRequest& request) {
    auto reader = mcap::McapReader::open(request.bag);
    if (reader) return std::move(reader).value();
    const bool is_absent = reader.error().code == ErrorCode::not_found;
    return fail(is_absent ? ExitCode::no_input : ExitCode::bad_data,
                in_file(reader.error(), request.bag.shown()));
}

/// The first pass; what it holds of the bag is given back.
Result<BagSurvey, AppError> survey_of(const BagRequest& request, const Setup& setup) {
    auto reader = open_bag(request);
    if (!reader) return unexpected(reader.error());
    auto survey = survey_bag(*reader, topics_of(request, setup.facts), setup.host.rig);
    if (!survey) return fail(ExitCode::bad_data, survey.error());
    return std::move(survey).value();
}

/// A name that is wrong would cost a part of the map.
Status<AppError> check_topics(const BagRequest& request, const BagSurvey& survey) {
    const auto of_can = check_given_topics(request.can, survey.topics, "--can");
    if (!of_can) return fail(ExitCode::usage, in_file(of_can.error(), request.bag.shown()));
    if (request.joint_states.empty()) return Done{};
    const auto of_joints = check_given_topics({request.joint_states}, survey.topics, "--joint-states");
    if (!of_joints) return fail(ExitCode::usage, in_file(of_joints.error(), request.bag.shown()));
    return Done{};
}

Status<AppError> write_setup(const Setup& setup, const RecordingPaths& paths) {
    const auto robot = robot_text(setup.rig);
    if (!robot) return unexpected(robot.error());
    if (auto written = write_text(paths.robot(), *robot); !written) return written;
    return write_text(paths.rig(),
                      rig::canonical_text(rig::without_devices(setup.rig), paths.robot().filename()));
}

Status<AppError> write_end(const ImportedBag& imported, const BagRequest& request,
                           const RecordingPaths& paths) {
    const RecordingMeta meta{.made_by = program_version(),
                             .source = "robot",
                             .world = {},
                             .scenario = {},
                             .rig = source_file(request.rig),
                             .seed = {},
                             .can_frames = imported.can_frames,
                             .depth_frames = imported.depth_frames,
                             .duration_s = imported.duration_s};
    const auto written = write_meta(paths, meta);
    if (!written) return fail(ExitCode::cannot_create, written.error());
    return Done{};
}

/// The topics of the bag with their types, to find the right ones.
std::string topics_text(const BagAccount& topics) {
    std::vector<std::string> texts;
    for (const auto& [topic, account] : topics) texts.push_back(topic + " (" + account.type + ")");
    return texts.empty() ? "It has no message" : "It has " + first_names(texts);
}

AppError nothing_used(const BagRequest& request, const ImportedBag& imported) {
    const auto& warnings = imported.warnings;
    return {ExitCode::bad_data,
            {.code = ErrorCode::no_content,
             .what = "has no joint state, depth image or CAN frame that can be used with this rig",
             .remedy = "compare its topics and its joints' names with the rig, or name topics with "
                       "--joint-states and --can",
             .file = request.bag.shown(),
             .others = topics_text(imported.topics) + (warnings.empty() ? "" : ". " + warnings.front())}};
}

/// Messages of the bag to the import, with reports.
Status<AppError> read_bag(mcap::McapReader& reader, Import& import, OutputRoom& room,
                          const ImportReport& report) {
    for (;;) {
        const auto message = reader.next();
        if (!message) return fail(ExitCode::bad_data, message.error());
        if (!*message) return Done{};
        if (const auto taken = import.take(**message); !taken) {
            const bool is_helper = taken.error().code == ErrorCode::no_program;
            return fail(is_helper ? ExitCode::unavailable : ExitCode::cannot_create, taken.error());
        }
        if (const auto checked = room.check(import.produced()); !checked)
            return fail(ExitCode::cannot_create, checked.error());
        if (report && reader.bytes_of_data() > 0)
            report(0.5 + 0.5 * static_cast<double>(reader.bytes_read()) /
                             static_cast<double>(reader.bytes_of_data()));
    }
}

}  // namespace

Result<ImportedBag, AppError> import_bag(const BagRequest& request, const ImportReport& report) {
    auto setup = read_setup(request);
    if (!setup) return unexpected(setup.error());
    const auto survey = survey_of(request, *setup);
    if (!survey) return unexpected(survey.error());
    if (const auto checked = check_topics(request, *survey); !checked) return unexpected(checked.error());
    auto draft = RecordingDraft::create(request.folder, false);
    if (!draft) return unexpected(draft.error());
    if (const auto written = write_setup(*setup, draft->paths()); !written)
        return unexpected(written.error());
    auto log = candump::LogWriter::create(draft->paths().can_log());
    if (!log) return fail(ExitCode::cannot_create, log.error());
    auto again = open_bag(request);
    if (!again) return unexpected(again.error());
    Import import(request, *setup, *survey, draft->paths(), std::move(log).value());
    OutputRoom room(again->bytes_of_data(), [&draft]() -> Result<OutputRoom::Use, Error> {
        const auto folder = draft->paths().folder.open();
        return folder ? use_of(*folder) : unexpected(to_error(folder.error()));
    });
    if (const auto read = read_bag(*again, import, room, report); !read) return unexpected(read.error());
    auto imported = import.finish();
    if (!imported) return fail(ExitCode::cannot_create, imported.error());
    imported->warnings = warnings_about(*imported, *again, *survey, import.topics(), import.cameras(),
                                        import.joint_states(), import.log());
    const bool is_any_used =
        std::ranges::any_of(imported->topics, [](const auto& one) { return one.second.used > 0; });
    if (!is_any_used) return unexpected(nothing_used(request, *imported));
    if (const auto ended = write_end(*imported, request, draft->paths()); !ended)
        return unexpected(ended.error());
    if (const auto committed = draft->commit(); !committed) return unexpected(committed.error());
    return std::move(imported).value();
}

}  // namespace octoskin::bridge
