// Questions to the map while it goes on: answered from snapshots, by a thread of its own.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/time.hpp"
#include "host/apps/daemon/wake_event.hpp"
#include "host/apps/querying/kept_field.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin {

/// Each question is put to a copy of the map as it is when its turn comes: some microseconds of the loop's
/// time. There is one copy, however many questions wait. A distance field that long paths make for themselves
/// follows from copy to copy, and goes when nothing was asked for `field_idle_max`. The loop calls `serve`
/// whenever `descriptor` is readable. As many questions wait as the control socket lets, at the most. Users
/// take turns, one question each; a question ends after `work_max`, and says so.
class QueryDesk {
  public:
    static constexpr std::chrono::milliseconds kFieldIdleMax{10'000};
    static constexpr std::chrono::milliseconds kWorkMax{10'000};
    /// Throws std::system_error if there is no thread or descriptor to be had.
    explicit QueryDesk(const HostSetup& setup, std::chrono::milliseconds field_idle_max = kFieldIdleMax,
                       std::chrono::milliseconds work_max = kWorkMax);
    /// After the posture that it is at, or the row of voxels.
    ~QueryDesk();
    QueryDesk(const QueryDesk&) = delete;
    QueryDesk& operator=(const QueryDesk&) = delete;

    /// What is asked from now on is asked of this robot.
    void change_robot(const HostSetup& setup);

    /// False if the line is no query. Throws std::bad_alloc; what is taken gets an answer though there is no
    /// memory for one later.
    bool take(const std::string& line, std::uint64_t ticket, uid_t user);
    /// This answer is no longer waited for: it is not sought, or not to its end.
    void forget(std::uint64_t ticket);

    /// Now, on the clock of what the map was told. A time in doubt must not make the map younger: by
    /// `reckoned` it ages all the same.
    struct Now {
        std::optional<HostTime> known;  ///< empty: the time is unknown or in doubt
        HostTime reckoned;              ///< the newest known time, gone on by this machine's clock
        WallTime wall;                  ///< which an answer states
    };
    struct Answer {
        std::uint64_t ticket = 0;
        std::string line;
    };
    using Answers = std::list<Answer>;
    /// Readable when there is something for `serve`, until then.
    [[nodiscard]] int descriptor() const noexcept { return event_.descriptor(); }
    /// Gives the question whose turn it is the map as it is, and takes the answers that are there. The arm is
    /// where the newest joint sample says, if that is at most `kPresentMax` old and the time is known.
    [[nodiscard]] Answers serve(const Pipeline& pipeline, const Now& now);
    static constexpr Nanoseconds kPresentMax{500'000'000};

  private:
    struct Question {
        std::string line;
        uid_t user = 0;
        std::uint64_t round = 0;  ///< in which it has its turn: one of each user's in a round
        Answers answer;           ///< the place for it, which says until then that there is no memory
        [[nodiscard]] std::uint64_t ticket() const { return answer.front().ticket; }
    };
    using Questions = std::list<Question>;
    /// What one question is put to.
    struct Ground {
        std::shared_ptr<const HostSetup> setup;
        FusedMap map;
        std::vector<double> present;
        Now now;
    };
    void run();
    void wait_for_questions(std::unique_lock<std::mutex>& lock);
    [[nodiscard]] std::uint64_t round_of_next(uid_t user) const;
    [[nodiscard]] std::string answer(const std::string& question, Ground ground);

    const std::chrono::milliseconds field_idle_max_;
    const std::chrono::milliseconds work_max_;
    WakeEvent event_;
    std::shared_ptr<const HostSetup> setup_;
    std::mutex mutex_;
    std::condition_variable changed_;
    Questions waiting_;          ///< in the order they came
    Questions at_work_;          ///< one, or none
    Questions served_;           ///< of this round, one of each user's
    std::uint64_t round_ = 0;    ///< of the one that is at work, or was the last
    bool wants_ground_ = false;  ///< a question's turn has come
    std::optional<Ground> ground_;
    Answers answers_;
    std::atomic<bool> is_ending_ = false;
    std::atomic<bool> is_forgotten_ = false;  ///< the question at work
    KeptField field_;                         ///< the thread's own
    std::thread thread_;                      ///< the last: it uses all others
};

}  // namespace octoskin
