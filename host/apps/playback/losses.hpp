// Of a replay: what most of its input was rejected for.
#pragma once

#include "host/apps/playback/playback.hpp"

namespace octoskin {

/// Fills `losses` by the accounts, and says each: a mendable one, and why nothing came into a map, among the
/// warnings, the others among the notes. Also which joint is beyond its limits, and how slow the poses are.
void find_losses(Playback& playback);

}  // namespace octoskin
