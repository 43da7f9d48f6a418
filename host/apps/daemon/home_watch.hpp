// Looks at the maps' folder beside the event loop: a file system that does not answer holds up the look
// alone.
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
    /// What a look found.
    struct Look {
        std::optional<OpenFolder> next;  ///< is held from now on; empty: the one before still is
        std::string problem;             ///< for a person, and what to do; empty: none
        std::string where;               ///< the folder is now; empty: it was removed
    };
    using Looker = std::function<Look(MapHome& home)>;

    /// Throws std::system_error if there is no thread to be had.
    explicit HomeWatch(MapHome home, Looker looker = look);
    /// Within 0.1 s: a look that hangs is left behind, with the folder and its lock.
    ~HomeWatch();
    HomeWatch(const HomeWatch&) = delete;
    HomeWatch& operator=(const HomeWatch&) = delete;

    /// Readable while `take` has something new.
    [[nodiscard]] int descriptor() const noexcept { return task_.descriptor(); }
    /// Begins a look, unless one is at work.
    void ask();
    /// Takes what a look found, if one has ended: the folder that is held from now on, if it is another one.
    [[nodiscard]] std::optional<OpenFolder> take();
    /// A look that begins after this call, if there is time for it: waits for `patience` at most.
    [[nodiscard]] std::optional<OpenFolder> look_again(Nanoseconds patience);

    /// As of the newest look.
    [[nodiscard]] const std::string& problem() const noexcept { return newest_.problem; }
    [[nodiscard]] const std::string& where() const noexcept { return newest_.where; }
    /// When the look that is at work was begun; empty: none is.
    [[nodiscard]] const std::optional<HostTime>& looking_since() const noexcept { return task_.begun(); }

    [[nodiscard]] static Look look(MapHome& home);

  private:
    [[nodiscard]] std::optional<OpenFolder> note(std::optional<Look> found);

    std::shared_ptr<MapHome> home_;  ///< only the task touches it
    Looker looker_;
    Look newest_;
    SideTask<Look> task_;
};

}  // namespace octoskin
