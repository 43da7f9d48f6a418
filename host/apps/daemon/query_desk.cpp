#include "host/apps/daemon/query_desk.hpp"

#include <exception>
#include <nlohmann/json.hpp>
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

QueryDesk::QueryDesk(const HostSetup& setup, std::chrono::milliseconds field_idle_max)
    : field_idle_max_(field_idle_max),
      setup_(std::make_shared<const HostSetup>(setup)),
      thread_(start_without_signals([this] { run(); })) {}

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

bool QueryDesk::take(const std::string& line, std::uint64_t ticket) {
    if (!is_query(line)) return false;
    {
        const std::scoped_lock lock(mutex_);
        waiting_.push_back({line, ticket});
    }
    changed_.notify_all();
    return true;
}

void QueryDesk::forget(std::uint64_t ticket) {
    const std::scoped_lock lock(mutex_);
    std::erase_if(waiting_, [ticket](const Question& question) { return question.ticket == ticket; });
    if (asked_ == ticket) is_forgotten_ = true;
}

std::vector<std::pair<std::uint64_t, std::string>> QueryDesk::serve(const Pipeline& pipeline,
                                                                    const Now& now) {
    event_.clear();
    std::unique_lock lock(mutex_);
    auto answers = std::exchange(answers_, {});
    if (wants_ground_) {
        ground_.emplace(Ground{setup_, pipeline.map().copy(),
                               present_joints(pipeline, setup_->robot.joint_count(), now.known), now});
        wants_ground_ = false;
        lock.unlock();
        changed_.notify_all();
    }
    return answers;
}

void QueryDesk::run() {
    std::unique_lock lock(mutex_);
    while (true) {  // ends with the object
        wait_for_questions(lock);
        if (is_ending_) return;
        Ground ground = std::move(*ground_);
        ground_.reset();
        if (waiting_.empty()) continue;  // forgotten meanwhile
        const Question question = std::move(waiting_.front());
        waiting_.pop_front();
        asked_ = question.ticket;
        is_forgotten_ = false;
        lock.unlock();
        std::string line;
        try {
            line = answer(question.line, std::move(ground));
        } catch (const std::exception&) {  // no memory to say so: an empty line, which is an answer, too
        }
        lock.lock();
        tell(asked_, std::move(line));
    }
}

/// Until there is a question and what it is put to, or the end.
void QueryDesk::wait_for_questions(std::unique_lock<std::mutex>& lock) {
    const auto has_work = [this] { return !waiting_.empty() || is_ending_; };
    if (field_.is_there() && !changed_.wait_for(lock, field_idle_max_, has_work)) {
        lock.unlock();  // who puts a question need not wait for it to go
        field_.drop();
        lock.lock();
    }
    changed_.wait(lock, has_work);
    wants_ground_ = true;
    event_.wake();
    changed_.wait(lock, [this] { return ground_ || is_ending_; });
}

/// With the lock.
void QueryDesk::tell(std::uint64_t ticket, std::string line) {
    answers_.emplace_back(ticket, std::move(line));
    event_.wake();
}

std::string QueryDesk::answer(const std::string& question, Ground ground) {
    nlohmann::ordered_json json;
    try {
        ground.map.go_on(ground.now.reckoned);  // nothing may have been measured for long, or ever
        const auto request = read_query(question);
        json = request ? answer_query(*request,
                                      {&ground.setup->rig, &ground.setup->robot, std::move(ground.map),
                                       std::move(ground.present), &field_, true, ground.now.wall},
                                      [this] { return is_ending_ || is_forgotten_; })
                       : query_refused(request.error());
    } catch (const std::exception& error) {  // no memory, most likely
        json = query_refused({ExitCode::unavailable, std::string("no answer: ") + error.what()});
    }
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace octoskin
