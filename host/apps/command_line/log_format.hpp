// How a message of the log looks, on a terminal and in systemd's journal.
#pragma once

namespace octoskin::app {

/// Time, level and message. Each message is one line of printable(): what somebody else's names are in it
/// orders a terminal nothing and makes up no line.
void set_log_format();

/// For the journal, which has its own clock, and reads a level from "<4>" at the begin of a line
/// (sd-daemon(3)).
void set_journal_format();

}  // namespace octoskin::app
