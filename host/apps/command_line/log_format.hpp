// The format of log messages, on a terminal and in systemd's journal.
#pragma once

namespace octoskin::app {

/// Format: time, level and message. Each message is one line of printable(): names from outside can neither
/// control the terminal nor add a line.
void set_log_format();

/// Format for the journal, which adds the time itself and reads the level from "<4>" at the beginning of a
/// line (sd-daemon(3)).
void set_journal_format();

}  // namespace octoskin::app
