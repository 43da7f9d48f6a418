// What a process can do without, beside the calls that confinement.hpp takes from it.
#pragma once

namespace octoskin {

/// From now on this thread, and those that it begins, may neither look into another process (its memory, its
/// environment) nor change a file or start a program, as far as the kernel has Landlock; and a process of
/// root has left of root's rights that it may read every file. What the kernel does not have is passed over.
/// Needs no_new_privs.
void give_up_privileges();

}  // namespace octoskin
