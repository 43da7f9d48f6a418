#include "host/apps/daemon/query_server.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/daemon/unwinding_room.hpp"
#include "host/apps/query/query_answer.hpp"

namespace octoskin {
namespace {

/// Empty if they are not known.
std::vector<double> present_joints(const Pipeline& pipeline, std::optional<HostTime> now) {
    const auto newest = pipeline.builder().robot().newest();
    if (!now || !newest || *now - newest->oldest > QueryServer::kPresentMax) return {};
    return newest->position;
}

}  // namespace

QueryServer::QueryServer(const HostSetup& setup, const MissUnits& units,
                         std::chrono::milliseconds field_idle_max, std::chrono::milliseconds work_max)
    : field_idle_max_(field_idle_max),
      work_max_(work_max),
      setup_(std::make_shared<const HostSetup>(setup)),
      units_(units),
      thread_(start_without_signals([this] { run(); })) {}

QueryServer::~QueryServer() {
    {
        const std::scoped_lock lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void QueryServer::change_robot(const HostSetup& setup, const MissUnits& units) {
    setup_ = std::make_shared<const HostSetup>(setup);
    units_ = units;
}

bool QueryServer::take(const std::string& line, std::uint64_t ticket, uid_t user) {
    if (!is_query(line)) return false;
    Questions taken;
    taken.push_back({line, user, 0, {{ticket, AnswerRoom::kRefusal}}});
    {
        const std::scoped_lock lock(mutex_);
        taken.front().round = round_of_next(user);
        waiting_.splice(waiting_.end(), taken);
    }
    changed_.notify_all();
    return true;
}

/// Called with the lock. A user has one question in a round: further ones wait until the others had their
/// turn.
std::uint64_t QueryServer::round_of_next(uid_t user) const {
    std::uint64_t round = round_;
    for (const Questions* questions : {&served_, &at_work_, &waiting_})
        for (const Question& question : *questions)
            if (question.user == user) round = std::max(round, question.round + 1);
    return round;
}

void QueryServer::forget(std::uint64_t ticket) {
    const std::scoped_lock lock(mutex_);
    std::erase_if(waiting_, [ticket](const Question& question) { return question.ticket() == ticket; });
    if (!at_work_.empty() && at_work_.front().ticket() == ticket) is_forgotten_ = true;
}

QueryServer::Answers QueryServer::serve(const Pipeline& pipeline, const Now& now) {
    event_.clear();
    std::unique_lock lock(mutex_);
    auto answers = std::exchange(answers_, {});
    if (wants_ground_) {
        ground_.emplace(
            Ground{setup_, pipeline.map().copy(), present_joints(pipeline, now.known), now, units_});
        wants_ground_ = false;
        lock.unlock();
        changed_.notify_all();
    }
    return answers;
}

void QueryServer::run() {
    yield_to_the_loop();
    std::unique_lock lock(mutex_);
    while (true) {  // ends with the object
        wait_for_questions(lock);
        if (is_ending_) return UnwindingRoom::spend();
        Ground ground = std::move(*ground_);
        ground_.reset();
        if (waiting_.empty()) continue;  // cleared meanwhile
        at_work_.splice(at_work_.end(), waiting_, std::ranges::min_element(waiting_, {}, &Question::round));
        Question& question = at_work_.front();
        if (question.round != round_) served_.clear();
        round_ = question.round;
        is_forgotten_ = false;
        lock.unlock();
        UnwindingRoom::keep();
        try {
            question.answer.front().line = answer(question.line, std::move(ground));
        } catch (const std::exception&) {  // no memory: the answer prepared for that case is sent
        }
        lock.lock();
        answers_.splice(answers_.end(), question.answer);
        question.line.clear();
        served_.splice(served_.end(), at_work_);
        event_.wake();
    }
}

/// Waits for a question and the map for it, or for the end.
void QueryServer::wait_for_questions(std::unique_lock<std::mutex>& lock) {
    const auto has_work = [this] { return !waiting_.empty() || is_ending_; };
    if (field_.is_there() && !changed_.wait_for(lock, field_idle_max_, has_work)) {
        lock.unlock();  // the thread that adds a question need not wait
        field_.drop();
        lock.lock();
    }
    changed_.wait(lock, has_work);
    wants_ground_ = true;
    event_.wake();
    changed_.wait(lock, [this] { return ground_ || is_ending_; });
}

std::string QueryServer::answer(const std::string& question, Ground ground) {
    constexpr std::size_t kRoomBytes = std::size_t{4} << 20U;
    const AnswerRoom room(kRoomBytes);
    nlohmann::ordered_json json;
    try {
        ground.map.advance_time(
            ground.now.reckoned);  // the last measurement may be long ago, or there is none
        const auto request = read_query(question);
        json = request ? answer_query(*request,
                                      {&ground.setup->rig, &ground.setup->robot, std::move(ground.map),
                                       std::move(ground.present), &field_, true, ground.units,
                                       ground.now.wall, work_max_},
                                      [this] { return is_ending_ || is_forgotten_; })
                       : query_refused(request.error());
    } catch (const std::bad_alloc&) {  // nor for a message
        throw;
    } catch (const std::exception& error) {
        json = query_refused(
            {ExitCode::unavailable, {ErrorCode::no_answer, std::string("no answer: ") + error.what()}});
    }
    std::string line = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    UnwindingRoom::spend();
    return line;
}

}  // namespace octoskin
