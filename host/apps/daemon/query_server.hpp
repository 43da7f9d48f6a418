// The query server: answers questions about the map from snapshots, in its own thread, while the map is
// updated.
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
#include "host/apps/query/kept_field.hpp"
#include "host/core/mapping/free_evidence.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin {

/// Each question uses a copy of the map, made when its turn comes, which takes some microseconds of the
/// loop's time. There is one copy, however many questions wait. The distance field that long paths need is
/// updated from copy to copy, and dropped after `field_idle_max` without a question. The loop calls `serve`
/// whenever `descriptor` is readable. At most as many questions wait as the control socket admits. Users take
/// turns, one question each. A question ends after `work_max`, and its answer states that.
class QueryServer {
  public:
    static constexpr std::chrono::milliseconds kFieldIdleMax{10'000};
    static constexpr std::chrono::milliseconds kWorkMax{10'000};
    /// Throws std::system_error if there is no thread or descriptor left.
    explicit QueryServer(const HostSetup& setup, const MissUnits& units = {},
                         std::chrono::milliseconds field_idle_max = kFieldIdleMax,
                         std::chrono::milliseconds work_max = kWorkMax);
    /// Waits until the posture or row of voxels that is being checked is done.
    ~QueryServer();
    QueryServer(const QueryServer&) = delete;
    QueryServer& operator=(const QueryServer&) = delete;

    /// Later questions use this robot, and the units of this mapping.
    void change_robot(const HostSetup& setup, const MissUnits& units);

    /// False if the line is no query. Throws std::bad_alloc; an accepted question gets an answer even if
    /// there is no memory for one later.
    bool take(const std::string& line, std::uint64_t ticket, uid_t user);
    /// The answer to this ticket is no longer needed: it is not computed, or not completed.
    void forget(std::uint64_t ticket);

    /// The present time, on the clock of the map's measurements. While the time is in doubt, the map still
    /// has to age: `reckoned` is the time for that.
    struct Now {
        std::optional<HostTime> known;  ///< empty: the time is unknown or in doubt
        HostTime reckoned;              ///< the newest known time, continued by this machine's clock
        WallTime wall;                  ///< stated in an answer
    };
    struct Answer {
        std::uint64_t ticket = 0;
        std::string line;
    };
    using Answers = std::list<Answer>;
    /// Readable when there is something for `serve`.
    [[nodiscard]] int descriptor() const noexcept { return event_.descriptor(); }
    /// Gives the present map to the question whose turn it is, and returns the finished answers. The arm's
    /// position is the newest joint sample, if that is at most `kPresentMax` old and the time is known.
    [[nodiscard]] Answers serve(const Pipeline& pipeline, const Now& now);
    static constexpr Nanoseconds kPresentMax{500'000'000};

  private:
    struct Question {
        std::string line;
        uid_t user = 0;
        std::uint64_t round = 0;  ///< the round of its turn: each user has one question in a round
        Answers answer;           ///< filled in advance with the answer for a lack of memory
        [[nodiscard]] std::uint64_t ticket() const { return answer.front().ticket; }
    };
    using Questions = std::list<Question>;
    /// The data that one question uses.
    struct Ground {
        std::shared_ptr<const HostSetup> setup;
        FusedMap map;
        std::vector<double> present;
        Now now;
        MissUnits units;
    };
    void run();
    void wait_for_questions(std::unique_lock<std::mutex>& lock);
    [[nodiscard]] std::uint64_t round_of_next(uid_t user) const;
    [[nodiscard]] std::string answer(const std::string& question, Ground ground);

    const std::chrono::milliseconds field_idle_max_;
    const std::chrono::milliseconds work_max_;
    WakeEvent event_;
    std::shared_ptr<const HostSetup> setup_;
    MissUnits units_;  ///< of the mapping in force
    std::mutex mutex_;
    std::condition_variable changed_;
    Questions waiting_;          ///< in the order of arrival
    Questions at_work_;          ///< at most one
    Questions served_;           ///< answered in this round, one for each user
    std::uint64_t round_ = 0;    ///< of the question being answered, or the last one
    bool wants_ground_ = false;  ///< a question's turn has come: it needs a copy of the map
    std::optional<Ground> ground_;
    Answers answers_;
    std::atomic<bool> is_ending_ = false;
    std::atomic<bool> is_forgotten_ = false;  ///< the answer in progress is not needed
    KeptField field_;                         ///< used by the thread only
    std::thread thread_;                      ///< the last member: it uses all others
};

}  // namespace octoskin
