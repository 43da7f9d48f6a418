// Checks the maps' folder in its own thread: a file system that does not answer blocks only that thread.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "host/apps/daemon/map_home.hpp"
#include "host/apps/daemon/side_task.hpp"

namespace octoskin {

class HomeWatch {
  public:
    /// The result of a check.
    struct Look {
        std::optional<OpenFolder> next;  ///< held from now on; empty: the previous one is kept
        std::string problem;             ///< for a person, with the remedy; empty: none
        std::string where;               ///< where the folder is now; empty: it was removed
    };
    using Looker = std::function<Look(MapHome& home)>;

    /// Throws std::system_error if there is no thread left.
    explicit HomeWatch(MapHome home, Looker looker = look);
    /// Takes at most 0.1 s: a check that hangs is left behind, with the folder and its lock.
    ~HomeWatch();
    HomeWatch(const HomeWatch&) = delete;
    HomeWatch& operator=(const HomeWatch&) = delete;

    /// Readable while `take` has a new result.
    [[nodiscard]] int descriptor() const noexcept { return task_.descriptor(); }
    /// Starts a check, unless one is running.
    void ask();
    /// Takes the result of a finished check: the folder held from now on, if it is another one.
    [[nodiscard]] std::optional<OpenFolder> take();
    /// The result of a check that starts after this call; waits at most `patience` for it.
    [[nodiscard]] std::optional<OpenFolder> look_again(Nanoseconds patience);

    /// By the newest check.
    [[nodiscard]] const std::string& problem() const noexcept { return newest_.problem; }
    [[nodiscard]] const std::string& where() const noexcept { return newest_.where; }
    /// When the running check started; empty: none is running.
    [[nodiscard]] const std::optional<HostTime>& looking_since() const noexcept { return task_.begun(); }

    [[nodiscard]] static Look look(MapHome& home);

  private:
    [[nodiscard]] std::optional<OpenFolder> note(std::optional<Look> found);

    std::shared_ptr<MapHome> home_;  ///< used only by the task
    Looker looker_;
    Look newest_;
    SideTask<Look> task_;
};

}  // namespace octoskin
