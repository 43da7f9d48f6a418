#include "host/apps/daemon/query_desk.hpp"

#include <exception>
#include <span>

#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/querying/query_answer.hpp"

namespace octoskin {
namespace {

/// Empty if nobody knows.
std::vector<double> present_joints(const Pipeline& pipeline, std::size_t count, std::optional<HostTime> now) {
    std::vector<double> newest;
    std::optional<HostTime> sampled;
    pipeline.builder().for_each_joint_sample([&](const JointMeasurement& joints) {
        const auto position = std::span(joints.position_rad).first(count);
        newest.assign(position.begin(), position.end());
        sampled = joints.sampled;
    });
    if (!now || !sampled || *now - *sampled > QueryDesk::kPresentMax) newest.clear();
    return newest;
}

}  // namespace

QueryDesk::QueryDesk(const HostSetup& setup)
    : setup_(std::make_shared<const HostSetup>(setup)), thread_(start_without_signals([this] { run(); })) {}

QueryDesk::~QueryDesk() {
    {
        const std::scoped_lock lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void QueryDesk::change_robot(const HostSetup& setup) {
    setup_ = std::make_shared<const HostSetup>(setup);
}

bool QueryDesk::take(const std::string& line, std::uint64_t ticket, const Pipeline& pipeline,
                     std::optional<HostTime> now) {
    if (!is_query(line)) return false;
    {
        const std::scoped_lock lock(mutex_);
        if (waiting_.size() >= kWaitingMax) {
            tell(ticket,
                 query_refused({ExitCode::unavailable, "too many questions wait for an answer already"})
                     .dump());
            return true;
        }
    }
    Question question{line,
                      ticket,
                      setup_,
                      pipeline.maps().fused()->copy(),
                      present_joints(pipeline, setup_->robot.joint_count(), now),
                      now};
    {
        const std::scoped_lock lock(mutex_);
        waiting_.push_back(std::move(question));
    }
    changed_.notify_all();
    return true;
}

std::vector<std::pair<std::uint64_t, std::string>> QueryDesk::take_answers() {
    event_.clear();
    const std::scoped_lock lock(mutex_);
    return std::exchange(answers_, {});
}

void QueryDesk::run() {
    std::unique_lock lock(mutex_);
    while (true) {  // ends with the object
        changed_.wait(lock, [this] { return !waiting_.empty() || is_ending_; });
        if (is_ending_) return;
        Question question = std::move(waiting_.front());
        waiting_.pop_front();
        const std::uint64_t ticket = question.ticket;
        lock.unlock();
        std::string line = answer(std::move(question));
        lock.lock();
        tell(ticket, std::move(line));
    }
}

/// With the lock.
void QueryDesk::tell(std::uint64_t ticket, std::string line) {
    answers_.emplace_back(ticket, std::move(line));
    event_.wake();
}

std::string QueryDesk::answer(Question question) const {
    nlohmann::ordered_json json;
    try {
        if (question.now) question.map.go_on(*question.now);  // nothing may have been measured for long
        const auto request = read_query(question.line);
        json = request ? answer_query(*request,
                                      {&question.setup->rig, &question.setup->robot, std::move(question.map),
                                       std::move(question.present)},
                                      [this] { return is_ending_.load(); })
                       : query_refused(request.error());
    } catch (const std::exception& error) {  // no memory, most likely
        json = query_refused({ExitCode::unavailable, std::string("no answer: ") + error.what()});
    }
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace octoskin
