// Publishes bytes on topics, at the right time, and waits for readers.
#pragma once

#include <chrono>
#include <map>
#include <string>

#include "tests/ros/endpoints.hpp"

namespace octoskin::ros {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

class Saying {
  public:
    struct Settings {
        int domain = 0;
        /// Each topic's first sample waits for so many readers,
        int readers = 1;
        /// at most so long,
        double wait_seconds = 10;
        /// and so much longer: a writer knows its readers before they know it, and they take nothing until
        /// then.
        double settle_seconds = 0.2;
        /// The writers stay so long after the last sample.
        double linger_seconds = 0.5;
        /// They stay until all reliable readers have everything, too, 10 s at most.
        bool is_until_read = false;
    };

    explicit Saying(const Settings& settings) : settings_(settings), participant_(settings.domain) {}

    /// Makes the topic's writer unless it is there, and waits for its readers. `qos` counts for a new writer
    /// only.
    dds::DataWriter& writer_of(const std::string& topic, const Codec& codec, const Qos& qos);

    /// Fast DDS may refuse a sample, which is counted.
    void say(const std::string& topic, const Bytes& bytes);

    /// Stays as the settings say, and prints the counts.
    void end();

  private:
    struct Said {
        dds::DataWriter* writer = nullptr;
        int samples = 0;
        int refused = 0;
    };
    void wait_for_readers(const std::string& topic, dds::DataWriter& writer) const;

    Settings settings_;
    Participant participant_;
    std::map<std::string, Said> said_;
};

/// A time so many seconds after another.
[[nodiscard]] inline Clock::time_point after(Clock::time_point start, double seconds) {
    return start + std::chrono::duration_cast<Clock::duration>(Seconds(seconds));
}

/// Sleep until a time, or until the program is told to end.
void sleep_until(Clock::time_point time);
void sleep_for(double seconds);

}  // namespace octoskin::ros
