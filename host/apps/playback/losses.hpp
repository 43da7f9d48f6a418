// The main reasons for which a replay rejected input.
#pragma once

#include "host/apps/playback/playback.hpp"

namespace octoskin {

/// Fills `losses` from the input counters and adds a text for each: those that the user can correct, and the
/// reason for an empty map, to the warnings; the others to the notes. Also reports joints beyond their limits
/// and slow poses.
void find_losses(Playback& playback);

}  // namespace octoskin
