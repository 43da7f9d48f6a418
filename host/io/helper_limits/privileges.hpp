// Drops privileges, in addition to the system calls that confinement.hpp blocks.
#pragma once

namespace octoskin {

/// From now on this thread, and threads that it starts, can neither inspect another process (its memory, its
/// environment) nor change a file nor start a program, as far as the kernel has Landlock. A process of root
/// keeps of root's rights only that to read every file. Features that the kernel lacks are skipped. Requires
/// no_new_privs.
void give_up_privileges();

}  // namespace octoskin
